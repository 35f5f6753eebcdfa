"""A: accuracy and effects: knobs that change the pipeline, effects that exist."""

from __future__ import annotations

from collections.abc import Iterator

from nau_py.diagnostics.catalogue import ERROR, WARNING, rule
from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.model.accuracy import Accuracy, Knob
from nau_py.model.effects import parse_effects
from nau_py.model.knob import IdleKnob, find_knob_target
from nau_py.model.linked import Project
from nau_py.model.pipeline import Pipeline
from nau_py.rules.registry import LintContext, check

A001 = rule(
    "A001",
    ERROR,
    "Unknown knob",
    "A knob is one of the short names of docs/cost.md, PASS/ATTRIBUTE of a pass of the "
    "pipeline, or PASS/SELECTOR/ATTRIBUTE of a mask pass.",
    "<knob name='ssp' values='1, 4'/>",
    "<knob name='spp' values='1, 4'/>",
)
A002 = rule(
    "A002",
    ERROR,
    "Wrong value of a knob",
    "The values of a knob are numbers in its range, or words that it accepts; each value once.",
    "<knob name='spp' values='0, 4'/>",
    "<knob name='spp' values='1, 4'/>",
)
A003 = rule(
    "A003",
    ERROR,
    "Knob without effect",
    "The pipeline has no raytrace pass, or its pass no mask: every value gives the same picture.",
    "<knob name='mask' values='project, all'/> without a mask",
    "<knob name='spp' values='1, 4'/>",
)
A004 = rule(
    "A004",
    ERROR,
    "Too few runs or samples",
    "`reference` must be greater than every measured spp; a spread needs at least 2 `runs`.",
    "<accuracy runs='1'/>",
    "<accuracy runs='5'/>",
)
A005 = rule(
    "A005",
    WARNING,
    "Knob given twice",
    "Only the last one counts.",
    "<knob name='spp' values='1'/><knob name='spp' values='4'/>",
    "<knob name='spp' values='1, 4'/>",
)
A006 = rule(
    "A006",
    ERROR,
    "Unknown effect",
    "`simulate` is auto, all, none, or a list of effects (docs/effects-on-demand.md).",
    "<effects simulate='mirrors'/>",
    "<effects simulate='reflection, shadow'/>",
)


def _pipeline(project: Project, node: Accuracy) -> Pipeline | None:
    """Return the pipeline to measure; None if R013 or S005 reports that there is none."""
    file = project.file.pipelines
    name = node.pipeline or (file.default if file else None)
    if name is None:
        return next(iter(project.pipelines), None)
    return next((p for p in project.pipelines if p.name == name), None)


@check
def check_accuracy(context: LintContext) -> Iterator[Diagnostic]:
    """Check the knobs of ``<accuracy>`` and their values."""
    node = context.project.file.accuracy
    pipeline = _pipeline(context.project, node) if node is not None else None
    if node is None or pipeline is None:
        return
    most: int = 0
    seen: dict[str, Knob] = {}
    for knob in node.knobs:
        if knob.name is None:
            continue
        if knob.name in seen:
            message = f"knob '{knob.name}' is given twice; the last one counts"
            yield A005.at(
                knob.where("name"), message, ((seen[knob.name].where("name"), "the first"),)
            )
        seen[knob.name] = knob
        try:
            target = find_knob_target(context.project, pipeline.passes, knob.name)
            values = target.parse_values(knob.values or "")
        except LookupError as problem:
            yield A001.at(knob.where("name"), str(problem.args[0]))
        except IdleKnob as problem:
            yield A003.at(knob.where("name"), f"{problem}: pipeline '{pipeline.name}'")
        except ValueError as problem:
            yield A002.at(knob.where("values"), f"values of knob '{knob.name}': {problem}")
        else:
            if knob.name == "spp":
                most = max(int(v) for v in values)
    if node.runs is not None and node.runs < 2:
        yield A004.at(node.where("runs"), f"runs is {node.runs}; at least 2 give a spread")
    if node.reference is not None and node.reference <= most:
        yield A004.at(
            node.where("reference"),
            f"reference is {node.reference}; it must be more than the greatest spp, {most}",
        )


@check
def check_effects(context: LintContext) -> Iterator[Diagnostic]:
    """Check the names in ``<effects>``."""
    node = context.project.file.effects
    if node is None or node.simulate is None:
        return
    try:
        parse_effects(node.simulate)
    except ValueError as problem:
        yield A006.at(node.where("simulate"), f"simulate of <effects>: {problem}")

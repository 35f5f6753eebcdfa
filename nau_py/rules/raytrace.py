"""T: raytrace passes: their number, mask, ray types and outputs."""

from __future__ import annotations

from collections.abc import Iterator

from nau_py.diagnostics.catalogue import ERROR, WARNING, rule
from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.diagnostics.suggest import format_names, suggest_fix, suggest_name
from nau_py.graph.dependencies import find_dependencies
from nau_py.graph.resource import Resource
from nau_py.model.linked import Project
from nau_py.model.raytrace import RaytracePass
from nau_py.raytrace.programs.source import launches_ptx
from nau_py.rules.registry import LintContext, check

T001 = rule(
    "T001",
    ERROR,
    "More than one raytrace pass",
    "Nau's integration allows one raytrace pass in all pipelines of a project together. "
    "`<project raytracePasses='many'>` lifts the limit for nau_py.",
    "two passes of class raytrace",
    "one, or <project raytracePasses='many' …>",
)
T002 = rule(
    "T002",
    ERROR,
    "Mask that no pass writes",
    "No earlier pass of the pipeline writes the texture that selects the pixels, so nothing "
    "would be traced.",
    "<buffer var='mask' texture='L::position'/> before the pass that draws it",
    "let a pass draw into the mask's render target first",
)
T007 = rule(
    "T007",
    WARNING,
    "Undeclared ray type",
    "The pass declares its ray types, and this name is not among them; Nau would use the first "
    "one.",
    "<rayType name='Radiance'> with only Phong declared",
    "<rayType name='Phong'>",
)
T008 = rule(
    "T008",
    ERROR,
    "Incomplete raytrace pass",
    "A raytrace pass needs an entry point with a ray generation program, and a render target; with "
    "compiled programs of OptiX 3 to 6, both geometry programs, too.",
    "<pass class='raytrace' name='a'/>",
    "… <rtEntryPoint> … <renderTarget …/> …",
)
T009 = rule(
    "T009",
    WARNING,
    "Output buffer not written",
    "Python programs write the first colour of the render target only.",
    "<optixOutput><buffer var='extra' …/>",
    "write to the render target",
)
T013 = rule(
    "T013",
    WARNING,
    "Only one mask counts",
    "Several inputs have the attribute `mask`; the first one is used.",
    "two <buffer … mask='w'/>",
    "one <buffer … mask='w'/>",
)


def raytrace_passes(project: Project) -> list[tuple[str, RaytracePass]]:
    """List the raytrace passes with the names of their pipelines, in file order."""
    return [
        (pipeline.name or "", p)
        for pipeline in project.pipelines
        for p in pipeline.passes
        if isinstance(p, RaytracePass)
    ]


@check
def check_one_pass(context: LintContext) -> Iterator[Diagnostic]:
    """Check that a project has one raytrace pass."""
    found = raytrace_passes(context.project)
    if len(found) < 2 or context.project.file.raytracePasses == "many":
        return
    first_pipeline, first = found[0]
    for pipeline, pass_ in found[1:]:
        yield T001.at(
            pass_.location,
            f"pass '{pass_.name}' of pipeline '{pipeline}' is a second raytrace pass; the first is "
            f"'{first.name}' of pipeline '{first_pipeline}' at {first.location}. A project has "
            'one, unless <project raytracePasses="many">',
            ((first.location, f"first raytrace pass '{first.name}'"),),
        )


@check
def check_masks(context: LintContext) -> Iterator[Diagnostic]:
    """Check that an earlier pass writes the mask."""
    project = context.project
    for pipeline in project.pipelines:
        graph = find_dependencies(project, pipeline, context.contracts)
        for index, pass_ in enumerate(graph.passes):
            if not isinstance(pass_, RaytracePass) or pass_.mask is None:
                continue
            if sum(1 for source in pass_.rtInput if source.mask) > 1:
                yield T013.at(
                    pass_.location,
                    f"pass '{pass_.name}' has several mask inputs; '{pass_.mask.var}' is used",
                )
            name = pass_.mask.texture or ""
            if project.target_of_texture(name) is None:
                continue
            if not any(w < index for w in graph.writers(Resource("texture", name))):
                yield T002.at(
                    pass_.mask.where("texture"),
                    f"the mask '{name}' of pass '{pass_.name}' is written by no earlier pass of "
                    f"pipeline '{pipeline.name}'",
                )


@check
def check_completeness(context: LintContext) -> Iterator[Diagnostic]:
    """Check entry point, render target, outputs and ray types."""
    for _, pass_ in raytrace_passes(context.project):
        if pass_.rtEntryPoint is None or pass_.rtEntryPoint.rayGen is None:
            yield T008.at(
                pass_.location, f"raytrace pass '{pass_.name}' has no ray generation program"
            )
        if pass_.renderTarget is None:
            yield T008.at(pass_.location, f"raytrace pass '{pass_.name}' has no <renderTarget>")
        if not pass_.ray_types:
            yield T008.at(pass_.location, f"raytrace pass '{pass_.name}' has no ray type")
        compiled = launches_ptx(pass_, context.project.folder)
        for output in pass_.rtOutput if not compiled else []:
            yield T009.at(
                output.location,
                f"output '{output.var}' of pass '{pass_.name}' is not written by Python programs",
            )
        declared = [t.name for t in pass_.rtRayTypes if t.name]
        for material in pass_.materials:
            for group in material.rayTypes:
                if declared and group.name and group.name not in declared:
                    yield T007.at(
                        group.where("name"),
                        f"ray type '{group.name}' of pass '{pass_.name}' is not declared; there is "
                        f"{format_names(declared)}{suggest_name(group.name, declared)}",
                        fixes=suggest_fix(group.where("name"), group.name, declared),
                    )

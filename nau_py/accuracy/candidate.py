"""Candidates: values of the knobs of a project, and the project with these values."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import product

from nau_py.diagnostics.diagnostic import error
from nau_py.diagnostics.errors import ProjectError
from nau_py.diagnostics.location import Location
from nau_py.model.accuracy import Accuracy
from nau_py.model.attributes.texture import COLOR_FORMATS
from nau_py.model.knob import IdleKnob, Value, find_knob_target, pick_raytrace_passes
from nau_py.model.linked import Project
from nau_py.model.passes import Pass
from nau_py.model.pipeline import Pipeline
from nau_py.passes.frame import RunOptions
from nau_py.run.pipeline_choice import choose_pipeline

AS_IT_IS = "project"
"""Value of a knob that keeps the project's own value."""
DEFAULT_SPP = "1, 4, 16, 64"
DEFAULT_DEPTH = "1, 2, 3, 4"
_SUFFIXES = {"8-bit": "", "half": "16F", "float": "32F"}
Ladders = dict[str, tuple[Value, ...]]


@dataclass(frozen=True, slots=True)
class Candidate:
    """Values of the knobs of a sweep by name, in the order of the ladders."""

    values: tuple[tuple[str, Value], ...]

    def __getitem__(self, knob: str) -> Value | None:
        return dict(self.values).get(knob)

    def with_value(self, knob: str, value: Value) -> Candidate:
        """Return the same candidate with another value of one knob."""
        return Candidate(tuple((dict(self.values) | {knob: value}).items()))

    @property
    def label(self) -> str:
        return ", ".join(f"{name} {_text(value)}" for name, value in self.values)


def _text(value: Value) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def read_ladders(project: Project, pipeline: Pipeline, given: Mapping[str, str]) -> Ladders:
    """Read the values to try: those ``given`` (knob to text), else the project's, else the default:
    samples 1, 4, 16, 64, depth 1 to 4, and the mask against tracing every pixel.

    Raises :class:`~nau_py.ProjectError` for knobs that do not exist or wrong values.
    """
    node = project.file.accuracy
    where = project.file.location
    texts: dict[str, tuple[str, Location]] = {k: (v, where) for k, v in given.items()}
    if not texts and node is not None:
        texts = {k.name or "": (k.values or "", k.where("values")) for k in node.knobs}
    if not texts:
        texts = {"spp": (DEFAULT_SPP, where), "depth": (DEFAULT_DEPTH, where)}
        if any(p.mask for p in pick_raytrace_passes(pipeline.passes)):
            texts["mask"] = ("project, all", where)
    found: Ladders = {}
    errors = []
    for name, (text, place) in texts.items():
        try:
            found[name] = find_knob_target(project, pipeline.passes, name).parse_values(text)
        except LookupError as problem:
            errors.append(error("A001", place, str(problem.args[0])))
        except IdleKnob as problem:
            errors.append(error("A003", place, str(problem)))
        except ValueError as problem:
            errors.append(error("A002", place, f"knob '{name}': {problem}"))
    if errors:
        raise ProjectError(errors)
    return found


def make_base(project: Project, pipeline: Pipeline, turned: Ladders) -> Candidate:
    """Make the candidate of the unchanged project."""
    values: list[tuple[str, Value]] = []
    for name in turned:
        own = find_knob_target(project, pipeline.passes, name).get(project)
        values.append((name, 1.0 if name == "scale" else AS_IT_IS if own is None else own))
    return Candidate(tuple(values))


def make_candidates(start: Candidate, turned: Ladders, combine: bool) -> list[Candidate]:
    """Make ``start``, and ``start`` with each value of each knob; or all combinations."""
    if combine:
        found = [Candidate(tuple(zip(turned, values))) for values in product(*turned.values())]
    else:
        found = [
            start.with_value(name, value) for name, values in turned.items() for value in values
        ]
    return list(dict.fromkeys([start, *found]))


def choose_best(
    project: Project, pipeline: Pipeline, start: Candidate, turned: Ladders
) -> Candidate:
    """Choose the most accurate value of each knob but spp, for the reference. A pipeline with a
    mask is traced everywhere."""
    wanted = dict(start.values)
    if "depth" in turned:
        wanted["depth"] = max([wanted["depth"], *turned["depth"]], key=float)
    if any(p.mask for p in pick_raytrace_passes(pipeline.passes)):
        wanted["mask"] = "all"
    for name, value in (("target-error", 0.0), ("scale", 1.0), ("format", "float")):
        if name in turned:
            wanted[name] = value
    return Candidate(tuple(wanted.items()))


@dataclass(frozen=True, slots=True)
class Prepared:
    """A candidate that can be rendered: its own copy of the project, options and window size."""

    project: Project
    options: RunOptions
    size: tuple[int, int]


def prepare_candidate(
    project: Project,
    pipeline: Pipeline,
    candidate: Candidate,
    options: RunOptions,
    size: tuple[int, int],
) -> Prepared:
    """Set the knobs of a copy of ``project``. Pictures are kept in floats, frames are not added up
    (ACCUMULATE), unless the knob ``format`` says otherwise."""
    changed = copy.deepcopy(project)
    passes = choose_pipeline(changed, pipeline.name).passes
    for pass_ in pick_raytrace_passes(passes):
        find_knob_target(changed, [pass_], f"{pass_.name}/ACCUMULATE").set(0)
    options = replace(options, window_format="RGBA32F")
    for name, value in candidate.values:
        if name == "mask":
            options = replace(options, mask=str(value))
        elif value == AS_IT_IS:
            continue
        elif name == "scale":
            width, height = size
            size = max(round(width * float(value)), 1), max(round(height * float(value)), 1)
        elif name == "filter":
            options = replace(options, texture_filter=str(value).upper())
        elif name == "format":
            suffix = _SUFFIXES[str(value)]
            options = replace(options, window_format=f"RGBA{suffix}")
            _set_format(changed, passes, suffix)
        else:
            find_knob_target(changed, passes, name).set(value)
    return Prepared(changed, options, size)


def _set_format(project: Project, passes: list[Pass], suffix: str) -> None:
    """Give the traced target texels of the same channels and another type."""
    for pass_ in pick_raytrace_passes(passes):
        owner = project.target_of(pass_)
        if owner is None or not owner[1].colors:
            continue
        color = owner[1].colors[0]
        channels = (color.internalFormat or "RGBA").rstrip("0123456789FUI")
        name = channels + (suffix or ("" if channels == "RGBA" else "8"))
        color.internalFormat = name if name in COLOR_FORMATS else f"RGBA{suffix}"


def read_cost_settings(project: Project) -> Accuracy:
    """Return the element of the project with the settings of its cost run."""
    return project.file.accuracy or Accuracy()

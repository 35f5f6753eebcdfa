"""L: parts of a project that this version does not run."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from nau_py.diagnostics.catalogue import NOTE, WARNING, rule
from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.model.material import ValueOf
from nau_py.model.raytrace import RayVariable
from nau_py.model.walk import walk_nodes
from nau_py.rules.registry import LintContext, check

UNSUPPLIED_TYPES = ("SPHERE", "GRID", "PHYSICS_MANAGER", "PHYSICS_MATERIAL")
"""Object types that give no values to uniforms and parameters."""

L007 = rule(
    "L007",
    WARNING,
    "Value is not supplied",
    "This version has no values of that object type; the uniform keeps its value.",
    "<valueof uniform='s' type='GRID' context='S::g' component='LENGTH'/>",
    "<valueof uniform='s' type='RENDERER' context='CURRENT' component='MODEL'/>",
)
L006 = rule(
    "L006",
    NOTE,
    "Pipeline without an end",
    "In mode RUN_ALL a pipeline with neither frameCount nor testScript runs forever; the "
    "pipelines after it never run.",
    "<pipelines mode='RUN_ALL'><pipeline name='A'/><pipeline name='B'/>",
    "<pipelines mode='RUN_ALL'><pipeline name='A' frameCount='100'/><pipeline name='B'/>",
)
L002 = rule(
    "L002",
    WARNING,
    "Physics is not simulated",
    "Physics libraries are read and checked, but they move nothing.",
    "<physicsLib filename='a.plib'/>",
    "leave it out",
)


@check
def check_endless_pipelines(context: LintContext) -> Iterator[Diagnostic]:
    """Report pipelines that never end, so that the next one never runs."""
    pipelines = context.project.file.pipelines
    if pipelines is None or pipelines.mode != "RUN_ALL":
        return
    for pipeline, after in pairwise(pipelines.pipelines):
        if not pipeline.frameCount and pipeline.testScript is None:
            yield L006.at(
                pipeline.location,
                f"pipeline '{pipeline.name}' has neither frameCount nor testScript, so in mode "
                f"RUN_ALL '{after.name}' never runs",
            )


@check
def check_supplied_values(context: LintContext) -> Iterator[Diagnostic]:
    """Report uniforms and parameters of object types without values."""
    for node in walk_nodes(context.project):
        if isinstance(node, ValueOf | RayVariable) and node.type in UNSUPPLIED_TYPES:
            yield L007.at(
                node.where("type"),
                f"'{node.component}' of type {node.type} is not supplied by this version",
            )


@check
def check_physics(context: LintContext) -> Iterator[Diagnostic]:
    """Report physics libraries, which are not simulated."""
    for library in context.project.assets.physicsLibs:
        yield L002.at(
            library.location, f"physics library '{library.filename}' is checked, not simulated"
        )

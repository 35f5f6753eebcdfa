"""Rules D: resources that passes exchange."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from nau_py.diagnostics.catalogue import ERROR, NOTE, WARNING, rule
from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.diagnostics.location import Location
from nau_py.graph.contract import Access
from nau_py.graph.plan import Plan, make_plan
from nau_py.graph.resource import Resource
from nau_py.model.attributes.texture import count_channels
from nau_py.model.linked import Project
from nau_py.model.passes import Pass
from nau_py.model.raytrace import RaytracePass
from nau_py.rules.passes import target_size
from nau_py.rules.registry import LintContext, check

D001 = rule(
    "D001",
    NOTE,
    "Target read before it is written",
    "Only a later pass writes it, so the pass reads what the previous frame left.",
    "a pass samples 'L::accum', a later one draws into it",
    "let the writing pass come first",
)
D002 = rule(
    "D002",
    WARNING,
    "Target that nothing writes",
    "A pass reads a render target's texture that no pass of the pipeline writes.",
    "<texture name='color' fromLibrary='L'/> with no pass drawing into it",
    "draw into the render target in an earlier pass",
)
D003 = rule(
    "D003",
    WARNING,
    "Pass without effect",
    "Nothing that the picture needs reads what the pass writes, so it is left out.",
    "a pass draws into 'L::shadow', which nothing reads",
    "read it, or take the pass out",
)
D004 = rule(
    "D004",
    ERROR,
    "Cycle: a pass reads what it draws into",
    "Sampling a texture while drawing into it is undefined in OpenGL.",
    "<renderTarget name='r' …/> and a material that binds a texture of 'r'",
    "draw into another target, or read another texture",
)
D005 = rule(
    "D005",
    ERROR,
    "Sizes do not match",
    "An input of a raytrace pass is read pixel by pixel, so it needs the target's size.",
    "a mask of 512 x 512 for a target of 1024 x 1024",
    "give both render targets one SIZE",
)
D006 = rule(
    "D006",
    ERROR,
    "Formats do not match",
    "The texture does not have what the pass reads from or writes to it.",
    "<buffer var='mask' texture='L::r8' mask='w'/>",
    "use an RGBA32F texture, or mask='x'",
)
D007 = rule(
    "D007",
    NOTE,
    "Cycle over frames",
    "Passes feed each other, and the cycle is closed by what the previous frame left in a target.",
    "a pass reads 'L::history' and a later one writes it from what the first one drew",
    "wanted for accumulation; else let the writing pass come first",
)


def target_textures(project: Project, pass_: Pass) -> list[str]:
    """List the qualified names of the textures of a pass's render target: none for the window."""
    owner = project.target_of(pass_)
    return [f"{owner[0]}::{name}" for name in owner[1].texture_names] if owner else []


def _plans(context: LintContext) -> Iterator[Plan]:
    for pipeline in context.project.pipelines:
        yield make_plan(context.project, pipeline, context.contracts)


@check
def flow(context: LintContext) -> Iterator[Diagnostic]:
    """Report reads before writes, reads without writes, passes without effect, and cycles."""
    for plan in _plans(context):
        yield from _early_reads(plan)
        for pass_, access in zip(plan.dependencies.passes, plan.dependencies.accesses):
            yield from _unwritten_reads(context.project, plan, pass_, access)
            yield from _feedback(context.project, pass_, access)
        for step in plan.steps:
            if not step.run and step.pass_.pass_class in context.contracts:
                yield D003.at(
                    step.pass_.location,
                    f"pass '{step.name}' of pipeline '{plan.pipeline}' is left out: {step.reason}",
                )


def _early_reads(plan: Plan) -> Iterator[Diagnostic]:
    """Report reads of the previous frame's content, and the cycles that they close."""
    dependencies = plan.dependencies
    for index, resource in dependencies.previous_frame_reads():
        writer = dependencies.passes[dependencies.writers(resource)[0]]
        pass_ = dependencies.passes[index]
        yield D001.at(
            pass_.location,
            f"pass '{pass_.name}' reads {resource}, which only the later pass "
            f"'{writer.name}' writes: it sees the previous frame",
            ((writer.location, f"written by '{writer.name}'"),),
        )
    if dependencies.has_frame_cycle():
        yield from _cycles_over_frames(plan)


def _cycles_over_frames(plan: Plan) -> Iterator[Diagnostic]:
    # Only here does lint need networkx, whose import takes a quarter of a second.
    from nau_py.graph.network import find_frame_cycles

    graph = plan.graph
    for cycle in find_frame_cycles(graph):
        steps = [plan.steps[graph.nodes[node]["index"]] for node in cycle[::2]]
        resources = cycle[1::2]
        chain = " → ".join(
            f"'{step.name}' ({_short(step.pass_.location)}) → {resource}"
            for step, resource in zip(steps, resources)
        )
        first = steps[0].pass_.location
        yield D007.at(
            first,
            f"cycle over frames: {chain} → '{steps[0].name}'; it is closed by {resources[-1]} of "
            "the previous frame",
            tuple(
                (step.pass_.location, f"'{step.name}' reads {before} and writes {after}")
                for step, before, after in zip(steps, [resources[-1], *resources], resources)
            ),
        )


def _short(location: Location) -> str:
    """Format a location with the bare file name; the diagnostic's places have the folders."""
    return str(replace(location, file=Path(location.file).name))


def _unwritten_reads(
    project: Project, plan: Plan, pass_: Pass, access: Access
) -> Iterator[Diagnostic]:
    for resource in access.reads:
        if _is_target(project, resource) and not plan.dependencies.writers(resource):
            yield D002.at(
                pass_.location,
                f"pass '{pass_.name}' reads {resource}, a target that no pass of pipeline "
                f"'{plan.pipeline}' writes",
            )


def _feedback(project: Project, pass_: Pass, access: Access) -> Iterator[Diagnostic]:
    own = target_textures(project, pass_)
    for resource in access.reads:
        sampled = resource in access.writes and resource not in access.keeps
        if sampled and resource.name in own:
            yield D004.at(
                pass_.location,
                f"cycle: pass '{pass_.name}' samples {resource} while drawing into it",
            )


def _is_target(project: Project, resource: Resource) -> bool:
    return resource.kind == "texture" and project.target_of_texture(resource.name) is not None


@check
def raytrace_inputs(context: LintContext) -> Iterator[Diagnostic]:
    """Report sizes and formats that do not match in what raytrace passes read and write."""
    project = context.project
    for pipeline in project.pipelines:
        sized = {
            name: p.viewport.name if p.viewport else None
            for p in pipeline.passes
            for name in target_textures(project, p)
        }
        for pass_ in pipeline.passes:
            if isinstance(pass_, RaytracePass):
                yield from _inputs(project, pass_, sized)


def _inputs(
    project: Project, pass_: RaytracePass, sized: dict[str, str | None]
) -> Iterator[Diagnostic]:
    owned = project.target_of(pass_)
    target = owned[1] if owned else None
    if target is not None and target.colors:
        fmt = target.colors[0].internalFormat or "RGBA"
        if fmt.endswith("I"):
            yield D006.at(
                target.colors[0].location,
                f"raytrace pass '{pass_.name}' writes colours to '{target.colors[0].name}', whose "
                f"format '{fmt}' holds integers",
            )
    own_viewport = pass_.viewport.name if pass_.viewport else None
    for source in pass_.rtInput:
        owner = project.target_of_texture(source.texture or "")
        if owner is None:
            continue
        node = owner[1]
        same_viewport = own_viewport is not None and sized.get(source.texture or "") == own_viewport
        if target is not None and not same_viewport:
            wanted, given = target_size(project, target), target_size(project, node)
            what = f"raytrace pass '{pass_.name}': input '{source.texture}'"
            if wanted != given:
                yield D005.at(
                    source.where("texture"),
                    f"{what} is {given[0]} x {given[1]}, its render target '{target.name}' "
                    f"{wanted[0]} x {wanted[1]}",
                )
            elif sized.get(source.texture or "") != own_viewport:
                yield D005.at(
                    source.where("texture"),
                    f"{what} and render target '{target.name}' are drawn through different "
                    "viewports, which resize them",
                )
        short = (source.texture or "").split("::")[-1]
        attachment = next((c for c in node.colors if c.name == short), None)
        count = count_channels(attachment.internalFormat or "RGBA") if attachment else 1
        if source.mask in ("x", "y", "z", "w") and "xyzw".index(source.mask) >= count:
            yield D006.at(
                source.where("mask"),
                f"mask component '{source.mask}' of input '{source.texture}': the texture has "
                f"{count} channels",
            )

"""D: what passes hand to each other."""

from __future__ import annotations

from collections.abc import Iterator

from nau_py.diagnostics.catalogue import ERROR, NOTE, WARNING, rule
from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.graph.plan import Plan, make_plan
from nau_py.graph.resource import Resource
from nau_py.model.attributes.texture import channels
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


def target_textures(project: Project, pass_: Pass) -> list[str]:
    """Qualified names of the textures of a pass's render target; none for the window."""
    owner = project.target_of(pass_)
    return [f"{owner[0]}::{name}" for name in owner[1].texture_names] if owner else []


def _plans(context: LintContext) -> Iterator[Plan]:
    for pipeline in context.project.pipelines:
        yield make_plan(context.project, pipeline, context.contracts)


@check
def flow(context: LintContext) -> Iterator[Diagnostic]:
    """Reads before writes, reads without writes, passes without effect, feedback."""
    project = context.project
    for plan in _plans(context):
        graph = plan.graph
        for index, resource in graph.history:
            if resource in graph.accesses[index].writes:
                continue  # it may well write before it reads
            writer = graph.passes[graph.writers(resource)[0]]
            pass_ = graph.passes[index]
            yield D001.at(
                pass_.location,
                f"pass '{pass_.name}' reads {resource}, which only the later pass "
                f"'{writer.name}' writes: it sees the previous frame",
                ((writer.location, f"written by '{writer.name}'"),),
            )
        for pass_, access in zip(graph.passes, graph.accesses):
            for resource in access.reads:
                if _is_target(project, resource) and not graph.writers(resource):
                    yield D002.at(
                        pass_.location,
                        f"pass '{pass_.name}' reads {resource}, a target that no pass of pipeline "
                        f"'{plan.pipeline}' writes",
                    )
            feedback = [r for r in access.reads if r in access.writes and r not in access.keeps]
            own = target_textures(project, pass_)
            for resource in feedback:
                if resource.name in own:
                    yield D004.at(
                        pass_.location,
                        f"cycle: pass '{pass_.name}' samples {resource} while drawing into it",
                    )
        for step in plan.steps:
            if not step.run and step.pass_.pass_class in context.contracts:
                yield D003.at(
                    step.pass_.location,
                    f"pass '{step.name}' of pipeline '{plan.pipeline}' is left out: {step.reason}",
                )


def _is_target(project: Project, resource: Resource) -> bool:
    return resource.kind == "texture" and project.target_of_texture(resource.name) is not None


@check
def raytrace_inputs(context: LintContext) -> Iterator[Diagnostic]:
    """Sizes and formats of what raytrace passes read and write."""
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
        count = channels(attachment.internalFormat or "RGBA") if attachment else 1
        if source.mask in ("x", "y", "z", "w") and "xyzw".index(source.mask) >= count:
            yield D006.at(
                source.where("mask"),
                f"mask component '{source.mask}' of input '{source.texture}': the texture has "
                f"{count} channels",
            )

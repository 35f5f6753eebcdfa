"""N: names that are defined twice."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from nau_py.diagnostics.catalogue import ERROR, WARNING, Rule, rule
from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.model.library import MaterialLibrary
from nau_py.model.node import Node
from nau_py.model.walk import list_own_libraries
from nau_py.rules.registry import LintContext, check

N001 = rule(
    "N001",
    ERROR,
    "Duplicate name",
    "Two objects of one kind share a name; a reference could mean either.",
    "<camera name='Eye'/> <camera name='Eye'/>",
    "<camera name='Eye'/> <camera name='Left'/>",
)
N002 = rule(
    "N002",
    WARNING,
    "Duplicate name, merged",
    "Nau merges lights, scenes and passes of one name, or cannot tell them apart.",
    "<light name='Sun'/> <light name='Sun'/>",
    "<light name='Sun'/> <light name='Lamp'/>",
)


def _duplicates(kind: str, nodes: Iterable[Node], found: Rule) -> Iterator[Diagnostic]:
    seen: dict[str, Node] = {}
    for node in nodes:
        name = getattr(node, "name", None)
        if name is None:
            continue
        first = seen.setdefault(name, node)
        if first is not node:
            yield found.at(
                node.where("name"),
                f"{kind} '{name}' is defined a second time; it was defined at "
                f"{first.where('name')}",
                ((first.where("name"), f"first {kind} '{name}'"),),
            )


@check
def check_project_names(context: LintContext) -> Iterator[Diagnostic]:
    """Check cameras, viewports and pipelines; lights, scenes and passes, which Nau merges."""
    project = context.project
    assets = project.assets
    yield from _duplicates("camera", assets.cameras, N001)
    yield from _duplicates("viewport", assets.viewports, N001)
    yield from _duplicates("pipeline", project.pipelines, N001)
    yield from _duplicates("light", assets.lights, N002)
    yield from _duplicates("scene", assets.scenes, N002)
    yield from _duplicates("user attribute", assets.attributes, N001)
    for library in project.physics:
        yield from _duplicates("physics material", library.materials, N001)
    for pipeline in project.pipelines:
        yield from _duplicates(f"pass of pipeline '{pipeline.name}'", pipeline.passes, N002)


def _attachments(libraries: list[MaterialLibrary]) -> list[Node]:
    found: list[Node] = []
    for target in (t for lib in libraries for t in lib.renderTargets):
        found += target.colors
        found += [a for a in (target.depth, target.depthStencil) if a is not None]
    return found


@check
def check_library_names(context: LintContext) -> Iterator[Diagnostic]:
    """Check the names in libraries. Libraries of one name share a name space."""
    libraries = list_own_libraries(context.project)
    for name in dict.fromkeys(lib.name for lib in libraries):
        same = [lib for lib in libraries if lib.name == name]
        kinds: dict[str, list[Node]] = {
            "render target": [t for lib in same for t in lib.renderTargets],
            "texture": [t for lib in same for t in lib.textures],
            "state": [s for lib in same for s in lib.states],
            "shader": [s for lib in same for s in lib.shaders],
            "buffer": [b for lib in same for b in lib.buffers],
            "material": [m for lib in same for m in lib.materials],
        }
        for kind, listed in kinds.items():
            yield from _duplicates(f"{kind} of library '{name}'", listed, N001)
        attachments = _attachments(same)
        yield from _duplicates(f"attachment of library '{name}'", attachments, N002)

"""Qualified names of references: the library in which a short name is looked up."""

from __future__ import annotations

from collections.abc import Container, Iterator

from nau_py.model.attributes import OBJECT_TYPES
from nau_py.model.library import DEFAULT_LIBRARY
from nau_py.model.linked import Project
from nau_py.model.node import Attr, Node
from nau_py.model.walk import walk_nodes

PLAIN_KINDS = (
    "scene", "camera", "light", "viewport", "pipeline", "library", "pass", "object type",
)  # fmt: skip
"""Kinds of names that belong to no library."""
_OWN_LIBRARY = ("shader", "state")
CONTEXTS = {"CAMERA": "camera", "LIGHT": "light", "VIEWPORT": "viewport", "SCENE": "scene"}
"""Object types whose ``context`` names an object, with the kind of that name."""


def walk_owned_nodes(project: Project) -> Iterator[tuple[Node, str]]:
    """Yield every node with the name of its library; an empty name in the project file."""
    own = {id(n): lib.name or "" for lib in project.libraries[1:] for n in lib.walk()}
    for node in walk_nodes(project):
        yield node, own.get(id(node), "")


def qualify_reference(
    node: Node, attribute: Attr, library: str, value: str, buffers: Container[str] = ()
) -> str:
    """Qualify the name that an attribute of ``node`` refers to: ``lib::name``, or the plain name
    for a kind that belongs to no library.

    ``library`` is the library of the node itself. Names in ``buffers`` are looked up in a second
    library too (docs/format.md, 6.8).
    """
    if attribute.ref in PLAIN_KINDS or ("::" in value and attribute.ref not in _OWN_LIBRARY):
        return value
    given = getattr(node, attribute.library) if attribute.library else None
    qualified = f"{given or library or DEFAULT_LIBRARY}::{value}"
    if attribute.ref == "buffer" and qualified not in buffers:
        qualified = f"{getattr(node, 'fromLibrary', None) or library}::{value}"
    return qualified


_ALWAYS = {
    "camera": ["__nauDefault"],
    "light": ["__nauDefault"],
    "viewport": ["__nauDefault"],
}


def _light_cameras(project: Project) -> list[str]:
    return [
        f"{pipeline.name}#{p.name}-LightCam"
        for pipeline in project.pipelines
        for p in pipeline.passes
        if p.pass_class.startswith("depthmap")
    ]


def list_pass_libraries(project: Project) -> list[str]:
    """List the libraries that passes make for their own materials."""
    return [f"{pl.name}#{p.name}" for pl in project.pipelines for p in pl.passes]


def list_known_names(project: Project, kind: str) -> list[str]:
    """List every qualified name that a reference of a kind can have."""
    if kind == "object type":
        return list(OBJECT_TYPES)
    if kind == "pass":
        return [p.name for pl in project.pipelines for p in pl.passes if p.name]
    known = list(project.names(kind)) + _ALWAYS.get(kind, [])
    if kind in ("camera", "scene"):  # a camera is also a scene that shows its frustum
        known += _light_cameras(project)
    if kind == "library":
        known += list_pass_libraries(project)
    return known

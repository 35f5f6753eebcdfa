"""What a reference of a file names, in full: the library that a short name is looked up in."""

from __future__ import annotations

from collections.abc import Container, Iterator

from nau_py.model.attributes import OBJECT_TYPES
from nau_py.model.library import DEFAULT_LIBRARY
from nau_py.model.linked import Project
from nau_py.model.node import Attr, Node
from nau_py.model.walk import nodes

PLAIN_KINDS = (
    "scene", "camera", "light", "viewport", "pipeline", "library", "pass", "object type",
)  # fmt: skip
"""Kinds of names that stand in no library."""
_OWN_LIBRARY = ("shader", "state")
CONTEXTS = {"CAMERA": "camera", "LIGHT": "light", "VIEWPORT": "viewport", "SCENE": "scene"}
"""Object types whose ``context`` names an object, and the kind of name."""


def owned_nodes(project: Project) -> Iterator[tuple[Node, str]]:
    """Every node with the name of the library that it stands in; empty in the project file."""
    own = {id(n): lib.name or "" for lib in project.libraries[1:] for n in lib.walk()}
    for node in nodes(project):
        yield node, own.get(id(node), "")


def qualified_reference(
    node: Node, marker: Attr, library: str, value: str, buffers: Container[str] = ()
) -> str:
    """The qualified name (``lib::name``, or the name of a plain kind) that attribute ``marker`` of
    ``node`` refers to. ``library``: the one that the node stands in. ``buffers``: known buffers,
    which are looked up in a second library too (docs/format.md, 6.8)."""
    if marker.ref in PLAIN_KINDS or ("::" in value and marker.ref not in _OWN_LIBRARY):
        return value
    given = getattr(node, marker.library) if marker.library else None
    wanted = f"{given or library or DEFAULT_LIBRARY}::{value}"
    if marker.ref == "buffer" and wanted not in buffers:
        wanted = f"{getattr(node, 'fromLibrary', None) or library}::{value}"
    return wanted


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


def pass_libraries(project: Project) -> list[str]:
    """The libraries that passes make for their own materials."""
    return [f"{pl.name}#{p.name}" for pl in project.pipelines for p in pl.passes]


def known_names(project: Project, kind: str) -> list[str]:
    """Every name that a reference of a kind can have, qualified."""
    if kind == "object type":
        return list(OBJECT_TYPES)
    if kind == "pass":
        return [p.name for pl in project.pipelines for p in pl.passes if p.name]
    known = list(project.names(kind)) + _ALWAYS.get(kind, [])
    if kind in ("camera", "scene"):  # a camera is also a scene that shows its frustum
        known += _light_cameras(project)
    if kind == "library":
        known += pass_libraries(project)
    return known

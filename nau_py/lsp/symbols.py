"""The names of a project: where each is defined, and where it is used."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from nau_py.diagnostics.diagnostic import Change, Part
from nau_py.diagnostics.location import Location
from nau_py.model.interface import InterfaceVariable
from nau_py.model.library import DEFAULT_LIBRARY
from nau_py.model.linked import Project
from nau_py.model.maps import InjectionMap, MaterialMap
from nau_py.model.material import ValueOf
from nau_py.model.node import Node
from nau_py.model.raytrace import RayMaterial, RaytracePass, RayVariable
from nau_py.model.references import (
    CONTEXTS,
    known_names,
    owned_nodes,
    qualified_reference,
)
from nau_py.model.schema import AttributeField, SettingsField, schema_of
from nau_py.syntax.document import Document
from nau_py.syntax.edit import make_document

Span = tuple[str, int, int]
"""File, and the characters of its text from begin to end."""


@dataclass(frozen=True, slots=True)
class Symbol:
    """One place where a name is written. ``name`` is the qualified one, ``text`` what stands
    there of it."""

    kind: str
    name: str
    text: str
    location: Location
    part: Part = Part.VALUE


class Symbols:
    """Every name of a project, with the spans of its text."""

    def __init__(self, project: Project) -> None:
        self.project = project
        self._documents: dict[str, Document] = {}

    @cached_property
    def definitions(self) -> list[Symbol]:
        return list(_definitions(self.project))

    @cached_property
    def references(self) -> list[Symbol]:
        return list(_references(self.project))

    def document(self, file: str) -> Document | None:
        """The text of a file of the project."""
        if file not in self._documents:
            text = self.project.sources.get(file)
            if text is None:
                return None
            self._documents[file] = make_document(Path(file), text)
        return self._documents[file]

    def span(self, symbol: Symbol) -> Span | None:
        """The characters of a name; None where the text does not have it there."""
        document = self.document(symbol.location.file)
        if document is None or not symbol.text:
            return None
        change = Change(symbol.location, symbol.part, symbol.text, "?")
        edits = document.make_change(change)
        return (symbol.location.file, edits[0][0], edits[0][1]) if edits else None

    def at(self, file: str, offset: int) -> Symbol | None:
        """The name that is written at a character."""
        for symbol in [*self.definitions, *self.references]:
            if symbol.location.file == file:
                span = self.span(symbol)
                if span is not None and span[1] <= offset <= span[2]:
                    return symbol
        return None

    def same(self, symbol: Symbol) -> tuple[list[Symbol], list[Symbol]]:
        """The definitions and the references of a symbol's name."""
        wanted = (symbol.kind, symbol.name)
        return (
            [s for s in self.definitions if (s.kind, s.name) == wanted],
            [s for s in self.references if (s.kind, s.name) == wanted],
        )


def _named(kind: str, nodes: list[Node], library: str = "") -> Iterator[Symbol]:
    for node in nodes:
        name = getattr(node, "name", None)
        if name:
            full = f"{library}::{name}" if library else name
            yield Symbol(kind, full, name, node.where("name"))


def _definitions(project: Project) -> Iterator[Symbol]:
    assets = project.assets
    yield from _named("scene", [*assets.scenes])
    yield from _named("camera", [*assets.cameras])
    yield from _named("viewport", [*assets.viewports])
    yield from _named("light", [*assets.lights])
    yield from _named("constant", [*assets.constants, *assets.aliases])
    yield from _named("pipeline", [*project.pipelines])
    for attribute in assets.attributes:
        yield from _named(f"attribute of {attribute.type}", [attribute])
    for pipeline in project.pipelines:
        yield from _named("pass", [*pipeline.passes])
        for pass_ in pipeline.passes:
            if isinstance(pass_, RaytracePass):
                yield from _named("ray type", [*pass_.rtRayTypes])
    for library in project.libraries[1:]:
        name = library.name or ""
        yield from _named("library", [library])
        yield from _named("material", [*library.materials], name)
        yield from _named("shader", [*library.shaders], name)
        yield from _named("state", [*library.states], name)
        yield from _named("render target", [*library.renderTargets], name)
        yield from _named("texture array", [*library.arraysOfTextures], name)
        yield from _named("buffer", [*library.buffers], name)
        yield from _named("texture", [*library.textures], name)
        for target in library.renderTargets:
            yield from _named("texture", [*target.colors], name)
            hidden = [d for d in (target.depth, target.depthStencil) if d is not None]
            yield from _named("texture", [*hidden], name)


def _references(project: Project) -> Iterator[Symbol]:
    buffers = set(known_names(project, "buffer"))
    scenes = {scene.name for scene in project.assets.scenes}
    for node, library in owned_nodes(project):
        schema = schema_of(type(node))
        for attribute in schema.attributes:
            for symbol in _attribute(node, attribute, library, buffers):
                if symbol.kind == "scene" and symbol.name not in scenes:
                    symbol = replace(symbol, kind="camera")  # cameras are scenes too
                yield symbol
        for part in [*schema.settings, *schema.inline]:
            yield from _settings(project, node, part)
        yield from _special(node)


def _attribute(
    node: Node, attribute: AttributeField, library: str, buffers: set[str]
) -> Iterator[Symbol]:
    value = attribute.of(node)
    if not isinstance(value, str) or not value:
        return
    where = node.where(attribute.name)
    if attribute.constant:
        yield Symbol("constant", value, value, where)
    if not attribute.ref or attribute.ref == "object type":
        return
    name = qualified_reference(node, attribute, library, value, buffers)
    head, _, tail = value.rpartition("::")
    yield Symbol(attribute.ref, name, tail, where)
    if head:
        yield Symbol("library", head, head, where)


def _settings(project: Project, node: Node, part: SettingsField) -> Iterator[Symbol]:
    for tag, setting in part.of(node).items():
        attribute = part.known(project.registry).get(tag)
        if part.as_tags:
            kind = f"attribute of {part.type}"
            yield Symbol(kind, tag, tag, setting.location, Part.ELEMENT)
        for value in setting.parts if attribute is not None else ():
            if not isinstance(value, str) or attribute is None:
                continue
            if attribute.reference:
                yield Symbol(attribute.reference, value, value, setting.location)
            elif attribute.type.is_number:
                yield Symbol("constant", value, value, setting.location)


def _special(node: Node) -> Iterator[Symbol]:
    """Names whose kind another attribute says, or that models define too."""
    if isinstance(node, ValueOf | RayVariable | InterfaceVariable) and node.type:
        kind = CONTEXTS.get(node.type)
        if kind and node.context and node.context != "CURRENT":
            yield Symbol(kind, node.context, node.context, node.where("context"))
        if node.component:
            where = node.where("component")
            yield Symbol(f"attribute of {node.type}", node.component, node.component, where)
    pattern: str | None = None
    key = ""
    if isinstance(node, MaterialMap):
        pattern, key = node.fromMaterial, "fromMaterial"
    elif isinstance(node, InjectionMap):
        pattern, key = node.toMaterial, "toMaterial"
    elif isinstance(node, RayMaterial):
        pattern, key = node.to, "to"
        for group in node.rayTypes:
            if group.name:
                yield Symbol("ray type", group.name, group.name, group.where("name"))
    if pattern and not pattern.endswith("*"):
        yield Symbol("material", f"{DEFAULT_LIBRARY}::{pattern}", pattern, node.where(key))

"""The names of a project, with the places that define and use each."""

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
    list_known_names,
    qualify_reference,
    walk_owned_nodes,
)
from nau_py.model.schema import AttributeField, SettingsField, schema_of
from nau_py.syntax.document import Document
from nau_py.syntax.edit import make_document

Span = tuple[str, int, int]
"""A file, with the begin and the end of a word in characters of its text."""


@dataclass(frozen=True, slots=True)
class Symbol:
    """One place at which a name is written.

    ``name`` is the qualified name, ``text`` the part of it that is written there.
    """

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
        return list(_collect_definitions(self.project))

    @cached_property
    def references(self) -> list[Symbol]:
        return list(_collect_references(self.project))

    def find_document(self, file: str) -> Document | None:
        """Return the text of a file of the project; None for another file."""
        if file not in self._documents:
            text = self.project.sources.get(file)
            if text is None:
                return None
            self._documents[file] = make_document(Path(file), text)
        return self._documents[file]

    def find_span(self, symbol: Symbol) -> Span | None:
        """Return the characters of a name; None where the text differs."""
        document = self.find_document(symbol.location.file)
        if document is None or not symbol.text:
            return None
        change = Change(symbol.location, symbol.part, symbol.text, "?")
        edits = document.make_change(change)
        return (symbol.location.file, edits[0][0], edits[0][1]) if edits else None

    def find_symbol(self, file: str, offset: int) -> Symbol | None:
        """Return the name at a character; None where there is none."""
        for symbol in [*self.definitions, *self.references]:
            if symbol.location.file == file:
                span = self.find_span(symbol)
                if span is not None and span[1] <= offset <= span[2]:
                    return symbol
        return None

    def find_same(self, symbol: Symbol) -> tuple[list[Symbol], list[Symbol]]:
        """Return the definitions and the references of a symbol's name."""
        wanted = (symbol.kind, symbol.name)
        return (
            [s for s in self.definitions if (s.kind, s.name) == wanted],
            [s for s in self.references if (s.kind, s.name) == wanted],
        )


def _name_symbols(kind: str, nodes: list[Node], library: str = "") -> Iterator[Symbol]:
    for node in nodes:
        name = getattr(node, "name", None)
        if name:
            full = f"{library}::{name}" if library else name
            yield Symbol(kind, full, name, node.where("name"))


def _collect_definitions(project: Project) -> Iterator[Symbol]:
    assets = project.assets
    yield from _name_symbols("scene", [*assets.scenes])
    yield from _name_symbols("camera", [*assets.cameras])
    yield from _name_symbols("viewport", [*assets.viewports])
    yield from _name_symbols("light", [*assets.lights])
    yield from _name_symbols("constant", [*assets.constants, *assets.aliases])
    yield from _name_symbols("pipeline", [*project.pipelines])
    for attribute in assets.attributes:
        yield from _name_symbols(f"attribute of {attribute.type}", [attribute])
    for pipeline in project.pipelines:
        yield from _name_symbols("pass", [*pipeline.passes])
        for pass_ in pipeline.passes:
            if isinstance(pass_, RaytracePass):
                yield from _name_symbols("ray type", [*pass_.rtRayTypes])
    for library in project.libraries[1:]:
        name = library.name or ""
        yield from _name_symbols("library", [library])
        yield from _name_symbols("material", [*library.materials], name)
        yield from _name_symbols("shader", [*library.shaders], name)
        yield from _name_symbols("state", [*library.states], name)
        yield from _name_symbols("render target", [*library.renderTargets], name)
        yield from _name_symbols("texture array", [*library.arraysOfTextures], name)
        yield from _name_symbols("buffer", [*library.buffers], name)
        yield from _name_symbols("texture", [*library.textures], name)
        for target in library.renderTargets:
            yield from _name_symbols("texture", [*target.colors], name)
            hidden = [d for d in (target.depth, target.depthStencil) if d is not None]
            yield from _name_symbols("texture", [*hidden], name)


def _collect_references(project: Project) -> Iterator[Symbol]:
    buffers = set(list_known_names(project, "buffer"))
    scenes = {scene.name for scene in project.assets.scenes}
    for node, library in walk_owned_nodes(project):
        schema = schema_of(type(node))
        for attribute in schema.attributes:
            for symbol in _attribute_symbols(node, attribute, library, buffers):
                if symbol.kind == "scene" and symbol.name not in scenes:
                    symbol = replace(symbol, kind="camera")  # cameras are scenes too
                yield symbol
        for part in [*schema.settings, *schema.inline]:
            yield from _setting_symbols(project, node, part)
        yield from _special_symbols(node)


def _attribute_symbols(
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
    name = qualify_reference(node, attribute, library, value, buffers)
    head, _, tail = value.rpartition("::")
    yield Symbol(attribute.ref, name, tail, where)
    if head:
        yield Symbol("library", head, head, where)


def _setting_symbols(project: Project, node: Node, part: SettingsField) -> Iterator[Symbol]:
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


def _special_symbols(node: Node) -> Iterator[Symbol]:
    """Yield names whose kind depends on another attribute, or that model files define."""
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

"""Completion: the elements, attributes, names and files that fit at a cursor."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from nau_py.lsp.links import list_procedures
from nau_py.lsp.place import (
    Entry,
    Inside,
    Listing,
    Place,
    attributes,
    children,
    enter,
    enter_yaml,
    plain_lists,
)
from nau_py.model.attributes import OBJECT_TYPES
from nau_py.model.library import DEFAULT_LIBRARY, MaterialLibrary
from nau_py.model.linked import Project
from nau_py.model.maps import InjectionMap, MaterialMap
from nau_py.model.node import Attr, Node
from nau_py.model.pass_classes import PASS_CLASSES
from nau_py.model.passes import Pass
from nau_py.model.physics import PhysicsLibrary
from nau_py.model.project import ProjectFile
from nau_py.model.raytrace import BUILTIN, Program, RayMaterial, RaytracePass, RayTypePrograms
from nau_py.model.references import CONTEXTS, list_known_names
from nau_py.raytrace.programs.catalogue import BUILTIN_PROGRAMS
from nau_py.raytrace.programs.source import stand_in
from nau_py.scene.names import list_default_materials
from nau_py.syntax.cursor import ITEM, Cursor, CursorKind, CursorStep
from nau_py.syntax.xml_cursor import locate_xml_cursor
from nau_py.syntax.yaml_cursor import locate_yaml_cursor

ROOTS: dict[str, type[Node]] = {
    "project": ProjectFile,
    "materialLib": MaterialLibrary,
    "materiallib": MaterialLibrary,
    "physicslib": PhysicsLibrary,
}
_MOST_FILES = 200
_PATTERNS = {
    (InjectionMap, "toMaterial"),
    (MaterialMap, "fromMaterial"),
    (RayMaterial, "to"),
}
"""Attributes whose value is a material's name or a prefix of one."""


@dataclass(frozen=True, slots=True)
class Completion:
    """A proposal.

    ``text`` replaces the word at the cursor. ``kind`` is element, attribute, value, name or file.
    """

    label: str
    text: str
    kind: str
    detail: str = ""
    doc: str = ""


@dataclass(frozen=True, slots=True)
class Grammar:
    """The text of a file with its language. ``names``: the project that references resolve in."""

    text: str
    yaml: bool
    library: bool
    path: Path
    names: Project

    def locate_cursor(self, offset: int) -> Cursor:
        """Return the cursor before the character at ``offset``."""
        locate = locate_yaml_cursor if self.yaml else locate_xml_cursor
        return locate(self.text, offset)

    def find_place(self, steps: tuple[CursorStep, ...]) -> Place | None:
        """Return the place inside the last of the steps; None where one is unknown."""
        if not self.yaml and (not steps or steps[0].tag not in ROOTS):
            return None
        tag = ("materialLib" if self.library else "project") if self.yaml else steps[0].tag
        place: Place | None = Inside(ROOTS[tag])
        into = enter_yaml if self.yaml else enter
        for step in steps if self.yaml else steps[1:]:
            if place is None:
                return None
            place = into(place, step.tag, step.attributes, self.names.registry)
        return place


def complete(grammar: Grammar, offset: int) -> tuple[Cursor, list[Completion]]:
    """Return the cursor at a character, whose word is to be replaced, and the proposals for it."""
    cursor = grammar.locate_cursor(offset)
    return cursor, list(_propose(grammar, cursor))


def _propose(grammar: Grammar, cursor: Cursor) -> Iterator[Completion]:
    registry = grammar.names.registry
    if cursor.kind is CursorKind.END:
        if cursor.path and not grammar.yaml:
            tag = cursor.path[-1].tag
            yield Completion(tag, tag, "element")
        return
    if not cursor.path and not grammar.yaml:
        for tag in ("project", "materialLib"):
            yield Completion(tag, tag if cursor.end > cursor.begin else f"<{tag}", "element")
        return
    place = grammar.find_place(cursor.path)
    if place is None:
        return
    if cursor.kind is CursorKind.CHILD:
        bare = not grammar.text[: cursor.begin].endswith("<")
        for entry in children(place, registry):
            text = f"<{entry.name}" if bare else entry.name
            yield Completion(entry.name, text, "element", _describe(entry), entry.doc)
    elif cursor.kind is CursorKind.ATTRIBUTE:
        rest = grammar.text[cursor.end :].lstrip(" ")[:1]
        for entry in attributes(place, registry):
            if entry.name not in cursor.path[-1].attributes:
                text = entry.name if rest == "=" else f'{entry.name}=""'
                yield Completion(entry.name, text, "attribute", _describe(entry), entry.doc)
    elif cursor.kind is CursorKind.KEY:
        yield from _propose_keys(grammar, cursor, place)
    else:
        yield from _propose_values(grammar, cursor, place)


def _propose_keys(grammar: Grammar, cursor: Cursor, place: Place) -> Iterator[Completion]:
    registry = grammar.names.registry
    given = cursor.path[-1].attributes if cursor.path else {}
    if cursor.path and cursor.path[-1].tag == ITEM and not given:
        yield from _propose_first_values(grammar, cursor, place)
    colon = "" if grammar.text[cursor.end :].lstrip(" ")[:1] == ":" else ":"
    for entry in attributes(place, registry):
        if entry.name not in given:
            text = f"{entry.name}{colon and ': '}"
            yield Completion(entry.name, text, "attribute", _describe(entry), entry.doc)
    for entry in children(place, registry):
        text = f"{entry.name}{colon}"
        yield Completion(entry.name, text, "element", _describe(entry), entry.doc)


def _describe(entry: Entry) -> str:
    needed = "required, " if entry.required else ""
    attr = entry.attr
    if entry.attribute is not None:
        return f"{needed}{entry.attribute.type.value}"
    if attr is None:
        return needed.rstrip(", ")
    if attr.ref:
        return f"{needed}name of a {attr.ref}"
    return f"{needed}{attr.file} file" if attr.file else f"{needed}{attr.type.value}"


def _propose_values(grammar: Grammar, cursor: Cursor, place: Place) -> Iterator[Completion]:
    registry = grammar.names.registry
    entry = next((e for e in attributes(place, registry) if e.name == cursor.name), None)
    if entry is None and grammar.yaml:
        inner = enter_yaml(place, cursor.name, {}, registry)
        if inner is not None:
            yield from _propose_first_values(grammar, cursor, inner)
        return
    given = cursor.path[-1].attributes if cursor.path else {}
    if entry is not None and entry.attr is not None:
        yield from _propose_entry_values(grammar, cursor, entry, entry.attr, given)
    yield from _propose_by_siblings(grammar, place, cursor.name, given)


def _propose_first_values(grammar: Grammar, cursor: Cursor, place: Place) -> Iterator[Completion]:
    """Propose values of the first attribute: in YAML a scalar may be written for a node, a list
    for its items."""
    registry = grammar.names.registry
    if isinstance(place, Inside) and (plain := plain_lists(place.cls)):
        place = enter_yaml(plain[0], ITEM, {}, registry) or place
    elif isinstance(place, Listing):
        place = enter_yaml(place, ITEM, {}, registry) or place
    first = next(iter(attributes(place, registry)), None)
    if first is not None and first.attr is not None:
        yield from _propose_entry_values(grammar, cursor, first, first.attr, {})


def _propose_entry_values(
    grammar: Grammar, cursor: Cursor, entry: Entry, attr: Attr, given: dict[str, str]
) -> Iterator[Completion]:
    for value in attr.values:
        yield Completion(value, value, "value", doc=entry.doc)
    if attr.ref:
        yield from _propose_names(grammar, attr, entry.name, given)
    if attr.constant:
        for name, number in grammar.names.constants.items():
            yield Completion(name, name, "name", f"constant {number:g}")
    if attr.file:
        yield from _propose_files(grammar, cursor, attr.file)


def _propose_names(
    grammar: Grammar, attr: Attr, key: str, given: dict[str, str]
) -> Iterator[Completion]:
    known = [n for n in list_known_names(grammar.names, attr.ref) if not ("__" in n or "#" in n)]
    if not any("::" in name for name in known):
        for name in dict.fromkeys(known):
            yield Completion(name, name, "name", attr.ref)
        return
    own = _library_name(grammar)
    library = given.get(attr.library, "") if attr.library else ""
    for name in known:
        home, _, short = name.partition("::")
        if library and home != library:
            continue
        plain = bool(attr.library) or (own and home == own) or home == DEFAULT_LIBRARY
        text = short if plain else name
        yield Completion(text, text, "name", f"{attr.ref} of {home}")


def _library_name(grammar: Grammar) -> str:
    mine = [lib.name for lib in grammar.names.libraries if Path(lib.file) == grammar.path]
    return (mine[0] if mine else "") or ""


def _propose_files(grammar: Grammar, cursor: Cursor, kind: str) -> Iterator[Completion]:
    if kind == "program":
        yield Completion(BUILTIN, BUILTIN, "value", "nau_py's own programs")
    begin = max(grammar.text.rfind(q, 0, cursor.end) for q in "\"' ") + 1
    written = grammar.text[begin : cursor.end]
    folder = grammar.path.parent / os.path.dirname(written.replace("\\", "/"))
    try:
        found = sorted(folder.iterdir())
    except OSError:
        return
    word = grammar.text[cursor.begin : cursor.end].replace("\\", "/")
    prefix = word[: word.rfind("/") + 1]
    for path in found[:_MOST_FILES]:
        if not path.name.startswith("."):
            name = path.name + ("/" if path.is_dir() else "")
            yield Completion(name, prefix + name, "file", kind)


def _propose_by_siblings(
    grammar: Grammar, place: Place, key: str, given: dict[str, str]
) -> Iterator[Completion]:
    """Propose values that depend on another attribute of the element."""
    project = grammar.names
    set_ = project.registry.get(given.get("type", ""))
    if key == "component" and set_ is not None and given["type"] in OBJECT_TYPES:
        for attribute in set_:
            yield Completion(
                attribute.name, attribute.name, "value", attribute.type.value, attribute.doc
            )
    elif key == "context":
        yield Completion("CURRENT", "CURRENT", "value")
        kind = CONTEXTS.get(given.get("type", ""))
        for name in list_known_names(project, kind) if kind else []:
            yield Completion(name, name, "name", kind or "")
    elif key == "type" and isinstance(place, Inside) and "component" in place.cls.model_fields:
        for name in OBJECT_TYPES:
            yield Completion(name, name, "value", "object type")
    elif isinstance(place, Inside) and (place.cls, key) in _PATTERNS:
        for name in sorted(list_default_materials(project) or ()):
            yield Completion(name, name, "name", "material of a model")
    elif key == "ray":
        for name in list_ray_types(project):
            yield Completion(name, name, "name", "ray type")
    elif key == "type" and isinstance(place, Inside) and place.cls is Program:
        for name in ("RayGen", "Exception"):
            yield Completion(name, name, "value", "old dialect")
    elif key == "name" and isinstance(place, Inside) and place.cls is RayTypePrograms:
        for name in list_ray_types(project):
            yield Completion(name, name, "name", "ray type")
    elif key == "proc":
        if given.get("file") == BUILTIN:
            for name, program in BUILTIN_PROGRAMS.items():
                yield Completion(name, name, "value", program.kind.lower(), program.doc)
        else:
            source = stand_in(project.folder, given.get("file", ""))
            for name in list_procedures(source) if source is not None else {}:
                yield Completion(name, name, "name", source.name if source else "")
    elif key == "class" and isinstance(place, Inside) and issubclass(place.cls, Pass):
        for name, cls in PASS_CLASSES.items():
            yield Completion(
                name, name, "value", "pass class", " ".join((cls.__doc__ or "").split())
            )


def list_ray_types(project: Project) -> list[str]:
    """Return the ray types that the raytrace passes of a project use."""
    passes = [p for pipeline in project.pipelines for p in pipeline.passes]
    found = [name for p in passes if isinstance(p, RaytracePass) for name in p.ray_types]
    return list(dict.fromkeys(found))

"""The grammar of a place in a file, for completion and hover.

Derived from the description of each class (:mod:`nau_py.model.schema`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from nau_py.formats.settings import list_keys
from nau_py.model.attribute import Attribute
from nau_py.model.attributes import Registry
from nau_py.model.node import Attr, Node
from nau_py.model.raytrace import EntryPoint, Program, RayMaterial, RayProgram
from nau_py.model.schema import ChildField, SettingsField, schema_of
from nau_py.model.values import DataType
from nau_py.syntax.cursor import ITEM

_OLD = {
    "optixEntryPoint": "rtEntryPoint",
    "optixDefaultMaterial": "rtDefaultMaterial",
    "optixMaterialMap": "rtMaterialMap",
    "optixMap": "rtMap",
    "optixVertexAttributes": "rtVertexAttributes",
    "optixMaterialAttributes": "rtMaterialParams",
    "optixGlobalAttributes": "rtGlobalParams",
    "optixInput": "rtInput",
    "optixOutput": "rtOutput",
    "optixGeometryProgram": "rtGeometryProgram",
}
"""Elements of the old dialect, and their present names."""
_OLD_PROGRAMS: dict[type[Node], type[Node]] = {RayMaterial: RayProgram, EntryPoint: Program}


@dataclass(frozen=True, slots=True)
class Inside:
    """Within an element of a class."""

    cls: type[Node]


@dataclass(frozen=True, slots=True)
class Listing:
    """Within the list of an element: its wrapper, or in YAML the key of a plain list."""

    part: ChildField


@dataclass(frozen=True, slots=True)
class Leaf:
    """Within a child tag that gives a value to an attribute of an attribute set."""

    attribute: Attribute


Place = Inside | Listing | Leaf


@dataclass(frozen=True, slots=True)
class Entry:
    """An element or attribute that is allowed at a place. ``attr`` describes its value."""

    name: str
    doc: str
    required: bool = False
    attr: Attr | None = None
    attribute: Attribute | None = None


def enter(
    place: Place, tag: str, attributes: Mapping[str, str], registry: Registry
) -> Place | None:
    """Return the place inside child ``tag``, as XML nests it; None for an unknown child."""
    if isinstance(place, Leaf):
        return None
    if isinstance(place, Listing):
        return item(place, tag, attributes)
    if tag == "optixProgram" and place.cls in _OLD_PROGRAMS:
        return Inside(_OLD_PROGRAMS[place.cls])
    tag = _OLD.get(tag, tag)
    schema = schema_of(place.cls)
    part = schema.by_tag.get(tag)
    if part is not None:
        return Listing(part) if part.wrapper else item(Listing(part), tag, attributes)
    found = schema.setting(tag, registry)
    return Leaf(found[1]) if found is not None else None


def enter_yaml(
    place: Place, key: str, attributes: Mapping[str, str], registry: Registry
) -> Place | None:
    """Return the place behind ``key``, or in an :data:`ITEM`, as YAML nests it."""
    if isinstance(place, Leaf):
        return None
    if isinstance(place, Listing):
        if key == "items" or (key == ITEM and place.part.mixed):
            return place  # the long form; an item is a map of one tag
        return item(place, key, attributes)
    plain = plain_lists(place.cls)
    if key == ITEM:
        return item(plain[0], key, attributes) if len(plain) == 1 else place
    found = next((p for p in plain if p.part.tag == key), None)
    return found or enter(place, key, attributes, registry)


def plain_lists(cls: type[Node]) -> list[Listing]:
    """List the lists of a class that have no wrapper. A sole one may be written for the node."""
    return [Listing(part) for part in schema_of(cls).plain_lists]


def item(listing: Listing, tag: str, attributes: Mapping[str, str]) -> Place | None:
    """Return the place inside an item of a list."""
    part = listing.part
    if not part.mixed:
        tag = part.tag if tag == ITEM else _OLD.get(tag, tag)
    cls = part.class_of(tag, attributes)
    return Inside(cls) if cls is not None else None


def children(place: Place, registry: Registry) -> list[Entry]:
    """List the elements that are allowed at a place."""
    if isinstance(place, Leaf):
        return []
    if isinstance(place, Listing):
        return _items(place.part)

    def of_children(part: ChildField) -> list[Entry]:
        return [Entry(part.wrapper, part.doc or _listed(part))] if part.wrapper else _items(part)

    def of_settings(part: SettingsField) -> list[Entry]:
        return [Entry(a.name, a.doc, attribute=a) for a in _writable(part, registry)]

    listed = schema_of(place.cls).each_content(of_children, of_settings)
    return [entry for entries in listed for entry in entries]


def _items(part: ChildField) -> list[Entry]:
    """List the elements of a child field, wrapper aside."""
    if part.mixed:
        return [Entry(tag, schema_of(cls).doc) for tag, cls in part.classes.items()]
    return [Entry(part.tag, part.doc or schema_of(part.cls).doc)]


def _listed(part: ChildField) -> str:
    return f"A list of {', '.join(f'`{tag}`' for tag in part.classes)}."


def _writable(part: SettingsField, registry: Registry) -> list[Attribute]:
    return [a for a in part.known(registry) if not a.readonly and a.type.in_file]


def attributes(place: Place, registry: Registry) -> list[Entry]:
    """List the attributes that an element at a place takes."""
    if isinstance(place, Listing):
        return []
    if isinstance(place, Leaf):
        attribute = place.attribute
        keys = list_keys(attribute)
        one = _attr_of(attribute) if len(keys) == 1 else Attr(DataType.FLOAT, constant=True)
        return [Entry(key, attribute.doc, True, one, attribute) for key in keys]
    schema = schema_of(place.cls)
    own = [Entry(a.name, a.doc, a.required, a) for a in schema.attributes]
    inline = [a for part in schema.inline for a in _writable(part, registry)]
    return own + [Entry(a.name, a.doc, attr=_attr_of(a), attribute=a) for a in inline]


def _attr_of(attribute: Attribute) -> Attr:
    values = attribute.values or (("true", "false") if attribute.type.is_boolean else ())
    return Attr(
        attribute.type,
        attribute.doc,
        values=values,
        ref=attribute.reference,
        constant=attribute.type.is_number,
    )

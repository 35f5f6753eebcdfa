"""What may stand at a place of a file, by the models: the grammar that completion and hover use."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from nau_py.formats.settings import keys_of
from nau_py.model.attribute import Attribute
from nau_py.model.attributes import Registry
from nau_py.model.node import (
    Attr,
    Child,
    Inline,
    Items,
    Node,
    Settings,
    Variants,
    file_key,
)
from nau_py.model.raytrace import EntryPoint, Program, RayMaterial, RayProgram
from nau_py.model.values import DataType
from nau_py.syntax.element import Element

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
"""Elements of the old dialect and those that they are read as."""
_OLD_PROGRAMS: dict[type[Node], type[Node]] = {RayMaterial: RayProgram, EntryPoint: Program}
ITEM = "-"
"""The tag of a step into an item of a YAML list."""


@dataclass(frozen=True, slots=True)
class Inside:
    """Within an element of a class."""

    cls: type[Node]


@dataclass(frozen=True, slots=True)
class Listing:
    """Within the list of an element: its wrapper, or in YAML the key of a plain list."""

    marker: Items | Variants


@dataclass(frozen=True, slots=True)
class Leaf:
    """Within a child tag that gives a value to an attribute of an attribute set."""

    attribute: Attribute


Place = Inside | Listing | Leaf


@dataclass(frozen=True, slots=True)
class Entry:
    """An element or attribute that may stand at a place. ``attr``: how its value is written."""

    name: str
    doc: str
    required: bool = False
    attr: Attr | None = None
    attribute: Attribute | None = None


def _doc(cls: type[Node]) -> str:
    return " ".join((cls.__doc__ or "").split())


def enter(
    place: Place, tag: str, attributes: Mapping[str, str], registry: Registry
) -> Place | None:
    """The place inside child ``tag``, as XML nests it; None where no such child is known."""
    if isinstance(place, Leaf):
        return None
    if isinstance(place, Listing):
        return item(place, tag, attributes)
    if tag == "optixProgram" and place.cls in _OLD_PROGRAMS:
        return Inside(_OLD_PROGRAMS[place.cls])
    tag = _OLD.get(tag, tag)
    for name, marker in place.cls.markers().items():
        if isinstance(marker, Child) and tag == (marker.tag or name):
            return Inside(marker.cls)
        if isinstance(marker, Items | Variants) and marker.wrapper:
            if tag == marker.wrapper:
                return Listing(marker)
        elif isinstance(marker, Items | Variants):
            found = item(Listing(marker), tag, attributes)
            if found is not None:
                return found
        elif isinstance(marker, Settings):
            attribute = registry.of(place.cls, marker.type).get(tag)
            if attribute is not None:
                return Leaf(attribute)
    return None


def enter_yaml(
    place: Place, key: str, attributes: Mapping[str, str], registry: Registry
) -> Place | None:
    """The place behind ``key``, or in an :data:`ITEM`, as YAML nests it."""
    if isinstance(place, Leaf):
        return None
    if isinstance(place, Listing):
        if key == "items" or (key == ITEM and isinstance(place.marker, Variants)):
            return place  # the long form; an item is a map of one tag
        return item(place, key, attributes)
    plain = plain_lists(place.cls)
    if key == ITEM:
        return item(plain[0], key, attributes) if len(plain) == 1 else place
    found = next((p for p in plain if p.marker.tag == key), None)  # type: ignore[union-attr]
    return found or enter(place, key, attributes, registry)


def plain_lists(cls: type[Node]) -> list[Listing]:
    """The lists of a class that stand in no wrapper. One alone may be written for the node."""
    markers = cls.markers().values()
    return [Listing(m) for m in markers if isinstance(m, Items) and not m.wrapper]


def item(listing: Listing, tag: str, attributes: Mapping[str, str]) -> Place | None:
    """The place inside an item of a list."""
    marker = listing.marker
    if isinstance(marker, Variants):
        cls = marker.classes.get(tag)
        return Inside(cls) if cls is not None else None
    if _OLD.get(tag, tag) not in (marker.tag, ITEM):
        return None
    if marker.choose is not None:
        return Inside(marker.choose(Element(marker.tag, dict(attributes))))
    return Inside(marker.cls)


def children(place: Place, registry: Registry) -> list[Entry]:
    """The elements that may stand at a place."""
    if isinstance(place, Leaf):
        return []
    cls = place.cls if isinstance(place, Inside) else Node
    markers = (
        [("", place.marker)] if isinstance(place, Listing) else list(place.cls.markers().items())
    )
    found: list[Entry] = []
    for name, marker in markers:
        if isinstance(marker, Child):
            found.append(Entry(marker.tag or name, marker.doc or _doc(marker.cls)))
        elif isinstance(marker, Items | Variants) and marker.wrapper and name:
            found.append(Entry(marker.wrapper, marker.doc or _listed(marker)))
        elif isinstance(marker, Items):
            found.append(Entry(marker.tag, marker.doc or _doc(marker.cls)))
        elif isinstance(marker, Variants):
            found += [Entry(tag, _doc(cls)) for tag, cls in marker.classes.items()]
        elif isinstance(marker, Settings):
            set_ = registry.of(cls, marker.type)
            found += [
                Entry(a.name, a.doc, attribute=a) for a in set_ if not a.readonly and a.type.in_file
            ]
    return found


def _listed(marker: Items | Variants) -> str:
    tags = [marker.tag] if isinstance(marker, Items) else list(marker.classes)
    return f"A list of {', '.join(f'`{tag}`' for tag in tags)}."


def attributes(place: Place, registry: Registry) -> list[Entry]:
    """The attributes that an element at a place takes."""
    if isinstance(place, Listing):
        return []
    if isinstance(place, Leaf):
        attribute = place.attribute
        keys = keys_of(attribute)
        one = _attr_of(attribute) if len(keys) == 1 else Attr(DataType.FLOAT, constant=True)
        return [Entry(key, attribute.doc, True, one, attribute) for key in keys]
    found: list[Entry] = []
    for name, marker in place.cls.markers().items():
        if isinstance(marker, Attr):
            found.append(Entry(file_key(name, marker), marker.doc, marker.required, marker))
        elif isinstance(marker, Inline):
            found += [
                Entry(a.name, a.doc, attr=_attr_of(a), attribute=a)
                for a in registry.of(place.cls, marker.type)
                if not a.readonly and a.type.in_file
            ]
    return found


def _attr_of(attribute: Attribute) -> Attr:
    values = attribute.values or (("true", "false") if attribute.type.is_boolean else ())
    return Attr(
        attribute.type,
        attribute.doc,
        values=values,
        ref=attribute.reference,
        constant=attribute.type.is_number,
    )

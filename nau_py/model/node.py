"""The base of every model, and the markers that say how a field stands in a file.

A field is declared as ``Annotated[type, marker]``. The markers are read by one binder (file to
model), one writer (model to file), the linter and the generated reference, so that a noun is
described once.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from pydantic import BaseModel, ConfigDict, Field

from nau_py.diagnostics.location import NOWHERE, Location
from nau_py.model.values import DataType, Scalar
from nau_py.syntax.element import Element


@dataclass(frozen=True, slots=True)
class Attr:
    """An XML attribute (a plain key in YAML)."""

    type: DataType = DataType.STRING
    doc: str = ""
    required: bool = False
    name: str = ""
    values: tuple[str, ...] = ()
    constant: bool = False
    """Whether the name of a project constant may stand for the number."""
    ref: str = ""
    """What the value names: ``scene``, ``camera``, ``material`` …; checked by lint."""
    library: str = ""
    """The attribute that holds the library of ``ref``."""
    file: str = ""
    """The value is a path to a file of this kind: ``model``, ``shader``, ``texture`` …"""


@dataclass(frozen=True, slots=True)
class Child:
    """One child element that is a node of its own."""

    cls: type[Node]
    tag: str = ""
    doc: str = ""


@dataclass(frozen=True, slots=True)
class Items:
    """Repeated child elements ``tag``, inside ``wrapper`` where one is named."""

    cls: type[Node]
    tag: str
    wrapper: str = ""
    doc: str = ""
    choose: Callable[[Element], type[Node]] | None = None


@dataclass(frozen=True, slots=True)
class Variants:
    """Repeated child elements of several tags whose order matters, inside ``wrapper``."""

    classes: Mapping[str, type[Node]]
    wrapper: str = ""
    doc: str = ""


@dataclass(frozen=True, slots=True)
class Settings:
    """Child tags named like the attributes of an attribute set (docs/format.md, section 2)."""

    type: str
    doc: str = ""


@dataclass(frozen=True, slots=True)
class Inline:
    """XML attributes named like the attributes of an attribute set."""

    type: str
    doc: str = ""


Marker = Attr | Child | Items | Variants | Settings | Inline


@dataclass(slots=True)
class Setting:
    """The value that a file gives to one attribute of an attribute set.

    ``parts`` holds one scalar a component; a ``str`` in a numeric attribute names a constant.
    """

    parts: tuple[Scalar, ...]
    location: Location = field(default=NOWHERE, compare=False)
    extra: dict[str, str] = field(default_factory=dict)


class Node(BaseModel):
    """A thing that a file says. Equality ignores positions.

    ``unknown_attributes`` and ``unknown_children`` hold what the model has no place for, so that
    nothing is lost and lint can report it. A child element in ``partial`` is a known wrapper of
    which only the left-over parts are kept.
    """

    model_config = ConfigDict(extra="forbid", arbitrary_types_allowed=True, defer_build=True)

    location: Location = Field(default=NOWHERE, repr=False)
    attribute_locations: dict[str, Location] = Field(default_factory=dict, repr=False)
    tag: str = Field(default="", repr=False)
    unknown_attributes: dict[str, str] = Field(default_factory=dict, repr=False)
    unknown_children: dict[str, list[Element]] = Field(default_factory=dict, repr=False)
    partial: dict[str, Element] = Field(default_factory=dict, repr=False)

    def __eq__(self, other: object) -> bool:
        if type(self) is not type(other):
            return False
        skip = {"location", "attribute_locations", "tag"}
        names = set(type(self).model_fields) - skip
        return all(getattr(self, name) == getattr(other, name) for name in names)

    @classmethod
    def markers(cls) -> dict[str, Marker]:
        """Field name to marker, in declaration order."""
        found = _MARKERS.get(cls)
        if found is None:
            found = {
                name: marker
                for name, info in cls.model_fields.items()
                for marker in info.metadata
                if isinstance(marker, Marker)
            }
            _MARKERS[cls] = found
        return found

    def where(self, attribute: str = "") -> Location:
        """The position of an attribute's value, or of the element where it has none."""
        return self.attribute_locations.get(attribute, self.location)

    def children(self) -> Iterator[Node]:
        """Direct child nodes in declaration order."""
        for name, marker in self.markers().items():
            value = getattr(self, name)
            if isinstance(marker, Child) and value is not None:
                yield value
            elif isinstance(marker, Items | Variants):
                yield from value

    def walk(self) -> Iterator[Node]:
        yield self
        for child in self.children():
            yield from child.walk()


_MARKERS: dict[type[Node], dict[str, Marker]] = {}


def file_key(name: str, marker: Attr) -> str:
    """The attribute name in a file for the field ``name``."""
    return marker.name or name


class Configured(Node):
    """A node that carries settings of an attribute set."""

    settings: Any = None

    def get(self, name: str) -> tuple[Scalar, ...] | None:
        """The parts that the file gives to attribute ``name``, or None where it is unset."""
        setting = self.settings.get(name)
        return None if setting is None else setting.parts

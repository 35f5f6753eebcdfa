"""The base of every noun of a project, and the markers that declare its fields.

A field is declared as ``Annotated[type, marker]``. :mod:`nau_py.model.schema` derives one
description of a class from its markers; reading, writing, lint, completion and the reference page
use that description.

pydantic holds the fields: types, defaults, and the markers as metadata. Its validation is not
used. It stops at the first model that it cannot build and knows no positions, whereas a wrong file
must still load, so that lint can report all of its faults, each with file, line and column.
:class:`nau_py.formats.bind.Binder` therefore converts values by the description, collects the
problems and builds nodes with ``model_construct``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

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
    """The name in a file; empty for the name of the field."""
    values: tuple[str, ...] = ()
    constant: bool = False
    """True if the name of a project constant may replace the number."""
    ref: str = ""
    """Kind of the thing that the value names: ``scene``, ``camera``, ``material`` …"""
    library: str = ""
    """The field that holds the library of ``ref``."""
    file: str = ""
    """Kind of the file whose path the value is: ``model``, ``shader``, ``texture`` …"""


@dataclass(frozen=True, slots=True)
class Child:
    """One child element that is a node of its own."""

    cls: type[Node]
    tag: str = ""
    """The tag in a file; empty for the name of the field."""
    doc: str = ""


@dataclass(frozen=True, slots=True)
class Choice:
    """Choice of a node's class by the value of one attribute of its element."""

    attribute: str
    default: str
    """The value of an element without the attribute."""
    classes: Mapping[str, type[Node]]
    other: type[Node]
    """The class for every other value."""

    def pick(self, attributes: Mapping[str, str]) -> type[Node]:
        """Return the class of an element with these attributes."""
        return self.classes.get(attributes.get(self.attribute, self.default), self.other)


@dataclass(frozen=True, slots=True)
class Items:
    """Repeated child elements ``tag``, inside ``wrapper`` if one is named."""

    cls: type[Node]
    tag: str
    wrapper: str = ""
    doc: str = ""
    choice: Choice | None = None


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


NodeSettings = dict[str, Setting]
"""Settings by the name of the attribute."""


class Node(BaseModel):
    """One element of a file with its values and child nodes. Equality ignores positions.

    ``unknown_attributes`` and ``unknown_children`` hold everything that the class does not
    declare, so that nothing is lost and lint can report it. ``partial`` holds the wrappers of
    lists that have something besides their items; of each it keeps only that rest.
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

    def where(self, attribute: str = "") -> Location:
        """Return the position of an attribute's value, or of the element if it has none."""
        return self.attribute_locations.get(attribute, self.location)

    def children(self) -> Iterator[Node]:
        """Yield the direct child nodes in the order of declaration."""
        for name in _child_fields(type(self)):
            value = getattr(self, name)
            if isinstance(value, list):
                yield from value
            elif value is not None:
                yield value

    def walk(self) -> Iterator[Node]:
        """Yield this node and all nodes below it, parents first."""
        yield self
        for child in self.children():
            yield from child.walk()


def markers(cls: type[Node]) -> dict[str, Marker]:
    """Map the fields of ``cls`` to their markers, in the order of declaration."""
    return {
        name: marker
        for name, info in cls.model_fields.items()
        for marker in info.metadata
        if isinstance(marker, Marker)
    }


_CHILD_FIELDS: dict[type[Node], list[str]] = {}


def _child_fields(cls: type[Node]) -> list[str]:
    found = _CHILD_FIELDS.get(cls)
    if found is None:
        nodes = Child | Items | Variants
        found = [name for name, marker in markers(cls).items() if isinstance(marker, nodes)]
        _CHILD_FIELDS[cls] = found
    return found


class Configured(Node):
    """A node that carries settings of an attribute set."""

    settings: NodeSettings = Field(default_factory=dict)

    def get(self, name: str) -> tuple[Scalar, ...] | None:
        """Return the parts that the file gives to attribute ``name``, or None if it is unset."""
        setting = self.settings.get(name)
        return None if setting is None else setting.parts

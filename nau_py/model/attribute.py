"""Attribute sets: the properties of an object type, as data (docs/format.md, section 9).

A set gives the child tags that a file may write, the ``component`` that a ``valueof`` may name, the
value of an unset attribute, and the text of the reference page.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from nau_py.model.values import DataType, Scalar


@dataclass(frozen=True, slots=True)
class Attribute:
    """One property: its type, default, legal values and one line of documentation."""

    name: str
    type: DataType
    default: tuple[Scalar, ...] = ()
    doc: str = ""
    readonly: bool = False
    values: tuple[str, ...] = ()
    minimum: float | None = None
    maximum: float | None = None
    keys: str = "xyzw"
    """The component names to write: ``xyzw``, ``rgba`` or ``size`` (width, height)."""
    reference: str = ""
    """For a STRING: kind of the object that it names (``camera``, ``viewport``)."""
    unit: str = ""
    """Unit of the number, for documentation."""


@dataclass(slots=True)
class AttributeSet:
    """The attributes of one object type, in the order of documentation."""

    type: str
    attributes: dict[str, Attribute] = field(default_factory=dict)

    @classmethod
    def of(cls, type_: str, attributes: Iterable[Attribute]) -> AttributeSet:
        """Make the set of an object type."""
        return cls(type_, {attribute.name: attribute for attribute in attributes})

    def __contains__(self, name: str) -> bool:
        return name in self.attributes

    def __iter__(self) -> Iterator[Attribute]:
        return iter(self.attributes.values())

    def get(self, name: str) -> Attribute | None:
        """Return an attribute, or None for an unknown name."""
        return self.attributes.get(name)

    def default(self, name: str) -> tuple[Scalar, ...]:
        """Return the default of an attribute. Raises KeyError for an unknown name."""
        return self.attributes[name].default

    @property
    def writable(self) -> list[str]:
        """Names of the attributes that a file may write."""
        return [a.name for a in self if not a.readonly and a.type.in_file]

    def copy(self) -> AttributeSet:
        """Copy the set, so that a project can add attributes."""
        return AttributeSet(self.type, dict(self.attributes))


def number(name: str, type_: DataType, default: float, doc: str = "", **rest: object) -> Attribute:
    """Make an attribute with a scalar number. ``rest``: further fields of :class:`Attribute`."""
    return Attribute(name, type_, (default,), doc, **rest)  # type: ignore[arg-type]


def flag(name: str, default: bool, doc: str = "", readonly: bool = False) -> Attribute:
    """Make a BOOL attribute."""
    return Attribute(name, DataType.BOOL, (default,), doc, readonly)


def choice(
    name: str, default: str, values: str, doc: str = "", readonly: bool = False
) -> Attribute:
    """Make an ENUM attribute. ``values`` separates the legal values by blanks."""
    return Attribute(name, DataType.ENUM, (default,), doc, readonly, tuple(values.split()))


def vector(
    name: str, default: tuple[float, ...], doc: str = "", readonly: bool = False
) -> Attribute:
    """Make a VEC2, VEC3 or VEC4 attribute, by the length of ``default``."""
    return Attribute(name, DataType(f"VEC{len(default)}"), default, doc, readonly)


def colour(
    name: str, default: tuple[float, float, float, float], doc: str = "", unit_range: bool = True
) -> Attribute:
    """Make an RGBA attribute. ``unit_range`` limits its components to 0 to 1."""
    limits = (0.0, 1.0) if unit_range else (None, None)
    return Attribute(
        name, DataType.VEC4, default, doc, minimum=limits[0], maximum=limits[1], keys="rgba"
    )


def matrix(name: str, doc: str = "", size: int = 4) -> Attribute:
    """Make a read-only attribute with a matrix of ``size`` rows and columns."""
    return Attribute(name, DataType(f"MAT{size}"), (), doc, readonly=True)

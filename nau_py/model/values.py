"""Nau's data types, and the conversion of text to values (docs/format.md, 1.3 and 2)."""

from __future__ import annotations

import re
from enum import StrEnum
from functools import cached_property

Scalar = bool | int | float | str


class DataType(StrEnum):
    """The data types that a project file can write (docs/format.md, section 2)."""

    INT = "INT"
    IVEC2 = "IVEC2"
    IVEC3 = "IVEC3"
    IVEC4 = "IVEC4"
    UINT = "UINT"
    UIVEC2 = "UIVEC2"
    UIVEC3 = "UIVEC3"
    UIVEC4 = "UIVEC4"
    BOOL = "BOOL"
    BVEC4 = "BVEC4"
    FLOAT = "FLOAT"
    VEC2 = "VEC2"
    VEC3 = "VEC3"
    VEC4 = "VEC4"
    DOUBLE = "DOUBLE"
    DVEC2 = "DVEC2"
    DVEC3 = "DVEC3"
    DVEC4 = "DVEC4"
    ENUM = "ENUM"
    STRING = "STRING"
    MAT3 = "MAT3"
    MAT4 = "MAT4"
    INTARRAY = "INTARRAY"

    @cached_property
    def components(self) -> int:
        """Number of scalars of one value."""
        if self in (DataType.MAT3, DataType.MAT4):
            return int(self.value[-1]) ** 2
        return int(self.value[-1]) if self.value[-1].isdigit() else 1

    @cached_property
    def required_components(self) -> int:
        """Number of scalars that a file must write. The last one of a VEC4 is optional."""
        return 3 if self is DataType.VEC4 else self.components

    @cached_property
    def is_integer(self) -> bool:
        """True for INT, UINT and their vectors."""
        return self.value.startswith(("INT", "IVEC", "UINT", "UIVEC"))

    @cached_property
    def is_boolean(self) -> bool:
        """True for BOOL and its vectors."""
        return self.value.startswith(("BOOL", "BVEC"))

    @cached_property
    def is_number(self) -> bool:
        """True for integers, floats, doubles and their vectors."""
        return self.is_integer or self.value.startswith(("FLOAT", "VEC", "DOUBLE", "DVEC"))

    @cached_property
    def in_file(self) -> bool:
        """True if a project file can write a value of this type."""
        return self not in (DataType.MAT3, DataType.MAT4, DataType.INTARRAY)


STRUCTURE_TYPES = [
    "INT",
    "IVEC2",
    "IVEC3",
    "IVEC4",
    "UINT",
    "UIVEC2",
    "UIVEC3",
    "UIVEC4",
    "BOOL",
    "BVEC2",
    "BVEC3",
    "BVEC4",
    "FLOAT",
    "VEC2",
    "VEC3",
    "VEC4",
    "DOUBLE",
    "DVEC2",
    "DVEC3",
    "DVEC4",
    "MAT2",
    "MAT3",
    "MAT4",
    "MAT2x3",
    "MAT2x4",
    "MAT3x2",
    "MAT3x4",
    "MAT4x2",
    "MAT4x3",
    "DMAT2",
    "DMAT3",
    "DMAT4",
    "DMAT2x3",
    "DMAT2x4",
    "DMAT3x2",
    "DMAT3x4",
    "DMAT4x2",
    "DMAT4x3",
    "BYTE",
    "UBYTE",
    "SHORT",
    "USHORT",
]
"""Names that ``<structure><field value=/>`` of a buffer accepts."""

_INTEGER = re.compile(r"\s*([+-]?\d+)")
_FLOAT = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)")
_NAME = re.compile(r"[A-Za-z_][\w.\- ]*$")


class Unconvertible(ValueError):
    """Raised for text without a value of the type, even by Nau's prefix rules."""


def to_int(text: str) -> int:
    """Read the longest integer prefix, as ``sscanf("%d")``. Raises :class:`Unconvertible`."""
    match = _INTEGER.match(text)
    if match is None:
        raise Unconvertible(text)
    return int(match[1])


def to_float(text: str) -> float:
    """Read the longest decimal prefix, as ``sscanf("%lf")``. Raises :class:`Unconvertible`."""
    match = _FLOAT.match(text)
    if match is None:
        raise Unconvertible(text)
    return float(match[1])


def to_bool(text: str) -> bool:
    """Compare prefixes without case, as Nau does. Raises :class:`Unconvertible`."""
    lower = text.lower()
    if lower.startswith(("true", "yes", "1")):
        return True
    if lower.startswith(("false", "no", "0")):
        return False
    raise Unconvertible(text)


def to_scalar(text: str, data_type: DataType) -> Scalar:
    """Read one component of ``data_type``.

    A text that is no number but may name a constant is returned as it is (``str``). It is resolved
    when the constants of the project are known. Raises :class:`Unconvertible`.
    """
    if data_type in (DataType.ENUM, DataType.STRING):
        return text
    if data_type.is_boolean:
        return to_bool(text)
    try:
        return to_int(text) if data_type.is_integer else to_float(text)
    except Unconvertible:
        if _NAME.match(text):
            return text
        raise


def has_trailing_text(text: str, data_type: DataType) -> bool:
    """Return True if Nau uses only the beginning of ``text`` (``"256,"``, ``"102.55.0"``)."""
    if not data_type.is_number:
        return False
    pattern = _INTEGER if data_type.is_integer else _FLOAT
    match = pattern.match(text)
    if match is None:
        return False
    rest = text[match.end() :].strip()
    if data_type.is_integer:  # "1.0" for an int is a habit, not a slip
        rest = re.sub(r"^\.0*$", "", rest)
    return rest not in ("", "f", "F")


def format_scalar(value: Scalar) -> str:
    """Write the text that :func:`to_scalar` reads back as the same value."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        text = repr(value)
        return text[:-2] if text.endswith(".0") else text
    return str(value)

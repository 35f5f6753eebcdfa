"""Values of attribute sets as child tags and as XML attributes (docs/format.md, 2)."""

from __future__ import annotations

from nau_py.diagnostics.problem import Problem, ProblemKind
from nau_py.model.attribute import Attribute
from nau_py.model.node import Setting
from nau_py.model.values import (
    DataType,
    Scalar,
    Unconvertible,
    format_scalar,
    has_trailing_text,
    to_scalar,
)
from nau_py.syntax.element import Element

_KEYS: tuple[tuple[str, ...], ...] = (
    ("x", "r", "width"),
    ("y", "g", "height"),
    ("z", "b"),
    ("w", "a"),
)


def list_spellings(attribute: Attribute) -> list[tuple[str, ...]]:
    """List for each component the XML attributes that may hold it."""
    kind = attribute.type
    if kind is DataType.STRING:
        return [("name",)]
    count = kind.components
    if count == 1:
        return [("value",)]
    spellings: list[tuple[str, ...]] = []
    for index in range(count):
        keys = _KEYS[index]
        if count != 2:
            keys = keys[:2] if kind is DataType.VEC4 else keys[:1]
        elif kind is DataType.DVEC2:
            keys = keys[:1]
        elif len(keys) > 2:
            keys = (keys[0], keys[2])
        spellings.append(keys)
    return spellings


def list_keys(attribute: Attribute) -> list[str]:
    """List the XML attributes to write a value of ``attribute`` with, one a component."""
    spellings = list_spellings(attribute)
    if attribute.keys == "rgba":
        return [keys[1] if len(keys) > 1 else keys[0] for keys in spellings]
    if attribute.keys == "size":
        return [keys[-1] for keys in spellings]
    return [keys[0] for keys in spellings]


def _convert(
    element: Element, key: str, attribute: Attribute, problems: list[Problem]
) -> Scalar | None:
    text = element.attributes[key]
    try:
        value = to_scalar(text, attribute.type)
    except Unconvertible:
        problems.append(
            Problem(
                ProblemKind.UNCONVERTIBLE,
                element.where(key),
                element.source_tag,
                key,
                text,
                attribute.type.value,
            )
        )
        return None
    if not isinstance(value, str) and has_trailing_text(text, attribute.type):
        problems.append(
            Problem(
                ProblemKind.TRAILING_TEXT,
                element.where(key),
                element.source_tag,
                key,
                text,
                format_scalar(value),
            )
        )
    return value


def parse_setting(
    element: Element, attribute: Attribute, problems: list[Problem]
) -> Setting | None:
    """Read the value of a child tag. Returns None and adds a problem on failure."""
    if attribute.readonly or not attribute.type.in_file:
        problems.append(Problem(ProblemKind.READ_ONLY, element.location, element.source_tag))
        return None
    parts: list[Scalar] = []
    used = set()
    for index, keys in enumerate(list_spellings(attribute)):
        key = next((k for k in keys if k in element.attributes), None)
        if key is None:
            if index >= attribute.type.required_components:
                break
            problems.append(
                Problem(
                    ProblemKind.INCOMPLETE,
                    element.location,
                    element.source_tag,
                    expected=" or ".join(keys),
                    detail=attribute.type.value,
                )
            )
            return None
        value = _convert(element, key, attribute, problems)
        if value is None:
            return None
        parts.append(value)
        used.add(key)
    extra = {k: v for k, v in element.attributes.items() if k not in used}
    return Setting(tuple(parts), element.location, extra)


def parse_inline(
    element: Element, key: str, attribute: Attribute, problems: list[Problem]
) -> Setting | None:
    """Read the value of an XML attribute. Returns None if it is read-only, a vector or wrong."""
    if attribute.readonly or attribute.type.components != 1:
        return None
    value = _convert(element, key, attribute, problems)
    return None if value is None else Setting((value,), element.where(key))


def write_setting(tag: str, setting: Setting, attribute: Attribute) -> Element:
    """Write the child tag that :func:`parse_setting` reads back."""
    pairs = zip(list_keys(attribute), setting.parts)
    return Element(tag, {key: format_scalar(part) for key, part in pairs} | setting.extra)

"""YAML to elements and back, by the description of each class.

Attributes are keys, wrappers are lists, vectors are lists of numbers. A node that has only its
first attribute (usually a name) is a plain string.
"""

from __future__ import annotations

from typing import Any

from ruamel.yaml.comments import CommentedMap, CommentedSeq

from nau_py.diagnostics.location import Location
from nau_py.formats.settings import list_keys
from nau_py.model.attributes import Registry
from nau_py.model.node import Node
from nau_py.model.schema import ChildField, NodeSchema, schema_of
from nau_py.model.values import (
    DataType,
    Scalar,
    Unconvertible,
    format_scalar,
    has_trailing_text,
    to_scalar,
)
from nau_py.syntax.element import Element
from nau_py.syntax.yaml import key_location, value_location


def _text(value: object) -> str:
    if isinstance(value, bool | int | float | str):
        return format_scalar(value) if not isinstance(value, str) else str(value)
    return "" if value is None else str(value)


class YamlReader:
    """Builds elements from YAML data, by the description of each class."""

    def __init__(self, file: str, registry: Registry) -> None:
        self.file = file
        self.registry = registry

    def _at(self, container: object, key: object) -> Location:
        return value_location(container, key, self.file)

    def _key_at(self, container: CommentedMap, key: object) -> Location:
        return key_location(container, key, self.file)

    def node(self, tag: str, data: object, cls: type[Node], where: Location) -> Element:
        """Build the element ``tag`` of class ``cls`` that ``data`` describes."""
        element = Element(tag, location=where)
        schema = schema_of(cls)
        if not isinstance(data, CommentedMap):
            return self._short(element, data, schema, where)
        for key, value in data.items():
            self._entry(element, data, str(key), value, schema)
        return element

    def _short(
        self, element: Element, data: object, schema: NodeSchema, where: Location
    ) -> Element:
        """Read a node that is written as its sole list, or as its first attribute."""
        lists = schema.plain_lists
        if isinstance(data, CommentedSeq) and len(lists) == 1:
            element.children = self._list(data, lists[0])
        elif data is not None:
            first = schema.attributes[0].name if schema.attributes else "name"
            element.attributes[first] = _text(data)
            element.attribute_locations[first] = where
        return element

    def _entry(
        self, element: Element, data: CommentedMap, key: str, value: object, schema: NodeSchema
    ) -> None:
        where = self._key_at(data, key)
        scalar = not isinstance(value, CommentedMap | CommentedSeq)
        part = schema.by_tag.get(key)
        if key in schema.by_name and scalar:
            self._set(element, data, key, value)
        elif part is not None and (part.wrapper or not part.mixed):
            element.children += self._part(key, value, part, where)
        elif (found := schema.setting(key, self.registry)) is not None:
            element.children += self._settings(key, value, list_keys(found[1]), where)
        elif scalar:
            self._set(element, data, key, value)
        else:
            element.children += self._unknown(key, value, where)

    def _set(self, element: Element, data: CommentedMap, key: object, value: object) -> None:
        element.attributes[str(key)] = _text(value)
        element.attribute_locations[str(key)] = self._at(data, key)

    def _part(self, key: str, value: object, part: ChildField, where: Location) -> list[Element]:
        if part.wrapper:
            return self._wrapper(key, value, part, where)
        if part.many:
            return self._list(value, part)
        return [self.node(key, value, part.cls, where)]

    def _settings(self, key: str, value: object, keys: list[str], where: Location) -> list[Element]:
        if isinstance(value, CommentedSeq) and value and isinstance(value[0], CommentedMap):
            return [e for item in value for e in self._settings(key, item, keys, where)]
        element = Element(key, location=where)
        if isinstance(value, CommentedMap):
            element.attributes = {str(k): _text(v) for k, v in value.items()}
            element.attribute_locations = {str(k): self._at(value, k) for k in value}
        elif isinstance(value, CommentedSeq):
            padded = keys + [f"component{i + 1}" for i in range(len(keys), len(value))]
            element.attributes = {k: _text(v) for k, v in zip(padded, value)}
            element.attribute_locations = {k: self._at(value, i) for i, k in enumerate(padded)}
        else:
            element.attributes = {keys[0]: _text(value)}
            element.attribute_locations = {keys[0]: where}
        return [element]

    def _wrapper(self, key: str, value: object, part: ChildField, where: Location) -> list[Element]:
        """Build the wrapper of a list, and its repetitions, which Nau ignores."""
        element = Element(key, location=where)
        if not isinstance(value, CommentedMap):
            element.children = self._list(value, part)
            return [element]
        repeated: list[Element] = []
        for inner, data in value.items():
            if str(inner) == "items":
                element.children += self._list(data, part)
            elif str(inner) == "repeated":
                repeated += self._unknown(key, data, self._key_at(value, inner))
            elif isinstance(data, CommentedMap | CommentedSeq):
                element.children += self._unknown(str(inner), data, self._key_at(value, inner))
            else:
                self._set(element, value, inner, data)
        return [element, *repeated]

    def _list(self, value: object, part: ChildField) -> list[Element]:
        items = value if isinstance(value, CommentedSeq) else [] if value is None else [value]
        return [self._item(item, part, self._at(items, index)) for index, item in enumerate(items)]

    def _item(self, item: object, part: ChildField, where: Location) -> Element:
        tag, data = part.tag, item
        if part.mixed and isinstance(item, CommentedMap) and len(item) == 1:
            written, inner = next(iter(item.items()))
            if str(written) in part.classes:
                tag, data = str(written), inner
        attributes = {}
        if part.choice is not None and isinstance(data, CommentedMap):
            key = part.choice.attribute
            attributes = {key: _text(data[key])} if key in data else {}
        cls = part.class_of(tag, attributes)
        assert cls is not None  # the tag is one of the field's
        return self.node(tag, data, cls, where)

    def _unknown(self, tag: str, value: object, where: Location) -> list[Element]:
        if tag.startswith("<"):  # the name of an attribute too: see _append
            tag = tag[1:].rstrip(">")
        if isinstance(value, CommentedSeq):
            return [e for i in value for e in self._unknown(tag, i, where)]
        element = Element(tag, location=where)
        if isinstance(value, CommentedMap):
            for key, data in value.items():
                if isinstance(data, CommentedMap | CommentedSeq):
                    element.children += self._unknown(str(key), data, self._key_at(value, key))
                else:
                    element.attributes[str(key)] = _text(data)
                    element.attribute_locations[str(key)] = self._at(value, key)
        return [element]


def to_yaml(element: Element, cls: type[Node], registry: Registry) -> Any:
    """Make data for ``format_yaml``: the reverse of :meth:`YamlReader.node`."""
    schema = schema_of(cls)
    short = _shorten(element, schema, registry)
    if short is not None:
        return short
    data = CommentedMap()
    types = {attribute.name: attribute.type for attribute in schema.attributes}
    for part in schema.inline:
        types |= {a.name: a.type for a in part.known(registry)}
    for key, text in element.attributes.items():
        data[key] = _native(text, types[key]) if key in types else text
    for child in element.children:
        _add_child(data, child, schema, registry)
    return data


def _shorten(element: Element, schema: NodeSchema, registry: Registry) -> Any:
    """Write a node as its first attribute, or as its sole list, if it has nothing else."""
    first = schema.attributes[0] if schema.attributes else None
    if not element.children and first is not None and list(element.attributes) == [first.name]:
        return _native(element.attributes[first.name], first.type)
    lists = schema.plain_lists
    if len(lists) != 1 or element.attributes or not element.children:
        return None
    if any(c.tag != lists[0].tag for c in element.children):
        return None
    return CommentedSeq([_item_data(c, lists[0], registry) for c in element.children])


def _item_data(child: Element, part: ChildField, registry: Registry) -> Any:
    cls = part.class_of(child.tag, child.attributes)
    assert cls is not None  # the caller has looked at the tag
    data = to_yaml(child, cls, registry)
    return CommentedMap({child.tag: data}) if part.mixed else data


def _add_child(data: CommentedMap, child: Element, schema: NodeSchema, registry: Registry) -> None:
    tag = child.tag
    part = schema.by_tag.get(tag)
    if part is None:
        found = schema.setting(tag, registry)
        if found is not None:
            _add_setting(data, child, list_keys(found[1]), found[1].type)
            return
    elif part.wrapper:
        if tag in data:
            data[tag] = _repeat(data[tag], child)
        else:
            data[tag] = _wrapper_data(child, part, registry)
        return
    elif part.many and not part.mixed:
        data.setdefault(tag, CommentedSeq()).append(_item_data(child, part, registry))
        return
    elif not part.many and tag not in data:
        data[tag] = to_yaml(child, part.cls, registry)
        return
    _append(data, tag, _unknown_data(child))


def _add_setting(data: CommentedMap, child: Element, keys: list[str], data_type: DataType) -> None:
    plain = list(child.attributes) == keys[: len(child.attributes)] and child.attributes
    values = [_native(text, data_type) for text in child.attributes.values()]
    if child.tag in data or not plain:
        raw = CommentedMap({k: _native(v, data_type) for k, v in child.attributes.items()})
        if child.tag in data:
            earlier = data[child.tag]
            if not (isinstance(earlier, CommentedSeq) and isinstance(earlier[0], CommentedMap)):
                listed = earlier if isinstance(earlier, CommentedSeq) else [earlier]
                earlier = CommentedSeq([CommentedMap(zip(keys, listed))])
            earlier.append(raw)
            data[child.tag] = earlier
        else:
            data[child.tag] = raw
    elif len(keys) == 1:
        data[child.tag] = values[0]
    else:
        sequence = CommentedSeq(values)
        sequence.fa.set_flow_style()
        data[child.tag] = sequence


def _wrapper_data(child: Element, part: ChildField, registry: Registry) -> Any:
    known = [c for c in child.children if c.tag in part.classes]
    items = CommentedSeq([_item_data(c, part, registry) for c in known])
    if not child.attributes and len(known) == len(child.children):
        return items
    data = CommentedMap(child.attributes)
    data["items"] = items
    for other in child.children:
        if other.tag not in part.classes:
            _append(data, other.tag, _unknown_data(other))
    return data


def _repeat(earlier: Any, child: Element) -> CommentedMap:
    data = earlier if isinstance(earlier, CommentedMap) else CommentedMap({"items": earlier})
    data.setdefault("repeated", CommentedSeq()).append(_unknown_data(child))
    return data


def _append(data: CommentedMap, tag: str, value: Any) -> None:
    """Add to the list of unknown elements ``tag``; the key is ``<tag>`` if ``tag`` is taken."""
    key = tag if isinstance(data.get(tag, CommentedSeq()), CommentedSeq) else f"<{tag}>"
    data.setdefault(key, CommentedSeq()).append(value)


def _unknown_data(element: Element) -> CommentedMap:
    data = CommentedMap(element.attributes)
    for child in element.children:
        _append(data, child.tag, _unknown_data(child))
    return data


def _native(text: str, data_type: DataType) -> Scalar:
    """Return a YAML scalar that reads back as the same text, or the text itself."""
    if not (data_type.is_number or data_type.is_boolean) or has_trailing_text(text, data_type):
        return text
    try:
        value = to_scalar(text, data_type)
    except Unconvertible:
        return text
    return value if format_scalar(value) == text else text

"""YAML to elements and back, directed by the models.

The idiom: attributes are keys, wrappers are lists, vectors are lists of numbers, and a node that
is given by its first attribute alone (a name, mostly) is a plain string.
"""

from __future__ import annotations

from io import StringIO
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq
from ruamel.yaml.error import MarkedYAMLError, YAMLError

from nau_py.diagnostics.location import Location
from nau_py.formats.settings import keys_of
from nau_py.model.attributes import Registry
from nau_py.model.node import Attr, Child, Inline, Items, Marker, Node, Settings, Variants, file_key
from nau_py.model.values import (
    DataType,
    Scalar,
    Unconvertible,
    format_scalar,
    has_trailing_text,
    to_scalar,
)
from nau_py.syntax.element import Element
from nau_py.syntax.parse_error import ParseError


def _text(value: object) -> str:
    if isinstance(value, bool | int | float | str):
        return format_scalar(value) if not isinstance(value, str) else str(value)
    return "" if value is None else str(value)


class YamlReader:
    """Builds elements from YAML data; the classes say what is an attribute and what a child."""

    def __init__(self, file: str, registry: Registry) -> None:
        self.file = file
        self.registry = registry

    def _at(self, container: object, key: object) -> Location:
        try:
            if isinstance(container, CommentedMap):
                line, column = container.lc.value(key)
            else:
                line, column = container.lc.item(key)  # type: ignore[attr-defined]
        except (AttributeError, KeyError, TypeError, IndexError):
            return Location(self.file)
        return Location(self.file, line + 1, column + 1)

    def _key_at(self, container: CommentedMap, key: object) -> Location:
        try:
            line, column = container.lc.key(key)
        except (AttributeError, KeyError, TypeError):
            return Location(self.file)
        return Location(self.file, line + 1, column + 1)

    def node(self, tag: str, data: object, cls: type[Node], where: Location) -> Element:
        """The element ``tag`` of class ``cls`` that ``data`` describes."""
        element = Element(tag, location=where)
        markers = cls.markers()
        if not isinstance(data, CommentedMap):
            return self._short(element, data, markers, where)
        names = {file_key(n, m): m for n, m in markers.items() if isinstance(m, Attr)}
        for key, value in data.items():
            self._entry(element, data, str(key), value, markers, names)
        return element

    def _short(
        self, element: Element, data: object, markers: dict[str, Marker], where: Location
    ) -> Element:
        if isinstance(data, CommentedSeq):
            only = [m for m in markers.values() if isinstance(m, Items) and not m.wrapper]
            if len(only) == 1:
                element.children = self._list(data, only[0])
                return element
        if data is not None:
            first = next(
                (file_key(n, m) for n, m in markers.items() if isinstance(m, Attr)), "name"
            )
            element.attributes[first] = _text(data)
            element.attribute_locations[first] = where
        return element

    def _entry(
        self,
        element: Element,
        data: CommentedMap,
        key: str,
        value: object,
        markers: dict[str, Marker],
        names: dict[str, Attr],
    ) -> None:
        where = self._key_at(data, key)
        scalar = not isinstance(value, CommentedMap | CommentedSeq)
        if key in names and scalar:
            element.attributes[key] = _text(value)
            element.attribute_locations[key] = self._at(data, key)
            return
        for name, marker in markers.items():
            if isinstance(marker, Child) and key == (marker.tag or name):
                element.children.append(self.node(key, value, marker.cls, where))
                return
            if isinstance(marker, Items | Variants) and key == marker.wrapper:
                element.children += self._wrapper(key, value, marker, where)
                return
            if isinstance(marker, Items) and not marker.wrapper and key == marker.tag:
                element.children += self._list(value, marker)
                return
            if isinstance(marker, Settings):
                attribute = self.registry[marker.type].get(key)
                if attribute is not None:
                    repeats = self._settings(key, value, keys_of(attribute), where)
                    element.children += repeats
                    return
        if scalar:
            element.attributes[key] = _text(value)
            element.attribute_locations[key] = self._at(data, key)
        else:
            element.children += self._unknown(key, value, where)

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

    def _wrapper(
        self, key: str, value: object, marker: Items | Variants, where: Location
    ) -> list[Element]:
        """The wrapper, and its repetitions, which Nau ignores."""
        element = Element(key, location=where)
        if not isinstance(value, CommentedMap):
            element.children = self._list(value, marker)
            return [element]
        repeated: list[Element] = []
        for inner, data in value.items():
            if str(inner) == "items":
                element.children += self._list(data, marker)
            elif str(inner) == "repeated":
                repeated += self._unknown(key, data, self._key_at(value, inner))
            elif isinstance(data, CommentedMap | CommentedSeq):
                element.children += self._unknown(str(inner), data, self._key_at(value, inner))
            else:
                element.attributes[str(inner)] = _text(data)
                element.attribute_locations[str(inner)] = self._at(value, inner)
        return [element, *repeated]

    def _list(self, value: object, marker: Items | Variants) -> list[Element]:
        items = value if isinstance(value, CommentedSeq) else [] if value is None else [value]
        return [
            self._item(item, marker, self._at(items, index)) for index, item in enumerate(items)
        ]

    def _item(self, item: object, marker: Items | Variants, where: Location) -> Element:
        if isinstance(marker, Variants):
            if isinstance(item, CommentedMap) and len(item) == 1:
                tag, data = next(iter(item.items()))
                cls = marker.classes.get(str(tag))
                if cls is not None:
                    return self.node(str(tag), data, cls, where)
            tag, cls = next(iter(marker.classes.items()))
            return self.node(tag, item, cls, where)
        cls = marker.cls
        if marker.choose is not None and isinstance(item, CommentedMap):
            probe = Element(marker.tag, {"class": _text(item.get("class", "default"))})
            cls = marker.choose(probe)
        return self.node(marker.tag, item, cls, where)

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


def load_yaml(text: str, file: str) -> CommentedMap:
    """Parse YAML (safe: no tags are executed). Raises :class:`ParseError` with a position."""
    try:
        data = YAML(typ="rt", pure=True).load(text)
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        where = Location(file, mark.line + 1, mark.column + 1) if mark else Location(file, 1, 1)
        raise ParseError(where, str(error.problem or error.context)) from None
    except (YAMLError, ValueError) as error:  # characters that YAML forbids, numbers beyond reason
        first = str(error).splitlines()[0]
        raise ParseError(Location(file, 1, 1), first) from None
    if not isinstance(data, CommentedMap):
        raise ParseError(Location(file, 1, 1), "a mapping is expected at the top")
    return data


def to_yaml(element: Element, cls: type[Node], registry: Registry) -> Any:
    """Data for :func:`format_yaml`: the reverse of :meth:`YamlReader.node`."""
    markers = cls.markers()
    attributes = {file_key(n, m): m for n, m in markers.items() if isinstance(m, Attr)}
    short = _shorten(element, markers, attributes, registry)
    if short is not None:
        return short
    data = CommentedMap()
    types = {key: marker.type for key, marker in attributes.items()}
    for marker in markers.values():
        if isinstance(marker, Inline):
            types |= {a.name: a.type for a in registry[marker.type]}
    for key, text in element.attributes.items():
        data[key] = _native(text, types[key]) if key in types else text
    for child in element.children:
        _add_child(data, child, markers, registry)
    return data


def _shorten(
    element: Element, markers: dict[str, Marker], attributes: dict[str, Attr], registry: Registry
) -> Any:
    first = next(iter(attributes), None)
    if not element.children and list(element.attributes) == [first] and first is not None:
        return _native(element.attributes[first], attributes[first].type)
    only = [m for m in markers.values() if isinstance(m, Items) and not m.wrapper]
    if len(only) == 1 and element.children and not element.attributes:
        marker = only[0]
        if all(c.tag == marker.tag for c in element.children):
            items = [_item_data(c, marker, registry) for c in element.children]
            return CommentedSeq(items)
    return None


def _item_data(child: Element, marker: Items | Variants, registry: Registry) -> Any:
    if isinstance(marker, Variants):
        entry = CommentedMap()
        entry[child.tag] = to_yaml(child, marker.classes[child.tag], registry)
        return entry
    cls = marker.choose(child) if marker.choose else marker.cls
    return to_yaml(child, cls, registry)


def _add_child(
    data: CommentedMap, child: Element, markers: dict[str, Marker], registry: Registry
) -> None:
    for name, marker in markers.items():
        if (
            isinstance(marker, Child)
            and child.tag == (marker.tag or name)
            and child.tag not in data
        ):
            data[child.tag] = to_yaml(child, marker.cls, registry)
            return
        if isinstance(marker, Items | Variants):
            if marker.wrapper and child.tag == marker.wrapper:
                if child.tag in data:
                    data[child.tag] = _repeat(data[child.tag], child)
                else:
                    data[child.tag] = _wrapper_data(child, marker, registry)
                return
            if not marker.wrapper and isinstance(marker, Items) and child.tag == marker.tag:
                data.setdefault(child.tag, CommentedSeq()).append(
                    _item_data(child, marker, registry)
                )
                return
        if isinstance(marker, Settings):
            attribute = registry[marker.type].get(child.tag)
            if attribute is not None:
                keys = keys_of(attribute)
                _add_setting(data, child, keys, attribute.type)
                return
    _append(data, child.tag, _unknown_data(child))


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


def _wrapper_data(child: Element, marker: Items | Variants, registry: Registry) -> Any:
    tags = marker.classes if isinstance(marker, Variants) else {marker.tag: marker.cls}
    known = [c for c in child.children if c.tag in tags]
    items = CommentedSeq([_item_data(c, marker, registry) for c in known])
    if not child.attributes and len(known) == len(child.children):
        return items
    data = CommentedMap(child.attributes)
    data["items"] = items
    for other in child.children:
        if other.tag not in tags:
            _append(data, other.tag, _unknown_data(other))
    return data


def _repeat(earlier: Any, child: Element) -> CommentedMap:
    data = earlier if isinstance(earlier, CommentedMap) else CommentedMap({"items": earlier})
    data.setdefault("repeated", CommentedSeq()).append(_unknown_data(child))
    return data


def _append(data: CommentedMap, tag: str, value: Any) -> None:
    """Add to the list of unknown elements ``tag``: under ``<tag>`` where the key is taken."""
    key = tag if isinstance(data.get(tag, CommentedSeq()), CommentedSeq) else f"<{tag}>"
    data.setdefault(key, CommentedSeq()).append(value)


def _unknown_data(element: Element) -> CommentedMap:
    data = CommentedMap(element.attributes)
    for child in element.children:
        _append(data, child.tag, _unknown_data(child))
    return data


def _native(text: str, data_type: DataType) -> Scalar:
    """A YAML scalar that reads back as the same text, or the text itself."""
    if not (data_type.is_number or data_type.is_boolean) or has_trailing_text(text, data_type):
        return text
    try:
        value = to_scalar(text, data_type)
    except Unconvertible:
        return text
    return value if format_scalar(value) == text else text


def format_yaml(data: Any) -> str:
    """YAML text."""
    yaml = YAML(typ="rt", pure=True)
    yaml.indent(mapping=2, sequence=4, offset=2)
    yaml.width = 100
    stream = StringIO()
    yaml.dump(data, stream)
    return stream.getvalue()

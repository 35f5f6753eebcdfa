"""Elements to models and back, driven by the markers of :mod:`nau_py.model.node`."""

from __future__ import annotations

from typing import Any, TypeVar, cast

from nau_py.diagnostics.problem import Problem, ProblemKind
from nau_py.formats.settings import parse_inline, parse_setting, write_setting
from nau_py.model.attributes import Registry
from nau_py.model.node import (
    Attr,
    Child,
    Inline,
    Items,
    Marker,
    Node,
    Setting,
    Settings,
    Variants,
    file_key,
)
from nau_py.model.values import (
    Scalar,
    Unconvertible,
    format_scalar,
    has_trailing_text,
    to_scalar,
)
from nau_py.syntax.element import Element

N = TypeVar("N", bound=Node)


class Binder:
    """Turns elements into models, collecting problems. Nothing is dropped."""

    def __init__(self, registry: Registry, problems: list[Problem]) -> None:
        self.registry = registry
        self.problems = problems

    def bind(self, element: Element, cls: type[N]) -> N:
        """The model of ``element``."""
        made = cls.model_construct(  # values are converted here: no second validation
            location=element.location,
            attribute_locations=element.attribute_locations,
            tag=element.source_tag,
        )
        node = cast(N, made)  # the plug-in of mypy takes it for a plain Node
        markers = cls.markers()
        self._bind_attributes(element, node, markers)
        for child in element.children:
            if not self._bind_child(child, node, markers):
                node.unknown_children.setdefault(child.tag, []).append(child)
        return node

    def _bind_attributes(self, element: Element, node: Node, markers: dict[str, Marker]) -> None:
        by_key = {file_key(n, m): (n, m) for n, m in markers.items() if isinstance(m, Attr)}
        inline = [(n, m) for n, m in markers.items() if isinstance(m, Inline)]
        for key, text in element.attributes.items():
            if key in by_key:
                name, marker = by_key[key]
                value = self._attribute(element, key, text, marker)
                if value is not None:
                    setattr(node, name, value)
                    continue
            elif any(self._inline(element, key, text, node, n, m) for n, m in inline):
                continue
            node.unknown_attributes[key] = text

    def _attribute(self, element: Element, key: str, text: str, marker: Attr) -> Scalar | None:
        if marker.type.value == "STRING":
            return text
        try:
            value = to_scalar(text, marker.type)
            if isinstance(value, str) and not marker.constant:
                raise Unconvertible(text)
        except Unconvertible:
            self._report(ProblemKind.UNCONVERTIBLE, element, key, text, marker.type.value)
            return None
        if not isinstance(value, str) and has_trailing_text(text, marker.type):
            self._report(ProblemKind.TRAILING_TEXT, element, key, text, format_scalar(value))
        return value

    def _inline(
        self, element: Element, key: str, text: str, node: Node, name: str, marker: Inline
    ) -> bool:
        attribute = self.registry.of(type(node), marker.type).get(key)
        if attribute is None:
            return False
        setting = parse_inline(element, key, attribute, self.problems)
        if setting is None:
            return False
        getattr(node, name)[key] = setting
        return True

    def _report(
        self, kind: ProblemKind, element: Element, key: str, text: str, expected: str
    ) -> None:
        self.problems.append(
            Problem(kind, element.where(key), element.source_tag, key, text, expected)
        )

    def _bind_child(self, child: Element, node: Node, markers: dict[str, Marker]) -> bool:
        for name, marker in markers.items():
            if isinstance(marker, Child) and child.tag == (marker.tag or name):
                if getattr(node, name) is not None:
                    self._repeated(child, node)
                    return False
                setattr(node, name, self.bind(child, marker.cls))
                return True
            if isinstance(marker, Items | Variants):
                if marker.wrapper and child.tag == marker.wrapper:
                    return self._wrapper(child, node, name, marker)
                if not marker.wrapper and self._item(child, getattr(node, name), marker):
                    return True
            if isinstance(marker, Settings) and self._setting(child, node, name, marker):
                return True
        return False

    def _repeated(self, child: Element, node: Node) -> None:
        self.problems.append(
            Problem(ProblemKind.REPEATED, child.location, child.source_tag, detail=node.tag)
        )

    def _item(self, child: Element, items: list[Any], marker: Items | Variants) -> bool:
        if isinstance(marker, Variants):
            cls = marker.classes.get(child.tag)
        elif child.tag != marker.tag:
            cls = None
        else:
            cls = marker.choose(child) if marker.choose else marker.cls
        if cls is None:
            return False
        items.append(self.bind(child, cls))
        return True

    def _wrapper(self, child: Element, node: Node, name: str, marker: Items | Variants) -> bool:
        items = getattr(node, name)
        if items or child.tag in node.partial:
            self._repeated(child, node)
            return False
        rest = [c for c in child.children if not self._item(c, items, marker)]
        if child.attributes or rest or not items:
            node.partial[child.tag] = Element(
                child.tag,
                dict(child.attributes),
                rest,
                child.location,
                child.attribute_locations,
                child.written,
            )
        return True

    def _setting(self, child: Element, node: Node, name: str, marker: Settings) -> bool:
        attribute = self.registry.of(type(node), marker.type).get(child.tag)
        if attribute is None:
            return False
        setting = parse_setting(child, attribute, self.problems)
        if setting is None:
            return False
        settings: dict[str, Setting] = getattr(node, name)
        earlier = settings.pop(child.tag, None)
        if earlier is not None:
            self._repeated(child, node)
            kept = write_setting(child.tag, earlier, attribute)
            kept.location = earlier.location
            node.unknown_children.setdefault(child.tag, []).append(kept)
        settings[child.tag] = setting
        return True


def unbind(node: Node, tag: str, registry: Registry) -> Element:
    """The element of a model: what :meth:`Binder.bind` reads back as an equal model."""
    element = Element(tag, location=node.location)
    for name, marker in node.markers().items():
        value = getattr(node, name)
        if isinstance(marker, Attr):
            if value is not None:
                element.attributes[file_key(name, marker)] = format_scalar(value)
        elif isinstance(marker, Inline):
            for key, setting in value.items():
                element.attributes[key] = format_scalar(setting.parts[0])
    element.attributes |= node.unknown_attributes
    for name, marker in node.markers().items():
        value = getattr(node, name)
        if isinstance(marker, Child) and value is not None:
            element.children.append(unbind(value, marker.tag or name, registry))
        elif isinstance(marker, Items | Variants):
            element.children += _items(node, value, marker, registry)
        elif isinstance(marker, Settings):
            set_ = registry.of(type(node), marker.type)
            element.children += [
                write_setting(key, setting, set_.attributes[key]) for key, setting in value.items()
            ]
    for unknown in node.unknown_children.values():
        element.children += unknown
    return element


def _items(
    node: Node, value: list[Node], marker: Items | Variants, registry: Registry
) -> list[Element]:
    written = [unbind(item, _tag_of(item, marker), registry) for item in value]
    if not marker.wrapper:
        return written
    rest = node.partial.get(marker.wrapper)
    if not written and rest is None:
        return []
    wrapper = Element(marker.wrapper, dict(rest.attributes) if rest else {}, written)
    wrapper.children += rest.children if rest else []
    return [wrapper]


def _tag_of(item: Node, marker: Items | Variants) -> str:
    if isinstance(marker, Items):
        return marker.tag
    return next(tag for tag, cls in marker.classes.items() if cls is type(item))

"""Elements to nodes and back, by the description of each class (:mod:`nau_py.model.schema`)."""

from __future__ import annotations

from typing import TypeVar, cast

from nau_py.diagnostics.problem import Problem, ProblemKind
from nau_py.formats.settings import parse_inline, parse_setting, write_setting
from nau_py.model.attribute import Attribute
from nau_py.model.attributes import Registry
from nau_py.model.node import Node
from nau_py.model.schema import (
    AttributeField,
    ChildField,
    NodeSchema,
    SettingsField,
    schema_of,
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
    """Builds nodes from elements and collects problems. Nothing of a file is dropped."""

    def __init__(self, registry: Registry, problems: list[Problem]) -> None:
        self.registry = registry
        self.problems = problems

    def bind(self, element: Element, cls: type[N]) -> N:
        """Build the node of class ``cls`` that ``element`` describes."""
        made = cls.model_construct(  # values are converted here: no second validation
            location=element.location,
            attribute_locations=element.attribute_locations,
            tag=element.source_tag,
        )
        node = cast(N, made)  # the plug-in of mypy takes it for a plain Node
        schema = schema_of(cls)
        for key in element.attributes:
            if not self._bind_attribute(element, key, node, schema):
                node.unknown_attributes[key] = element.attributes[key]
        for child in element.children:
            if not self._bind_child(child, node, schema):
                node.unknown_children.setdefault(child.tag, []).append(child)
        return node

    def _bind_attribute(self, element: Element, key: str, node: Node, schema: NodeSchema) -> bool:
        attribute = schema.by_name.get(key)
        if attribute is not None:
            value = self._convert(element, key, attribute)
            if value is None:
                return False
            setattr(node, attribute.field, value)
            return True
        found = schema.inline_setting(key, self.registry)
        if found is None:
            return False
        setting = parse_inline(element, key, found[1], self.problems)
        if setting is None:
            return False
        found[0].of(node)[key] = setting
        return True

    def _convert(self, element: Element, key: str, attribute: AttributeField) -> Scalar | None:
        text, type_ = element.attributes[key], attribute.type
        if type_.value == "STRING":
            return text
        try:
            value = to_scalar(text, type_)
            if isinstance(value, str) and not attribute.constant:
                raise Unconvertible(text)
        except Unconvertible:
            self._report(ProblemKind.UNCONVERTIBLE, element, key, text, type_.value)
            return None
        if not isinstance(value, str) and has_trailing_text(text, type_):
            self._report(ProblemKind.TRAILING_TEXT, element, key, text, format_scalar(value))
        return value

    def _report(
        self, kind: ProblemKind, element: Element, key: str, text: str, expected: str
    ) -> None:
        self.problems.append(
            Problem(kind, element.where(key), element.source_tag, key, text, expected)
        )

    def _bind_child(self, child: Element, node: Node, schema: NodeSchema) -> bool:
        part = schema.by_tag.get(child.tag)
        if part is None:
            found = schema.setting(child.tag, self.registry)
            return found is not None and self._bind_setting(child, node, *found)
        if part.wrapper:
            return self._bind_wrapper(child, node, part)
        if part.many:
            return self._bind_item(child, getattr(node, part.field), part)
        if getattr(node, part.field) is not None:
            self._report_repeated(child, node)
            return False
        setattr(node, part.field, self.bind(child, part.cls))
        return True

    def _report_repeated(self, child: Element, node: Node) -> None:
        self.problems.append(
            Problem(ProblemKind.REPEATED, child.location, child.source_tag, detail=node.tag)
        )

    def _bind_item(self, child: Element, items: list[Node], part: ChildField) -> bool:
        cls = part.class_of(child.tag, child.attributes)
        if cls is None:
            return False
        items.append(self.bind(child, cls))
        return True

    def _bind_wrapper(self, child: Element, node: Node, part: ChildField) -> bool:
        items: list[Node] = getattr(node, part.field)
        if items or child.tag in node.partial:
            self._report_repeated(child, node)
            return False
        rest = [c for c in child.children if not self._bind_item(c, items, part)]
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

    def _bind_setting(
        self, child: Element, node: Node, part: SettingsField, attribute: Attribute
    ) -> bool:
        setting = parse_setting(child, attribute, self.problems)
        if setting is None:
            return False
        settings = part.of(node)
        earlier = settings.pop(child.tag, None)
        if earlier is not None:
            self._report_repeated(child, node)
            kept = write_setting(child.tag, earlier, attribute)
            kept.location = earlier.location
            node.unknown_children.setdefault(child.tag, []).append(kept)
        settings[child.tag] = setting
        return True


def make_element(node: Node, tag: str, registry: Registry) -> Element:
    """Write a node as an element, which :meth:`Binder.bind` reads back as an equal node."""
    element = Element(tag, location=node.location)
    schema = schema_of(type(node))
    for attribute in schema.attributes:
        value = attribute.of(node)
        if value is not None:
            element.attributes[attribute.name] = format_scalar(value)
    for part in schema.inline:
        for key, setting in part.of(node).items():
            element.attributes[key] = format_scalar(setting.parts[0])
    element.attributes |= node.unknown_attributes
    for elements in schema.each_content(
        lambda part: _unbind_children(node, part, registry),
        lambda part: _unbind_settings(node, part, registry),
    ):
        element.children += elements
    for unknown in node.unknown_children.values():
        element.children += unknown
    return element


def _unbind_settings(node: Node, part: SettingsField, registry: Registry) -> list[Element]:
    known = part.known(registry).attributes
    return [write_setting(key, setting, known[key]) for key, setting in part.of(node).items()]


def _unbind_children(node: Node, part: ChildField, registry: Registry) -> list[Element]:
    written = [make_element(item, part.tag_of(item), registry) for item in part.of(node)]
    if not part.wrapper:
        return written
    rest = node.partial.get(part.wrapper)
    if not written and rest is None:
        return []
    wrapper = Element(part.wrapper, dict(rest.attributes) if rest else {}, written)
    wrapper.children += rest.children if rest else []
    return [wrapper]

"""The one description of a node class, derived from the markers of its fields.

A file holds three kinds of data about a node, and :class:`NodeSchema` has one list for each:

* *attributes*: XML attributes (keys in YAML) with a name that the class declares;
* *children*: elements that are nodes themselves, one or a list, with or without a wrapper;
* *settings*: values of an attribute set (docs/format.md, section 9), whose names the project can
  extend, as child tags or as XML attributes.

Reading, writing, JSON Schema, XSD, lint, completion, hover and the reference page all work on these
lists. A new marker is one more case in :func:`_describe`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from typing import TypeVar

from nau_py.model.attribute import Attribute, AttributeSet
from nau_py.model.attributes import Registry
from nau_py.model.node import (
    Attr,
    Child,
    Choice,
    Inline,
    Items,
    Node,
    NodeSettings,
    Settings,
    Variants,
    markers,
)
from nau_py.model.values import Scalar

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class AttributeField(Attr):
    """An XML attribute of a class. ``name`` is its name in a file, ``field`` its Python name."""

    field: str = ""

    def of(self, node: Node) -> Scalar | None:
        """Return the value that ``node`` has, or None if it is unset."""
        value: Scalar | None = getattr(node, self.field)
        return value


@dataclass(frozen=True, slots=True)
class ChildField:
    """Child elements that are nodes themselves."""

    field: str
    classes: Mapping[str, type[Node]]
    """Tag to class; one entry unless ``mixed``."""
    many: bool
    """True for a list, False for at most one."""
    mixed: bool = False
    """True if one list holds elements of several tags, in an order that matters."""
    wrapper: str = ""
    """The element around a list; empty for none."""
    choice: Choice | None = None
    """The choice of the class by an attribute; ``classes`` then holds the common base."""
    doc: str = ""

    @property
    def tag(self) -> str:
        """The tag of its elements, if it is not mixed."""
        return next(iter(self.classes))

    @property
    def cls(self) -> type[Node]:
        """The class of its elements, if it is not mixed."""
        return next(iter(self.classes.values()))

    @property
    def outer_tags(self) -> list[str]:
        """The tags that it takes directly below its node: the wrapper, or those of its items."""
        return [self.wrapper] if self.wrapper else list(self.classes)

    @property
    def alternatives(self) -> list[type[Node]]:
        """The classes that its elements can have."""
        known = self.choice.classes if self.choice is not None else self.classes
        return list(dict.fromkeys(known.values()))

    def class_of(self, tag: str, attributes: Mapping[str, str]) -> type[Node] | None:
        """Return the class of an element, or None for a tag that the field does not take."""
        if self.choice is not None and tag in self.classes:
            return self.choice.pick(attributes)
        return self.classes.get(tag)

    def tag_of(self, node: Node) -> str:
        """Return the tag to write ``node`` with."""
        if not self.mixed:
            return self.tag
        return next(tag for tag, cls in self.classes.items() if cls is type(node))

    def of(self, node: Node) -> list[Node]:
        """Return the child nodes that ``node`` has."""
        value = getattr(node, self.field)
        if self.many:
            return list(value)
        return [] if value is None else [value]


@dataclass(frozen=True, slots=True)
class SettingsField:
    """Values of the attribute set ``type``, as child tags or as XML attributes."""

    field: str
    cls: type[Node]
    """The class that is described: passes of a class have parameters of their own."""
    type: str
    as_tags: bool
    doc: str = ""

    def known(self, registry: Registry) -> AttributeSet:
        """Return the attributes that the class has in a project."""
        return registry.of(self.cls, self.type)

    def of(self, node: Node) -> NodeSettings:
        """Return the settings that ``node`` has."""
        value: NodeSettings = getattr(node, self.field)
        return value


@dataclass(frozen=True, slots=True)
class NodeSchema:
    """Description of a node class. Every list is in the order of declaration."""

    cls: type[Node]
    attributes: list[AttributeField] = field(default_factory=list)
    inline: list[SettingsField] = field(default_factory=list)
    """Settings that are written as XML attributes."""
    children: list[ChildField] = field(default_factory=list)
    settings: list[SettingsField] = field(default_factory=list)
    """Settings that are written as child tags."""
    content: list[ChildField | SettingsField] = field(default_factory=list)
    """``children`` and ``settings`` in their common order."""
    by_name: dict[str, AttributeField] = field(default_factory=dict)
    """Name in a file to attribute."""
    by_tag: dict[str, ChildField] = field(default_factory=dict)
    """Tag directly below a node of this class (a wrapper's, if there is one) to child field."""

    @property
    def doc(self) -> str:
        """The docstring of the class on one line."""
        return " ".join((self.cls.__doc__ or "").split())

    @property
    def plain_lists(self) -> list[ChildField]:
        """Lists of one tag without a wrapper. YAML may write a sole one for the whole node."""
        return [c for c in self.children if c.many and not c.wrapper and not c.mixed]

    def each_content(
        self, children: Callable[[ChildField], T], settings: Callable[[SettingsField], T]
    ) -> list[T]:
        """Call one of two functions for each kind of content, in the order of declaration."""
        return [
            children(part) if isinstance(part, ChildField) else settings(part)
            for part in self.content
        ]

    def setting(self, tag: str, registry: Registry) -> tuple[SettingsField, Attribute] | None:
        """Find the attribute that a child tag sets, read-only ones included."""
        for part in self.settings:
            attribute = part.known(registry).get(tag)
            if attribute is not None:
                return part, attribute
        return None

    def inline_setting(
        self, name: str, registry: Registry
    ) -> tuple[SettingsField, Attribute] | None:
        """Find the attribute of an attribute set that an XML attribute sets."""
        for part in self.inline:
            attribute = part.known(registry).get(name)
            if attribute is not None:
                return part, attribute
        return None

    def tags(self, registry: Registry) -> list[str]:
        """List the child tags that a file may write."""
        found = self.each_content(
            lambda part: part.outer_tags, lambda part: part.known(registry).writable
        )
        return [tag for tags in found for tag in tags]

    def names(self, registry: Registry) -> list[str]:
        """List the XML attributes that a file may write."""
        inline = [name for part in self.inline for name in part.known(registry).writable]
        return [a.name for a in self.attributes] + inline


_SCHEMAS: dict[type[Node], NodeSchema] = {}


def schema_of(cls: type[Node]) -> NodeSchema:
    """Return the description of a class. It is derived at the first call.

    Raises TypeError for a class that declares one tag twice.
    """
    found = _SCHEMAS.get(cls)
    if found is None:
        found = _SCHEMAS[cls] = _describe(cls)
    return found


def _describe(cls: type[Node]) -> NodeSchema:
    schema = NodeSchema(cls)
    for name, marker in markers(cls).items():
        match marker:
            case Attr():
                given = {f.name: getattr(marker, f.name) for f in fields(Attr)}
                attribute = AttributeField(**given | {"name": marker.name or name, "field": name})
                schema.attributes.append(attribute)
                schema.by_name[attribute.name] = attribute
            case Child(child, tag, doc):
                _add(schema, ChildField(name, {tag or name: child}, many=False, doc=doc))
            case Items(item, tag, wrapper, doc, choice):
                part = ChildField(
                    name, {tag: item}, many=True, wrapper=wrapper, choice=choice, doc=doc
                )
                _add(schema, part)
            case Variants(classes, wrapper, doc):
                part = ChildField(name, classes, many=True, mixed=True, wrapper=wrapper, doc=doc)
                _add(schema, part)
            case Settings(type_, doc):
                settings = SettingsField(name, cls, type_, as_tags=True, doc=doc)
                schema.settings.append(settings)
                schema.content.append(settings)
            case Inline(type_, doc):
                schema.inline.append(SettingsField(name, cls, type_, as_tags=False, doc=doc))
    return schema


def _add(schema: NodeSchema, part: ChildField) -> None:
    schema.children.append(part)
    schema.content.append(part)
    for tag in part.outer_tags:
        if tag in schema.by_tag:
            raise TypeError(f"{schema.cls.__name__} declares the child <{tag}> twice")
        schema.by_tag[tag] = part

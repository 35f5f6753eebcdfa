"""JSON Schema of the YAML form and XSD of the XML form, generated from the models, for editors.

They say what may stand where; what references lead to, and numbers out of range, is lint's affair.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any
from xml.sax.saxutils import quoteattr

from nau_py.formats.settings import keys_of
from nau_py.model.attribute import Attribute
from nau_py.model.attributes import Registry
from nau_py.model.library import MaterialLibrary
from nau_py.model.node import (
    Attr,
    Child,
    Inline,
    Items,
    Marker,
    Node,
    Settings,
    Variants,
    file_key,
)
from nau_py.model.pass_classes import PASS_CLASSES
from nau_py.model.passes import Pass
from nau_py.model.project import ProjectFile

ID = "https://nau-py.invalid/schema/{}-1.json"
_SCALAR = {"type": ["string", "number", "boolean"]}
Schema = dict[str, Any]


def _doc(cls: type[Node]) -> str:
    return " ".join((cls.__doc__ or "").split())


def _scalar(values: tuple[str, ...], doc: str) -> Schema:
    found: Schema = {"enum": list(values)} if values else dict(_SCALAR)
    return found | ({"description": doc} if doc else {})


def _ref(cls: type[Node]) -> Schema:
    return {"$ref": f"#/$defs/{cls.__name__}"}


def _passes() -> Schema:
    """One definition a pass class, chosen by ``class``."""
    chosen = [
        {
            "if": {"properties": {"class": {"const": name}}, "required": ["class"]},
            "then": _ref(cls),
        }
        for name, cls in PASS_CLASSES.items()
    ]
    usual = {"if": {"not": {"required": ["class"]}}, "then": _ref(PASS_CLASSES["default"])}
    return {"type": "object", "allOf": [*chosen, usual]}


def _add(properties: dict[str, Schema], key: str, form: Schema) -> None:
    """A form of a key, beside those that it has: a stage is a file name or a list of files."""
    before = properties.get(key)
    properties[key] = form if before is None else {"anyOf": [before, form]}


class _Json:
    """Definitions of the classes that have been met."""

    def __init__(self, registry: Registry) -> None:
        self.registry = registry
        self.definitions: dict[str, Schema] = {}

    def define(self, cls: type[Node]) -> Schema:
        if cls.__name__ not in self.definitions:
            self.definitions[cls.__name__] = {}  # taken: a class may hold itself
            self.definitions[cls.__name__] = self._class(cls)
        return _ref(cls)

    def _class(self, cls: type[Node]) -> Schema:
        properties: dict[str, Schema] = {}
        required = []
        open_ = False
        for name, marker in cls.markers().items():
            if isinstance(marker, Attr):
                key = file_key(name, marker)
                _add(properties, key, _scalar(marker.values, marker.doc))
                required += [key] * marker.required
            elif isinstance(marker, Settings | Inline):
                open_ = True  # a project can add attributes to a type
                for attribute in self.registry.of(cls, marker.type):
                    if not attribute.readonly:
                        properties.setdefault(attribute.name, self._setting(attribute))
            else:
                for key, form in self._children(name, marker).items():
                    _add(properties, key, form)
        whole: Schema = {
            "type": "object",
            "description": _doc(cls),
            "properties": properties,
            "additionalProperties": open_,
        }
        if required:
            whole["required"] = required
        short = self._short(cls)
        return {"anyOf": [whole, *short]} if short else whole

    def _short(self, cls: type[Node]) -> list[Schema]:
        """What may stand for a node that has its first attribute, or its items, alone."""
        markers = cls.markers()
        found: list[Schema] = []
        first = next((m for m in markers.values() if isinstance(m, Attr)), None)
        if first is not None:
            found.append(_scalar(first.values, ""))
        lone = [m for m in markers.values() if isinstance(m, Items) and not m.wrapper]
        if len(lone) == 1:
            found.append({"type": "array", "items": self._item(lone[0])})
        return found

    def _item(self, marker: Items | Variants) -> Schema:
        if isinstance(marker, Variants):
            return {"anyOf": [self._one(tag, cls) for tag, cls in marker.classes.items()]}
        if issubclass(marker.cls, Pass):
            for cls in PASS_CLASSES.values():
                self.define(cls)
            return _passes()
        return self.define(marker.cls)

    def _one(self, tag: str, cls: type[Node]) -> Schema:
        return {
            "type": "object",
            "properties": {tag: {"anyOf": [self.define(cls), {"type": "null"}]}},
            "required": [tag],
            "additionalProperties": False,
        }

    def _children(self, name: str, marker: Marker) -> dict[str, Schema]:
        if isinstance(marker, Child):
            child = self.define(marker.cls)
            return {marker.tag or name: {"anyOf": [child, {"type": "null"}]}}
        assert isinstance(marker, Items | Variants)
        if isinstance(marker, Variants) and not marker.wrapper:
            for cls in marker.classes.values():
                self.define(cls)
            return {tag: {"type": ["array", "object"]} for tag in marker.classes}
        item = self._item(marker)
        listed: Schema = {"type": "array", "items": item}
        key = marker.wrapper or (marker.tag if isinstance(marker, Items) else "")
        forms: list[Schema] = [listed, {"type": "null"}]
        if marker.wrapper:
            forms.append({"type": "object", "properties": {"items": listed}, "required": ["items"]})
        return {key: {"anyOf": forms, "description": marker.doc}}

    def _setting(self, attribute: Attribute) -> Schema:
        keys = keys_of(attribute)
        one = _scalar(attribute.values if len(keys) == 1 else (), "")
        by_key: Schema = {"type": "object", "properties": dict.fromkeys(keys, _SCALAR)}
        forms: list[Schema] = [one, by_key, {"type": "array", "items": by_key}]
        if len(keys) > 1:
            forms.append({"type": "array", "items": _SCALAR, "maxItems": len(keys)})
        return {"anyOf": forms, "description": attribute.doc}


def json_schema(registry: Registry, library: bool = False) -> str:
    """JSON Schema 2020-12 of projects, or of material libraries, in YAML."""
    cls: type[Node] = MaterialLibrary if library else ProjectFile
    made = _Json(registry)
    root = made.define(cls)
    name = "library" if library else "project"
    whole = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": ID.format(name),
        "title": f"nau_py {name}",
        **root,
        "$defs": made.definitions,
    }
    return json.dumps(whole, indent=1) + "\n"


_HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n<xs:schema xmlns:xs="{}">'
_XS = "http://www.w3.org/2001/XMLSchema"


class _Xsd:
    """Complex types of the classes that have been met, as text."""

    def __init__(self, registry: Registry) -> None:
        self.registry = registry
        self.types: dict[str, str] = {}

    def define(self, cls: type[Node]) -> str:
        name = cls.__name__
        if name not in self.types:
            self.types[name] = ""
            self.types[name] = self._type(name, [cls])
        return name

    def union(self, classes: list[type[Node]]) -> str:
        """One type with what each of several classes takes: XSD cannot choose by an attribute."""
        unique = list(dict.fromkeys(classes))
        if len(unique) == 1:
            return self.define(unique[0])
        name = "Or".join(c.__name__ for c in unique)
        if name not in self.types:
            self.types[name] = ""
            self.types[name] = self._type(name, unique)
        return name

    def _type(self, name: str, classes: list[type[Node]]) -> str:
        attributes: dict[str, str] = {}
        elements: dict[str, str] = {}
        single: dict[str, list[type[Node]]] = {}
        open_ = False
        for cls in classes:
            for field, marker in cls.markers().items():
                if isinstance(marker, Attr):
                    key = file_key(field, marker)
                    attributes.setdefault(key, self._attribute(key, marker))
                elif isinstance(marker, Inline):
                    open_ = True  # a project can add attributes to a type
                elif isinstance(marker, Settings):
                    open_ = True
                    for attribute in self.registry.of(cls, marker.type):
                        if not attribute.readonly:
                            text = self._setting(attribute)
                            elements.setdefault(attribute.name, text)
                elif isinstance(marker, Child):
                    single.setdefault(marker.tag or field, []).append(marker.cls)
                else:
                    for tag, text in self._listed(marker):
                        elements.setdefault(tag, text)
        for tag, found in single.items():
            elements[tag] = _element(tag, self.union(found), _doc(found[0]))
        parts = [f"<xs:complexType name={quoteattr(name)}>", _documentation(_doc(classes[0]))]
        if elements or open_:
            parts.append('<xs:choice minOccurs="0" maxOccurs="unbounded">')
            parts += elements.values()
            parts.append("</xs:choice>")
        parts += attributes.values()
        if open_:
            parts.append('<xs:anyAttribute processContents="skip"/>')
        return "\n".join([*parts, "</xs:complexType>"])

    def _attribute(self, key: str, marker: Attr) -> str:
        use = ' use="required"' if marker.required else ""
        head = f"<xs:attribute name={quoteattr(key)}{use}"
        if not marker.values:
            return f'{head} type="xs:string">{_documentation(marker.doc)}</xs:attribute>'
        return f"{head}>{_documentation(marker.doc)}{_choice(marker.values)}</xs:attribute>"

    def _listed(self, marker: Items | Variants) -> Iterator[tuple[str, str]]:
        inner = list(self._items(marker))
        if not marker.wrapper:
            yield from inner
            return
        choice = "".join(text for _, text in inner)
        yield (
            marker.wrapper,
            f"<xs:element name={quoteattr(marker.wrapper)}>{_documentation(marker.doc)}"
            f'<xs:complexType><xs:choice minOccurs="0" maxOccurs="unbounded">{choice}</xs:choice>'
            "</xs:complexType></xs:element>",
        )

    def _items(self, marker: Items | Variants) -> Iterator[tuple[str, str]]:
        if isinstance(marker, Variants):
            for tag, cls in marker.classes.items():
                yield tag, _element(tag, self.define(cls), _doc(cls))
            return
        passes: list[type[Node]] = [*PASS_CLASSES.values()]
        name = self.union(passes if issubclass(marker.cls, Pass) else [marker.cls])
        yield marker.tag, _element(marker.tag, name, marker.doc or _doc(marker.cls))

    def _setting(self, attribute: Attribute) -> str:
        keys = keys_of(attribute)
        values = attribute.values if len(keys) == 1 else ()
        inner = "".join(
            f"<xs:attribute name={quoteattr(key)}"
            + (f">{_choice(values)}</xs:attribute>" if values else ' type="xs:string"/>')
            for key in keys
        )
        return (
            f"<xs:element name={quoteattr(attribute.name)}>{_documentation(attribute.doc)}"
            f"<xs:complexType>{inner}</xs:complexType></xs:element>"
        )


def _documentation(text: str) -> str:
    if not text:
        return ""
    escaped = text.replace("&", "&amp;").replace("<", "&lt;")
    return f"<xs:annotation><xs:documentation>{escaped}</xs:documentation></xs:annotation>"


def _choice(values: tuple[str, ...]) -> str:
    listed = "".join(f"<xs:enumeration value={quoteattr(v)}/>" for v in values)
    return (
        f'<xs:simpleType><xs:restriction base="xs:string">{listed}</xs:restriction></xs:simpleType>'
    )


def _element(tag: str, type_: str, doc: str) -> str:
    return (
        f"<xs:element name={quoteattr(tag)} type={quoteattr(type_)}>{_documentation(doc)}"
        "</xs:element>"
    )


def xsd(registry: Registry) -> str:
    """XSD 1.0 of projects and material libraries in clean XML, as nau-fmt writes it."""
    made = _Xsd(registry)
    roots = [
        _element("project", made.define(ProjectFile), _doc(ProjectFile)),
        _element("materialLib", made.define(MaterialLibrary), _doc(MaterialLibrary)),
    ]
    return "\n".join([_HEAD.format(_XS), *roots, *made.types.values(), "</xs:schema>"]) + "\n"

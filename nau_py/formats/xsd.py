"""XSD 1.0 of the XML form, for editors.

Derived from the description of each class (:mod:`nau_py.model.schema`). It restricts the place of
elements and attributes; lint checks references and ranges.
"""

from __future__ import annotations

from collections.abc import Iterator
from xml.sax.saxutils import quoteattr

from nau_py.formats.settings import list_keys
from nau_py.model.attribute import Attribute
from nau_py.model.attributes import Registry
from nau_py.model.library import MaterialLibrary
from nau_py.model.node import Node
from nau_py.model.project import ProjectFile
from nau_py.model.schema import AttributeField, ChildField, NodeSchema, schema_of

_HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n<xs:schema xmlns:xs="{}">'
_XS = "http://www.w3.org/2001/XMLSchema"


class _Types:
    """Complex types of every class reached so far, as text."""

    def __init__(self, registry: Registry) -> None:
        self.registry = registry
        self.types: dict[str, str] = {}

    def define(self, cls: type[Node]) -> str:
        """Define the type of a class, if it is new, and return its name."""
        name = cls.__name__
        if name not in self.types:
            self.types[name] = ""
            self.types[name] = self._type(name, [schema_of(cls)])
        return name

    def union(self, classes: list[type[Node]]) -> str:
        """Define one type for several classes: XSD cannot choose by an attribute."""
        unique = list(dict.fromkeys(classes))
        if len(unique) == 1:
            return self.define(unique[0])
        name = "Or".join(c.__name__ for c in unique)
        if name not in self.types:
            self.types[name] = ""
            self.types[name] = self._type(name, [schema_of(cls) for cls in unique])
        return name

    def _type(self, name: str, schemas: list[NodeSchema]) -> str:
        attributes: dict[str, str] = {}
        elements: dict[str, str] = {}
        single: dict[str, list[type[Node]]] = {}
        for schema in schemas:
            for attribute in schema.attributes:
                attributes.setdefault(attribute.name, self._attribute(attribute))
            listed = schema.each_content(
                lambda part: list(self._listed(part)) if part.many else [],
                lambda part: [
                    (a.name, self._setting(a)) for a in part.known(self.registry) if not a.readonly
                ],
            )
            for tag, text in [pair for pairs in listed for pair in pairs]:
                elements.setdefault(tag, text)
            for part in schema.children:
                if not part.many:
                    single.setdefault(part.tag, []).append(part.cls)
        for tag, found in single.items():
            elements[tag] = _element(tag, self.union(found), schema_of(found[0]).doc)
        open_ = any(s.settings or s.inline for s in schemas)  # a project can add attributes
        parts = [f"<xs:complexType name={quoteattr(name)}>", _documentation(schemas[0].doc)]
        if elements or open_:
            parts.append('<xs:choice minOccurs="0" maxOccurs="unbounded">')
            parts += elements.values()
            parts.append("</xs:choice>")
        parts += attributes.values()
        if open_:
            parts.append('<xs:anyAttribute processContents="skip"/>')
        return "\n".join([*parts, "</xs:complexType>"])

    def _attribute(self, attribute: AttributeField) -> str:
        use = ' use="required"' if attribute.required else ""
        head = f"<xs:attribute name={quoteattr(attribute.name)}{use}"
        doc = _documentation(attribute.doc)
        if not attribute.values:
            return f'{head} type="xs:string">{doc}</xs:attribute>'
        return f"{head}>{doc}{_choice(attribute.values)}</xs:attribute>"

    def _listed(self, part: ChildField) -> Iterator[tuple[str, str]]:
        inner = list(self._items(part))
        if not part.wrapper:
            yield from inner
            return
        choice = "".join(text for _, text in inner)
        yield (
            part.wrapper,
            f"<xs:element name={quoteattr(part.wrapper)}>{_documentation(part.doc)}"
            f'<xs:complexType><xs:choice minOccurs="0" maxOccurs="unbounded">{choice}</xs:choice>'
            "</xs:complexType></xs:element>",
        )

    def _items(self, part: ChildField) -> Iterator[tuple[str, str]]:
        if part.mixed:
            for tag, cls in part.classes.items():
                yield tag, _element(tag, self.define(cls), schema_of(cls).doc)
            return
        name = self.union(part.alternatives)
        yield part.tag, _element(part.tag, name, part.doc or schema_of(part.cls).doc)

    def _setting(self, attribute: Attribute) -> str:
        keys = list_keys(attribute)
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
    """Write the XSD of projects and material libraries in clean XML, as nau-fmt writes it."""
    made = _Types(registry)
    roots = [
        _element("project", made.define(ProjectFile), schema_of(ProjectFile).doc),
        _element("materialLib", made.define(MaterialLibrary), schema_of(MaterialLibrary).doc),
    ]
    return "\n".join([_HEAD.format(_XS), *roots, *made.types.values(), "</xs:schema>"]) + "\n"

"""XML text to elements and back."""

from __future__ import annotations

from io import BytesIO
from xml.sax.saxutils import quoteattr

from lxml import etree

from nau_py.diagnostics.location import Location
from nau_py.diagnostics.problem import Problem, ProblemKind
from nau_py.syntax.element import Element
from nau_py.syntax.tolerant import XmlSyntaxError, repair

_INDENT = "  "
_WIDTH = 100


def parse_xml(text: str, file: str, problems: list[Problem]) -> Element:
    """The root element of ``text``, written in Nau's dialect or in clean XML.

    Raises :class:`~nau_py.syntax.tolerant.XmlSyntaxError` where the text has no reading.
    """
    repaired = repair(text, file)
    for where, stray in repaired.stray:
        problems.append(Problem(ProblemKind.STRAY_TEXT, where, value=stray[:60]))
    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, load_dtd=False, remove_blank_text=True
    )
    try:
        root = etree.parse(BytesIO(repaired.text.encode("utf-8")), parser).getroot()
    except etree.XMLSyntaxError as error:
        raise XmlSyntaxError(Location(file, 1, 1), str(error.msg)) from None
    tags = iter(repaired.tags)

    def convert(node: etree._Element) -> Element:
        tag = next(tags)
        element = Element(
            str(node.tag),
            {str(k): str(v) for k, v in node.attrib.items()},
            location=tag.location,
            attribute_locations=tag.attributes,
        )
        element.children = [convert(child) for child in node]
        return element

    return convert(root)


def format_xml(root: Element) -> str:
    """Clean, indented XML."""
    lines = ['<?xml version="1.0" encoding="UTF-8"?>']
    _format(root, 0, lines)
    return "\n".join(lines) + "\n"


def _format(element: Element, depth: int, lines: list[str]) -> None:
    pad = _INDENT * depth
    attributes = [
        f"{name}={quoteattr(value, {chr(10): '&#10;'})}"
        for name, value in element.attributes.items()
    ]
    end = ">" if element.children else " />"
    line = pad + " ".join([f"<{element.tag}", *attributes]) + end
    if len(line) > _WIDTH and len(attributes) > 1:
        hang = "\n" + pad + " " * (len(element.tag) + 2)
        line = pad + f"<{element.tag} " + hang.join(attributes) + end
    lines.append(line)
    for child in element.children:
        _format(child, depth + 1, lines)
    if element.children:
        lines.append(f"{pad}</{element.tag}>")

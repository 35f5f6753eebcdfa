"""The reader of Nau's XML dialect: each deviation from XML 1.0 in docs/format.md 1.1, and its errors."""

from __future__ import annotations

import pytest

from nau_py.diagnostics.problem import Problem
from nau_py.syntax.element import Element
from nau_py.syntax.parse_error import ParseError
from nau_py.syntax.xml import format_xml, parse_xml


def parse(text: str) -> Element:
    return parse_xml(text, "f.xml", [])


@pytest.mark.parametrize(
    "text, attributes",
    [
        ("<a width=512/>", {"width": "512"}),
        ("<a dimX=256, />", {"dimX": "256,"}),
        ("<a  x = '1'\n y\t=\t2 />", {"x": "1", "y": "2"}),
        ("<a x='1'y='2'/>", {"x": "1", "y": "2"}),
        ("<a t='a & b < c &unknown; &amp; &#65; &lt;'/>", {"t": "a & b < c &unknown; & A <"}),
        ("<a t='say \"hi\"'/>", {"t": 'say "hi"'}),
        ("\n\n<?xml version='1.0' ?><a x=1/>", {"x": "1"}),
        ("\ufeff<a x=1/>", {"x": "1"}),
        ("<!DOCTYPE a><a x=1/>junk after the root <", {"x": "1"}),
        ("<!-- a -- b ---><a x=1/>", {"x": "1"}),
        ("<a p:x=1 xmlns:p='u'/>", {"p:x": "1", "xmlns:p": "u"}),
        ("<a t='&#99999999999;&#1;&#xD800;'/>", {"t": "&#99999999999;&#1;&#xD800;"}),
    ],
)
def test_dialect(text: str, attributes: dict[str, str]) -> None:
    assert parse(text).attributes == attributes


def test_positions_are_those_of_the_text() -> None:
    root = parse("<a>\n  <!-- x\n -- y -->  <b one=1\n     two='2'/>\n</a>")
    (b,) = root.children
    assert (b.location.line, b.location.column) == (3, 12)
    assert (b.where("one").line, b.where("one").column) == (3, 19)
    assert (b.where("two").line, b.where("two").column) == (4, 11)


def test_stray_text_is_reported_where_it_stands() -> None:
    problems: list[Problem] = []
    parse_xml("<a>\n  ue <b/></a>", "f.xml", problems)
    assert [(p.value, p.location.line, p.location.column) for p in problems] == [("ue", 2, 3)]


@pytest.mark.parametrize(
    "text, message",
    [
        ("", "f.xml:1:1: the document is empty: it has no root element"),
        ("words <a/>", "f.xml:1:1: text before the root element: 'words'"),
        ("<a>\n<b>\n</a>", "f.xml:3:1: end tag </a> does not match: <b> from f.xml:2:1 is open"),
        ("<a>\n<b/>", "f.xml:1:1: element <a> is not closed: no </a> follows"),
        ("<a x=1 x=2/>", "f.xml:1:8: attribute 'x' of <a> is given twice"),
        ("<a x/>", "f.xml:1:4: attribute 'x' of <a> has no value ('=' expected)"),
        ("<a x='1/>", "f.xml:1:6: value of attribute 'x' of <a> has no closing '"),
        ("<a x=1'2/>", "f.xml:1:6: value of attribute 'x' of <a> has a quote inside: 1'2"),
        ("<a <b/>", "f.xml:1:4: attribute name in <a> expected, found '<b/>'"),
        ("<a><!-- open</a>", "f.xml:1:8: the comment is not closed: no '-->' follows"),
        ("<a", "f.xml:1:1: start tag <a is not closed: no '>' follows"),
        ("<a>\n</a\n<b>", "f.xml:2:4: end tag </a is not closed: no '>' follows"),
        ("<a><! b", "f.xml:1:4: the declaration is not closed: no '>' follows"),
        ("<½/>", "f.xml:1:2: element name expected, found '½/>'"),
        (
            "<a\n  x='1\x012'/>",
            "f.xml:2:7: value of attribute 'x' of <a> has a character that XML forbids: U+0001",
        ),
        ("<a>" * 257 + "</a>" * 257, "f.xml:1:769: elements are nested too deeply"),
    ],
)
def test_syntax_errors_name_the_place(text: str, message: str) -> None:
    with pytest.raises(ParseError) as caught:
        parse(text)
    assert str(caught.value) == message


def test_written_xml_reads_back() -> None:
    root = Element("a", {"t": 'q"<&>\n', "long": "x" * 60, "more": "y" * 60}, [Element("b")])
    assert parse(format_xml(root)) == root


def test_no_document_type_brings_entities() -> None:
    with pytest.raises(ParseError, match="text before the root element"):
        parse('<!DOCTYPE a [<!ENTITY e SYSTEM "file:///etc/passwd">]><a x="&e;"/>')
    assert parse('<!DOCTYPE a SYSTEM "x"><a x="&e;"/>').attributes == {"x": "&e;"}

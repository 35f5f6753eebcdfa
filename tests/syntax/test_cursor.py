"""``xml_cursor`` and ``yaml_cursor`` on half-written texts; ``|`` marks the cursor."""

from __future__ import annotations

import pytest

from nau_py.syntax.cursor import Cursor, CursorKind
from nau_py.syntax.xml_cursor import locate_xml_cursor
from nau_py.syntax.yaml_cursor import locate_yaml_cursor


def describe(cursor: Cursor, text: str) -> tuple[CursorKind, str, str, str]:
    path = "/".join(step.tag for step in cursor.path)
    return cursor.kind, path, cursor.name, text[cursor.begin : cursor.end]


@pytest.mark.parametrize(
    "marked, wanted",
    [
        ("<a>|</a>", (CursorKind.CHILD, "a", "", "")),
        ("<a><b|", (CursorKind.CHILD, "a", "", "b")),
        ("<a><|b/></a>", (CursorKind.CHILD, "a", "", "b")),
        ("<a><b |", (CursorKind.ATTRIBUTE, "a/b", "", "")),
        ("<a><b na|me='x' c='y'>", (CursorKind.ATTRIBUTE, "a/b", "", "name")),
        ("<a><b name='|", (CursorKind.VALUE, "a/b", "name", "")),
        ("<a><b name='x|y'/>", (CursorKind.VALUE, "a/b", "name", "xy")),
        ("<a><b name=x|y />", (CursorKind.VALUE, "a/b", "name", "xy")),
        ('<a><b n="a > b" c="|"/>', (CursorKind.VALUE, "a/b", "c", "")),
        ("<a><b/>|<c/></a>", (CursorKind.CHILD, "a", "", "")),
        ("<a><b></b><c>|", (CursorKind.CHILD, "a/c", "", "")),
        ("<a><b><c>|</b></a>", (CursorKind.CHILD, "a/b/c", "", "")),
        ("<a><b></|", (CursorKind.END, "a/b", "", "")),
        ("<a><b name= |", (CursorKind.VALUE, "a/b", "name", "")),
        ("<a><b name=|<c/>", (CursorKind.VALUE, "a/b", "name", "")),
        ("<a><b name='x|<c d='1'/>", (CursorKind.VALUE, "a/b", "name", "x")),
        ("<a><b name='x'|", (CursorKind.ATTRIBUTE, "a/b", "", "")),
        ("<a></b <c |", (CursorKind.ATTRIBUTE, "a/c", "", "")),
        ("<a><!-- <b> | -->", (CursorKind.END, "a", "", "")),
        ("|", (CursorKind.CHILD, "", "", "")),
    ],
)
def test_xml(marked: str, wanted: tuple[CursorKind, str, str, str]) -> None:
    offset = marked.index("|")
    text = marked.replace("|", "", 1)
    assert describe(locate_xml_cursor(text, offset), text) == wanted


@pytest.mark.parametrize(
    "marked, wanted",
    [
        ("na|", (CursorKind.KEY, "", "", "na")),
        ("a:\n  |", (CursorKind.KEY, "a", "", "")),
        ("a:\n  b: x|", (CursorKind.VALUE, "a", "b", "x")),
        ("a:\n  - n: x\n    |c: 1\n", (CursorKind.KEY, "a/-", "", "c")),
        ("a:\n  - n: x\n  - m|", (CursorKind.KEY, "a/-", "", "m")),
        ("a:\n  - n: x\n    b:\n      - p: q\n    d: |", (CursorKind.VALUE, "a/-", "d", "")),
        ("a:\n  b: {x: 1, y|", (CursorKind.KEY, "a/b", "", "y")),
        ("a:\n  b: {x: 1, y: 2|}", (CursorKind.VALUE, "a/b", "y", "2")),
        ("a:\n  b: [p, q|", (CursorKind.VALUE, "a", "b", "q")),
        ("a:\n- b: |", (CursorKind.VALUE, "a/-", "b", "")),
        ("a:\n  b: 'x|'", (CursorKind.VALUE, "a", "b", "x")),
        ("a:\n  b: 1\nc:\n  |", (CursorKind.KEY, "c", "", "")),
        ("a:\n  # b|", (CursorKind.END, "", "", "")),
        ("a:\n  - - b: |", (CursorKind.VALUE, "a/-/-", "b", "")),
    ],
)
def test_yaml(marked: str, wanted: tuple[CursorKind, str, str, str]) -> None:
    offset = marked.index("|")
    text = marked.replace("|", "", 1)
    assert describe(locate_yaml_cursor(text, offset), text) == wanted


def test_siblings_are_known_above_and_below() -> None:
    text = "p:\n  - name: x\n    kind: \n    class: quad\n  - class: other\n"
    cursor = locate_yaml_cursor(text, text.index("kind: ") + 6)
    assert cursor.path[-1].attributes == {"name": "x", "kind": "", "class": "quad"}

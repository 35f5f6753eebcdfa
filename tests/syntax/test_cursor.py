"""Where a cursor stands in texts that are half written; ``|`` marks it."""

from __future__ import annotations

import pytest

import nau_py.syntax.yaml_cursor as in_yaml
from nau_py.syntax.xml_cursor import Cursor, Kind, cursor_at


def told(cursor: Cursor, text: str) -> tuple[Kind, str, str, str]:
    path = "/".join(step.tag for step in cursor.path)
    return cursor.kind, path, cursor.name, text[cursor.begin : cursor.end]


@pytest.mark.parametrize(
    "marked, wanted",
    [
        ("<a>|</a>", (Kind.CHILD, "a", "", "")),
        ("<a><b|", (Kind.CHILD, "a", "", "b")),
        ("<a><|b/></a>", (Kind.CHILD, "a", "", "b")),
        ("<a><b |", (Kind.ATTRIBUTE, "a/b", "", "")),
        ("<a><b na|me='x' c='y'>", (Kind.ATTRIBUTE, "a/b", "", "name")),
        ("<a><b name='|", (Kind.VALUE, "a/b", "name", "")),
        ("<a><b name='x|y'/>", (Kind.VALUE, "a/b", "name", "xy")),
        ("<a><b name=x|y />", (Kind.VALUE, "a/b", "name", "xy")),
        ('<a><b n="a > b" c="|"/>', (Kind.VALUE, "a/b", "c", "")),
        ("<a><b/>|<c/></a>", (Kind.CHILD, "a", "", "")),
        ("<a><b></b><c>|", (Kind.CHILD, "a/c", "", "")),
        ("<a><b><c>|</b></a>", (Kind.CHILD, "a/b/c", "", "")),
        ("<a><b></|", (Kind.END, "a/b", "", "")),
        ("<a><!-- <b> | -->", (Kind.END, "a", "", "")),
        ("|", (Kind.CHILD, "", "", "")),
    ],
)
def test_xml(marked: str, wanted: tuple[Kind, str, str, str]) -> None:
    offset = marked.index("|")
    text = marked.replace("|", "", 1)
    assert told(cursor_at(text, offset), text) == wanted


@pytest.mark.parametrize(
    "marked, wanted",
    [
        ("na|", (Kind.KEY, "", "", "na")),
        ("a:\n  |", (Kind.KEY, "a", "", "")),
        ("a:\n  b: x|", (Kind.VALUE, "a", "b", "x")),
        ("a:\n  - n: x\n    |c: 1\n", (Kind.KEY, "a/-", "", "c")),
        ("a:\n  - n: x\n  - m|", (Kind.KEY, "a/-", "", "m")),
        ("a:\n  - n: x\n    b:\n      - p: q\n    d: |", (Kind.VALUE, "a/-", "d", "")),
        ("a:\n  b: {x: 1, y|", (Kind.KEY, "a/b", "", "y")),
        ("a:\n  b: {x: 1, y: 2|}", (Kind.VALUE, "a/b", "y", "2")),
        ("a:\n  b: [p, q|", (Kind.VALUE, "a", "b", "q")),
        ("a:\n- b: |", (Kind.VALUE, "a/-", "b", "")),
        ("a:\n  b: 'x|'", (Kind.VALUE, "a", "b", "x")),
        ("a:\n  b: 1\nc:\n  |", (Kind.KEY, "c", "", "")),
        ("a:\n  # b|", (Kind.END, "", "", "")),
        ("a:\n  - - b: |", (Kind.VALUE, "a/-/-", "b", "")),
    ],
)
def test_yaml(marked: str, wanted: tuple[Kind, str, str, str]) -> None:
    offset = marked.index("|")
    text = marked.replace("|", "", 1)
    assert told(in_yaml.cursor_at(text, offset), text) == wanted


def test_siblings_are_known_above_and_below() -> None:
    text = "p:\n  - name: x\n    kind: \n    class: quad\n  - class: other\n"
    cursor = in_yaml.cursor_at(text, text.index("kind: ") + 6)
    assert cursor.path[-1].attributes == {"name": "x", "kind": "", "class": "quad"}

"""``edit``, ``xml_document`` and ``yaml_document``: edits, and the text around them that stays."""

from __future__ import annotations

import difflib
from pathlib import Path

import pytest

import nau_py
from nau_py.diagnostics.diagnostic import Change, Part
from nau_py.diagnostics.location import Location
from nau_py.syntax.document import Document, apply_edits
from nau_py.syntax.edit import make_document, plan_fixes, read_document

XYZ = [("x", "r"), ("y", "g"), ("z", "b")]


def document_of(text: str, yaml: bool = False) -> Document:
    return make_document(Path("f.yaml" if yaml else "f.xml"), text)


def change(text: str, at: str, part: Part, old: str, new: str, yaml: bool = False) -> str:
    """``text`` with the change at the first place of ``at``."""
    place = text.index(at)
    line = text.count("\n", 0, place) + 1
    where = Location("f", line, place - (text.rfind("\n", 0, place) + 1) + 1)
    document = document_of(text, yaml)
    assert document.offset(where) == place
    return apply_edits(text, document.make_change(Change(where, part, old, new)))


@pytest.mark.parametrize(
    "text, at, part, old, new, wanted",
    [
        ("<a b='x' c='x'/>", "x' c", Part.VALUE, "x", "y", "<a b='y' c='x'/>"),
        ("<a b=x c='x'/>", "x c", Part.VALUE, "x", "y", "<a b=y c='x'/>"),
        ("<a b='L::x'/>", "L::", Part.VALUE, "x", "y", "<a b='L::y'/>"),
        ("<F value='LES'/>", "<F", Part.VALUE, "LES", "LESS", "<F value='LESS'/>"),
        ("<a b='p&amp;q'/>", "p&amp", Part.VALUE, "p&q", "r<", "<a b='r&lt;'/>"),
        ("<a b='xx'/>", "xx", Part.VALUE, "x", "y", "<a b='xx'/>"),  # a part of a word
        ("<t><u/></t>", "<t", Part.ELEMENT, "t", "new", "<new><u/></new>"),
        ("<t><t/><!-- </t> --></t>", "<t", Part.ELEMENT, "t", "n", "<n><t/><!-- </t> --></n>"),
        ("<t a='>'/><t></t>", "<t", Part.ELEMENT, "t", "n", "<n a='>'/><t></t>"),
        ("<a widht='5' c='1'>", "5", Part.ATTRIBUTE, "widht", "width", "<a width='5' c='1'>"),
        ("<a\n  u='5'\n  c='1'>", "5", Part.ATTRIBUTE, "u", "", "<a\n  c='1'>"),
        ("<a u=5 c='1'>", "5", Part.ATTRIBUTE, "u", "", "<a c='1'>"),
        ("<a v='5'>", "5", Part.ATTRIBUTE, "u", "w", "<a v='5'>"),  # not what the change says
        ("<a f=b\\C c=1>", "b", Part.VALUE, "b\\C", "b/c", '<a f="b/c" c=1>'),  # needs quotes now
    ],
)
def test_xml(text: str, at: str, part: Part, old: str, new: str, wanted: str) -> None:
    assert change(text, at, part, old, new) == wanted


@pytest.mark.parametrize(
    "text, at, part, old, new, wanted",
    [
        ("a: x  # x\nb: x\n", "x", Part.VALUE, "x", "y", "a: y  # x\nb: x\n"),
        ("a:\n  widht: 5 # w\n", "5", Part.ATTRIBUTE, "widht", "width", "a:\n  width: 5 # w\n"),
        ("a:\n  u: 5\n  b: 1\n", "5", Part.ATTRIBUTE, "u", "", "a:\n  b: 1\n"),
        ("a: {u: 5, b: 1}\n", "5", Part.ATTRIBUTE, "u", "", "a: {b: 1}\n"),
        ("a: {b: 1, u: 5}\n", "5", Part.ATTRIBUTE, "u", "", "a: {b: 1}\n"),
        ("- u: 5\n  b: 1\n", "5", Part.ATTRIBUTE, "u", "", "- u: 5\n  b: 1\n"),
        ("a: '# x'  # x\n", "'#", Part.VALUE, "x", "y", "a: '# y'  # x\n"),
        ("a:\n  u: 'p\n    q'\n  b: 1\n", "'p", Part.ATTRIBUTE, "u", "", "a:\n  b: 1\n"),
        ("a: [x\n", "x", Part.VALUE, "x", "y", "a: [x\n"),  # no YAML
        ("pasess:\n  - x\n", "pasess", Part.ELEMENT, "pasess", "passes", "passes:\n  - x\n"),
    ],
)
def test_yaml(text: str, at: str, part: Part, old: str, new: str, wanted: str) -> None:
    assert change(text, at, part, old, new, yaml=True) == wanted


def test_settings_change_by_component() -> None:
    text = "<l>\n  <P y='2'\tx='1.0' z='3'/> <!-- x -->\n</l>\n"
    made = apply_edits(text, document_of(text).set_components(text.index("<P"), XYZ, "179"))
    assert made == "<l>\n  <P y='7'\tx='1.0' z='9'/> <!-- x -->\n</l>\n"
    for before, after in (
        ("P: [1, 2, 3]  # here\n", "P: [1, 7, 9]  # here\n"),
        ("P: [1, 2]  # short\n", "P: [1, 7, 9]  # short\n"),
        ("P:\n  x: 1\n  y: 2\nQ: 2\n", "P:\n  x: 1\n  y: 7\n  z: 9\nQ: 2\n"),
        ("P:\n  - 1\n  - 2\nQ: 2\n", "P:\n  - 1\n  - 7\n  - 9\nQ: 2\n"),
        ("P: {'x': 1, y: \"2\", z: 3}\n", "P: {'x': 1, y: \"7\", z: 9}\n"),
        ("P: {z: 3, x: 1, y: 2}\n", "P: {z: 9, x: 1, y: 7}\n"),
        ("P:\n  - 1\n  - 2\n  - 3\nQ: 2\n", "P:\n  - 1\n  - 7\n  - 9\nQ: 2\n"),
        ("P:\n  x: 1\n  y: 2\n  z: 3\nQ: 2\n", "P:\n  x: 1\n  y: 7\n  z: 9\nQ: 2\n"),
    ):
        assert apply_edits(before, document_of(before, True).set_components(0, XYZ, "179")) == after


def test_what_is_missing_is_added() -> None:
    for text, wanted in (
        ("<a>\n  <l n='S' />\n</a>", "<a>\n  <l n='S'>\n    <P x=\"1\" />\n  </l>\n</a>"),
        ('<a>\n    <P x="1" />\n    <b/>\n</a>', ""),
    ):
        begin = text.index("<l") if wanted else 0
        source = text if wanted else "<a>\n    <b/>\n</a>"
        made = apply_edits(source, document_of(source).add_setting(begin, "P", ["x"], ["1"]))
        assert made == (wanted or text)
    text = "lights:\n  - name: Sun\n    ENABLED: true\n"
    made = apply_edits(
        text, document_of(text, True).add_setting(text.index("name"), "P", ["x", "y"], "12")
    )
    assert made == "lights:\n  - name: Sun\n    P: [1, 2]\n    ENABLED: true\n"
    text = "<a b='1'  />"
    assert apply_edits(text, document_of(text).set_attribute(0, "c", "2")) == "<a b='1' c=\"2\"  />"


@pytest.mark.parametrize(
    "text, at, wanted",
    [
        ("a: 1\nb:\n", "1", "a: 5\nb:\n"),
        ("a:\nb: 1\n", "b", "a:\nb: 1\n"),  # ruamel.yaml has the missing value here
        ("a: [1, '2']\n", "'2", "a: [1, '5']\n"),
        ("a: |\n  1\n", "|", "a: |\n  1\n"),
    ],
)
def test_yaml_values_are_exchanged(text: str, at: str, wanted: str) -> None:
    edits = document_of(text, True).set_value(text.index(at), "5")
    assert apply_edits(text, edits) == wanted


@pytest.mark.parametrize(
    "text, at, wanted",
    [
        ("l:\n  - {n: S}\n", "{", "l:\n  - {k: 5, n: S}\n"),
        ("l:\n  - S\n", "S", "l:\n  - S\n"),  # a scalar takes no key
        ("l:\n  - n: S\n", "l", "l:\n  - n: S\n"),  # neither does a list
        ("c: {}\n", "c", "c: {k: 5}\n"),
        ("c: {k: }\n", "c", "c: {k: }\n"),
        ("c: {k: 1}\n", "c", "c: {k: 5}\n"),
        ("c: # x\n  n: S\n", "c", "c: # x\n  k: 5\n  n: S\n"),
        ("l:\r\n- n: S\r\n", "n", "l:\r\n- n: S\r\n  k: 5\r\n"),
    ],
)
def test_yaml_keys_are_added(text: str, at: str, wanted: str) -> None:
    edits = document_of(text, True).set_attribute(text.index(at), "k", "5")
    assert apply_edits(text, edits) == wanted


def test_encoding_and_line_ends_stay(tmp_path: Path) -> None:
    file = tmp_path / "p.xml"
    raw = "<a n='é'>\r\n  <b v='1'/>\r\n</a>\r\n".encode("latin-1")
    file.write_bytes(raw)
    document = read_document(file)
    where = Location(str(file), 2, 3)
    document.write(file, document.make_change(Change(where, Part.VALUE, "1", "2")))
    assert file.read_bytes() == raw.replace(b"'1'", b"'2'")


BAD = """\
<project name="P">
  <!-- kept: every blank of it -->
  <assets>
    <scenes><scene   name="S"><geometry name="g" type="SQUARE"/></scene></scenes>
    <cameras><camera name='C' colour="red"><projection FOV="60.0.0"/></camera></cameras>
    <materialLibs><materialLib filename="libs\\L.MLIB"/></materialLibs>
  </assets>
  <pipelines default="Q"><pipeline name="Q">
    <pass name="p" class="defualt"><camera name="C"/><scenes><scene name="S"/></scenes></pass>
  </pipeline></pipelines>
</project>
"""


def test_every_fix_of_lint_mends_its_finding(tmp_path: Path) -> None:
    """Safe ones change the lines of their findings; the guess for the class is the right word."""
    (tmp_path / "libs").mkdir()
    (tmp_path / "libs" / "l.mlib").write_text('<materialLib name="L"></materialLib>')
    file = tmp_path / "project.xml"
    file.write_text(BAD)
    found = nau_py.lint(nau_py.load(file))
    assert sorted(d.rule for d in found) == ["F002", "F003", "P001", "S003", "V002"]
    files, made = plan_fixes(f for d in found for f in d.fixes if f.safe)
    assert len(made) == 3
    files[file][0].write(file, files[file][1])
    left = nau_py.lint(nau_py.load(file))
    assert [d.rule for d in left] == ["P001"]
    assert [f.safe for f in left[0].fixes] == [False]
    files, _ = plan_fixes(left[0].fixes)
    files[file][0].write(file, files[file][1])
    assert nau_py.lint(nau_py.load(file)) == []
    lines = [
        line[2:]
        for line in difflib.ndiff(BAD.splitlines(), file.read_text().splitlines())
        if line.startswith("+ ")
    ]
    assert lines == [
        "    <cameras><camera name='C'><projection FOV=\"60\"/></camera></cameras>",
        '    <materialLibs><materialLib filename="libs/l.mlib"/></materialLibs>',
        '    <pass name="p" class="default"><camera name="C"/><scenes><scene name="S"/></scenes></pass>',
    ]

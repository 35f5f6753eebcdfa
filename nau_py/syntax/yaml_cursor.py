"""Find what is written at a cursor in YAML, by indentation: half-written text is allowed."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from nau_py.syntax.cursor import ITEM, Cursor, CursorKind, CursorStep

_LINE = re.compile(r"(?P<blank>[ ]*)(?P<dashes>(?:-[ ]+)*)(?P<rest>.*)$")
_KEY = re.compile(r"(?P<key>[^\s:#,{}\[\]\"'][^:#,{}\[\]]*?)[ ]*:(?:[ ]+|$)")
_FLOW_ENTRY = re.compile(r"([^\s:,{}\[\]]+)\s*:\s*([^,{}\[\]]*)")
_DASH = re.compile(r"-[ ]+")
_WORD_REST = re.compile(r"[^\s,:#\]}\"']*")


@dataclass(frozen=True, slots=True)
class _Line:
    """A line of block style: the columns of its dashes, and the column of the rest."""

    dashes: tuple[int, ...]
    column: int
    key: str
    """The key that the rest begins with; empty for none."""
    rest: str
    rest_begin: int
    """The index in ``rest`` of the value behind the key; 0 for a line without a key."""

    @property
    def value(self) -> str:
        """The scalar behind the key, without comment and quotes."""
        _, _, value = self.rest.partition(":")
        return value.split(" #")[0].strip().strip("\"'")

    @property
    def is_blank(self) -> bool:
        """Report if there is nothing but a comment."""
        empty = not self.rest.strip() or self.rest.startswith("#")
        return empty and not self.dashes


def _scan_line(text: str) -> _Line:
    found = _LINE.match(text)
    assert found is not None  # it matches every line
    begin = len(found["blank"])
    dashes = tuple(begin + dash.start() for dash in _DASH.finditer(found["dashes"]))
    key = _KEY.match(found["rest"])
    return _Line(
        dashes,
        begin + len(found["dashes"]),
        key["key"] if key else "",
        found["rest"],
        key.end() if key else 0,
    )


def _scan_lines(lines: Iterable[str]) -> Iterator[_Line]:
    for text in lines:
        line = _scan_line(text)
        if not line.is_blank:
            yield line


def locate_yaml_cursor(text: str, offset: int) -> Cursor:
    """Return the cursor before the character at ``offset``."""
    begin = text.rfind("\n", 0, offset) + 1
    end = text.find("\n", offset)
    whole = text[begin : len(text) if end < 0 else end]
    before = whole[: offset - begin]
    if " #" in before or before.lstrip().startswith("#"):
        return Cursor(CursorKind.END, (), "", offset, offset)
    line = _scan_line(before)
    above = text[:begin].split("\n")[:-1] if begin else []
    below = text[begin + len(whole) + 1 :].split("\n")
    path = _find_path(above, below, line, _scan_line(whole))
    written = line.rest[line.rest_begin :]
    if not line.key:
        return _make_cursor(CursorKind.KEY, path, "", text, offset, line.rest)
    if "{" in written or line.rest.startswith("{"):
        return _locate_in_flow(path, line.key, written, text, offset)
    return _make_cursor(CursorKind.VALUE, path, line.key, text, offset, written)


def _make_cursor(
    kind: CursorKind,
    path: tuple[CursorStep, ...],
    name: str,
    text: str,
    offset: int,
    written: str,
) -> Cursor:
    """Return the cursor in the last word of ``written``, the text up to ``offset``."""
    word = written.lstrip("\"' [")
    word = word[max(word.rfind(","), word.rfind("{")) + 1 :].lstrip()
    rest = _WORD_REST.match(text, offset)
    return Cursor(kind, path, name, offset - len(word), rest.end() if rest else offset)


def _locate_in_flow(
    path: tuple[CursorStep, ...], key: str, written: str, text: str, offset: int
) -> Cursor:
    """Return the cursor inside of ``key: {a: 1, ...``."""
    inside = written[written.index("{") + 1 :]
    pairs = {m[1]: m[2].strip() for m in _FLOW_ENTRY.finditer(inside)}
    here = (*path, CursorStep(key, pairs))
    last = inside[inside.rfind(",") + 1 :]
    name, colon, value = last.partition(":")
    if colon:
        return _make_cursor(CursorKind.VALUE, here, name.strip(), text, offset, value)
    return _make_cursor(CursorKind.KEY, here, "", text, offset, last)


def _find_path(
    above: list[str], below: list[str], before: _Line, whole: _Line
) -> tuple[CursorStep, ...]:
    """Return the steps from the root to the map that holds the cursor's line.

    ``before`` is the line up to the cursor, ``whole`` all of it.
    """
    steps: list[CursorStep] = []
    column = before.column
    attributes = {whole.key: whole.value} if whole.key else {}
    attributes |= _siblings_below(below, column)
    for dash in reversed(before.dashes):
        steps.append(CursorStep(ITEM, attributes))
        column, attributes = dash, {}
    for line in _scan_lines(reversed(above)):
        if line.column == column and not line.dashes:
            if line.key and steps and steps[-1].tag == ITEM:  # a list may not be indented
                steps.append(CursorStep(line.key, attributes))
                attributes = {}
            elif line.key:
                attributes.setdefault(line.key, line.value)
            continue
        if line.column == column:  # the first line of the item that the cursor is in
            if line.key:
                attributes.setdefault(line.key, line.value)
            for dash in reversed(line.dashes):
                steps.append(CursorStep(ITEM, attributes))
                column, attributes = dash, {}
            continue
        if line.column < column and line.key:
            steps.append(CursorStep(line.key, attributes))
            column, attributes = line.column, {line.key: ""}
            for dash in reversed(line.dashes):
                steps.append(CursorStep(ITEM, attributes))
                column, attributes = dash, {}
        elif line.dashes and line.dashes[0] == column:
            continue  # another item of the same list
        if column == 0 and steps and steps[-1].tag != ITEM:
            break
    return tuple(reversed(steps))


def _siblings_below(below: list[str], column: int) -> dict[str, str]:
    """Return the keys of the same map in the lines below."""
    found: dict[str, str] = {}
    for line in _scan_lines(below):
        first = line.dashes[0] if line.dashes else line.column
        if first < column or (line.dashes and first <= column):
            break
        if line.column == column and line.key:
            found.setdefault(line.key, line.value)
    return found

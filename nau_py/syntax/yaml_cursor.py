"""Where in a YAML text a cursor stands: by indentation, so that half-written texts work."""

from __future__ import annotations

import re
from dataclasses import dataclass

from nau_py.syntax.cursor import ITEM, Cursor, CursorKind, Step

_LINE = re.compile(r"(?P<blank>[ ]*)(?P<dashes>(?:-[ ]+)*)(?P<rest>.*)$")
_KEY = re.compile(r"(?P<key>[^\s:#,{}\[\]\"'][^:#,{}\[\]]*?)[ ]*:(?:[ ]+|$)")
_FLOW = re.compile(r"([^\s:,{}\[\]]+)\s*:\s*([^,{}\[\]]*)")


@dataclass(frozen=True, slots=True)
class _Line:
    indents: tuple[int, ...]
    """Columns of its dashes, then of what follows them."""
    key: str
    rest: str

    @property
    def column(self) -> int:
        return self.indents[-1]


def _line(text: str) -> _Line | None:
    found = _LINE.match(text)
    if found is None:
        return None
    empty = not found["rest"].strip() or found["rest"].startswith("#")
    if empty and not found["dashes"].strip():
        return None
    column = len(found["blank"])
    indents = []
    for dash in re.finditer(r"-[ ]+", found["dashes"]):
        indents.append(column + dash.start())
    indents.append(column + len(found["dashes"]))
    key = _KEY.match(found["rest"])
    return _Line(tuple(indents), key["key"] if key else "", found["rest"])


def locate_yaml_cursor(text: str, offset: int) -> Cursor:
    """The cursor before the character at ``offset``."""
    begin = text.rfind("\n", 0, offset) + 1
    end = text.find("\n", offset)
    whole = text[begin : len(text) if end < 0 else end]
    before = whole[: offset - begin]
    if " #" in before or before.lstrip().startswith("#"):
        return Cursor(CursorKind.END, (), "", offset, offset)
    lines = text[:begin].split("\n")[:-1] if begin else []
    after = text[begin + len(whole) + 1 :].split("\n")
    shape = _LINE.match(before)
    assert shape is not None  # it matches every line
    blank, dashes, rest = shape["blank"], shape["dashes"], shape["rest"]
    column = len(blank) + len(dashes)
    dash_columns = tuple(len(blank) + m.start() for m in re.finditer(r"-[ ]+", dashes))
    path = _above(lines, after, (*dash_columns, column), before, whole)
    key = _KEY.match(rest)
    if key is None:
        return _word(CursorKind.KEY, path, "", text, offset, rest)
    if "{" in rest[key.end() :] or rest.startswith("{"):
        return _flow(path, key["key"], rest[key.end() :], text, offset)
    return _word(CursorKind.VALUE, path, key["key"], text, offset, rest[key.end() :])


def _word(
    kind: CursorKind, path: tuple[Step, ...], name: str, text: str, offset: int, written: str
) -> Cursor:
    word = written.lstrip("\"' [")
    word = word[max(word.rfind(","), word.rfind("{")) + 1 :].lstrip()
    found = re.compile(r"[^\s,:#\]}\"']*").match(text, offset)
    return Cursor(kind, path, name, offset - len(word), found.end() if found else offset)


def _flow(path: tuple[Step, ...], key: str, rest: str, text: str, offset: int) -> Cursor:
    """Inside ``key: {a: 1, …``."""
    inside = rest[rest.index("{") + 1 :]
    pairs = {m[1]: m[2].strip() for m in _FLOW.finditer(inside)}
    here = (*path, Step(key, pairs))
    last = inside[inside.rfind(",") + 1 :]
    name, colon, value = last.partition(":")
    if colon:
        return _word(CursorKind.VALUE, here, name.strip(), text, offset, value)
    return _word(CursorKind.KEY, here, "", text, offset, last)


def _above(
    lines: list[str], after: list[str], columns: tuple[int, ...], before: str, whole: str
) -> tuple[Step, ...]:
    """The steps from the root to the map that holds the cursor's line."""
    steps: list[Step] = []
    current = _line(whole)
    siblings = {current.key: _scalar(current.rest)} if current and current.key else {}
    follow = _siblings_below(after, columns[-1])
    wanted = columns[-1]
    pending = list(columns[:-1])  # dashes of the own line
    attributes = siblings | follow
    while pending:
        steps.append(Step(ITEM, attributes))
        wanted, attributes = pending.pop(), {}
    for text in reversed(lines):
        line = _line(text)
        if line is None:
            continue
        if line.column == wanted and len(line.indents) == 1:
            if line.key and steps and steps[-1].tag == ITEM:  # dashes may stand below their key
                steps.append(Step(line.key, attributes))
                attributes = {}
            elif line.key:
                attributes.setdefault(line.key, _scalar(line.rest))
            continue
        if line.column == wanted:  # the first line of the item that the cursor is in
            if line.key:
                attributes.setdefault(line.key, _scalar(line.rest))
            for dash in reversed(line.indents[:-1]):
                steps.append(Step(ITEM, attributes))
                wanted, attributes = dash, {}
            continue
        inner = [i for i in line.indents if i <= wanted]
        if line.column < wanted and line.key:
            steps.append(Step(line.key, attributes))
            wanted, attributes = line.column, {line.key: ""}
            for dash in reversed(line.indents[:-1]):
                steps.append(Step(ITEM, attributes))
                wanted, attributes = dash, {}
        elif inner and inner[0] == wanted and len(line.indents) > 1:
            continue  # another item of the same list
        if wanted == 0 and steps and steps[-1].tag != ITEM:
            break
    return tuple(reversed(steps))


def _siblings_below(after: list[str], column: int) -> dict[str, str]:
    found: dict[str, str] = {}
    for text in after:
        line = _line(text)
        if line is None:
            continue
        first = line.indents[0]
        if first < column or (len(line.indents) > 1 and first <= column):
            break
        if line.column == column and line.key:
            found.setdefault(line.key, _scalar(line.rest))
    return found


def _scalar(rest: str) -> str:
    _, _, value = rest.partition(":")
    return value.split(" #")[0].strip().strip("\"'")

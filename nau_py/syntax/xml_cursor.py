"""Where in an XML text a cursor stands. Works on texts that are half written."""

from __future__ import annotations

import re
from dataclasses import dataclass
from enum import StrEnum

_TOKEN = re.compile(
    r"<!--.*?(?:-->|\Z)|<[!?][^>]*(?:>|\Z)"
    r"|</(?P<end>[\w.:\-]*)[^<>]*(?:>|(?=<)|\Z)"
    r"|<(?P<tag>[\w.:\-]*)(?P<rest>(?:\"[^\"]*(?:\"|\Z)|'[^']*(?:'|\Z)|[^<>\"'])*)(?P<close>>|(?=<)|\Z)",
    re.DOTALL,
)
_PAIR = re.compile(r"([\w.:\-]+)\s*=\s*(?:\"([^\"]*)\"|'([^']*)'|([^\s/>\"']+))")
_OPEN_VALUE = re.compile(r"([\w.:\-]+)\s*=\s*(?:\"([^\"]*)|'([^']*)|([^\s/>\"']*))$")
_WORD = re.compile(r"[\w.:\-]*$")


class Kind(StrEnum):
    """What is written at the cursor."""

    CHILD = "child"
    """An element, or its name."""
    ATTRIBUTE = "attribute"
    VALUE = "value"
    END = "end"
    """The name of an end tag."""
    KEY = "key"
    """A key of a YAML map: attribute or child."""


@dataclass(frozen=True, slots=True)
class Step:
    """One element on the way from the root, with the attributes that are written so far."""

    tag: str
    attributes: dict[str, str]


@dataclass(frozen=True, slots=True)
class Cursor:
    """``path``: the elements around the cursor, outermost first. ``name``: the attribute whose
    value it is. ``begin``, ``end``: the span of the word that is being written."""

    kind: Kind
    path: tuple[Step, ...]
    name: str
    begin: int
    end: int


def cursor_at(text: str, offset: int) -> Cursor:
    """The cursor before the character at ``offset``."""
    path: list[Step] = []
    for token in _TOKEN.finditer(text):
        if token.start() >= offset:
            break
        inside = offset < token.end() or (offset == token.end() and not token.group().endswith(">"))
        if token["end"] is not None:
            if inside:
                begin = token.start() + 2
                return Cursor(Kind.END, tuple(path), "", begin, begin + len(token["end"]))
            _close(path, token["end"])
        elif token["tag"] is not None:
            if inside:
                return _in_tag(text, offset, token, path)
            if not token["rest"].rstrip().endswith("/"):
                path.append(Step(token["tag"], _pairs(token["rest"])))
        elif inside:  # a comment or a declaration
            return Cursor(Kind.END, tuple(path), "", offset, offset)
    return Cursor(Kind.CHILD, tuple(path), "", offset, offset)


def _close(path: list[Step], tag: str) -> None:
    """End the innermost element of that name; what it held open ends with it."""
    for index in range(len(path) - 1, -1, -1):
        if path[index].tag == tag:
            del path[index:]
            return


def _pairs(text: str) -> dict[str, str]:
    return {m[1]: next(g for g in m.groups()[1:] if g is not None) for m in _PAIR.finditer(text)}


def _in_tag(text: str, offset: int, token: re.Match[str], path: list[Step]) -> Cursor:
    begin = token.start() + 1
    if offset <= begin + len(token["tag"]):
        return Cursor(Kind.CHILD, tuple(path), "", begin, begin + len(token["tag"]))
    here = (*path, Step(token["tag"], _pairs(token["rest"])))
    before = text[begin + len(token["tag"]) : offset]
    value = _OPEN_VALUE.search(before)
    if value is not None:
        written = next(g for g in value.groups()[1:] if g is not None)
        first = offset - len(written)
        quote = text[first - 1]
        stop = re.compile(rf"[^{quote}<>\n]*" if quote in "\"'" else r"[^\s/>]*")
        found = stop.match(text, offset)
        return Cursor(Kind.VALUE, here, value[1], first, found.end() if found else offset)
    word = _WORD.search(before)
    first = offset - len(word[0] if word else "")
    after = re.compile(r"[\w.:\-]*").match(text, offset)
    return Cursor(Kind.ATTRIBUTE, here, "", first, after.end() if after else offset)

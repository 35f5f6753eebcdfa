"""Find what is written at a cursor in XML. Half-written text is allowed."""

from __future__ import annotations

import re

from nau_py.syntax.cursor import Cursor, CursorKind, CursorStep
from nau_py.syntax.xml_markup import TokenGroup, split_markup
from nau_py.syntax.xml_tokens import Token, TokenKind

_WORD = re.compile(r"[\w.:\-]*")
_VALUE_REST = {
    '"': re.compile(r"[^\"<>\n]*"),
    "'": re.compile(r"[^'<>\n]*"),
    "": re.compile(r"[^\s/<>]*"),
}
"""The rest of a value by its quote. A value that is not closed yet ends with its line or tag."""


def locate_xml_cursor(text: str, offset: int) -> Cursor:
    """Return the cursor before the character at ``offset``."""
    path: list[CursorStep] = []
    for markup in split_markup(text):
        if markup.begin >= offset:
            break
        inside = offset < markup.end or (offset == markup.end and not markup.closed)
        if markup.kind is TokenKind.END:
            if inside:
                return Cursor(CursorKind.END, tuple(path), "", *markup.name_span)
            _leave(path, markup.name)
        elif markup.kind is TokenKind.START:
            if inside:
                return _locate_in_tag(text, offset, markup, path)
            if not markup.empty:
                path.append(_step(markup))
        elif inside:
            return Cursor(CursorKind.END, tuple(path), "", offset, offset)
    return Cursor(CursorKind.CHILD, tuple(path), "", offset, offset)


def _leave(path: list[CursorStep], tag: str) -> None:
    """End the innermost element of that name, and the elements in it that are still open."""
    for index in range(len(path) - 1, -1, -1):
        if path[index].tag == tag:
            del path[index:]
            return


def _step(markup: TokenGroup) -> CursorStep:
    attributes = markup.attributes().items()
    return CursorStep(markup.name, {n: a.value.value for n, a in attributes if a.value.closed})


def _locate_in_tag(text: str, offset: int, markup: TokenGroup, path: list[CursorStep]) -> Cursor:
    begin, end = markup.name_span
    if offset <= end:
        return Cursor(CursorKind.CHILD, tuple(path), "", begin, end)
    here = (*path, _step(markup))
    before = [token for token in markup.tokens if token.offset < offset]
    last = before[-1]
    name, first = _open_value(before, offset)
    if name:
        quote = last.quote if last.kind is TokenKind.VALUE else ""
        return Cursor(CursorKind.VALUE, here, name, first, _match_end(quote, text, offset))
    first = last.offset if last.kind is TokenKind.NAME else offset
    rest = _WORD.match(text, offset)
    return Cursor(CursorKind.ATTRIBUTE, here, "", first, rest.end() if rest else offset)


def _match_end(quote: str, text: str, offset: int) -> int:
    rest = _VALUE_REST[quote].match(text, offset)
    return rest.end() if rest else offset


def _open_value(before: list[Token], offset: int) -> tuple[str, int]:
    """Return the name of the attribute whose value the last token is, or will be, and the offset
    of the value; an empty name where no value is being written."""
    solid = [token for token in before if token.kind is not TokenKind.SPACE]
    last = solid[-1]
    if last.kind is TokenKind.VALUE:
        ended = last.end < offset or (last.quote and last.closed and last.end == offset)
        if ended or before[-1] is not last:
            return "", offset
        solid.pop()
        first = last.span[0]
    else:
        first = offset
    if len(solid) > 1 and solid[-1].kind is TokenKind.EQUALS and solid[-2].kind is TokenKind.NAME:
        return solid[-2].text, first
    return "", offset

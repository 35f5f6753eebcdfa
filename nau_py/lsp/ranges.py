"""Characters of a text as an editor counts them: offsets and locations become LSP ranges."""

from __future__ import annotations

from lsprotocol import types as lsp
from pygls.workspace import TextDocument

from nau_py.diagnostics.location import Location
from nau_py.syntax.document import find_offset

_ENDS_WORD = " \t\r\n\"'/>"


def make_range(document: TextDocument, begin: int, end: int) -> lsp.Range:
    """Return the range of the characters ``begin`` to ``end``."""
    first, last = _position(document.source, begin), _position(document.source, end)
    codec = document.position_codec
    return codec.range_to_client_units(document.lines, lsp.Range(first, last))


def _position(text: str, offset: int) -> lsp.Position:
    begin = text.rfind("\n", 0, offset) + 1
    return lsp.Position(text.count("\n", 0, offset), offset - begin)


def find_word(document: TextDocument, location: Location) -> lsp.Range:
    """Return the range of the word at a location; at least one character of it."""
    text = document.source
    begin = find_offset(text, location)
    end = begin
    while end < len(text) and text[end] not in _ENDS_WORD:
        end += 1
    return make_range(document, begin, max(end, begin + (begin < len(text))))


def is_overlapping(one: lsp.Range, other: lsp.Range) -> bool:
    """Report if two ranges have a position in common, their ends included."""
    first, last = _pair(one.start), _pair(one.end)
    return first <= _pair(other.end) and _pair(other.start) <= last


def _pair(position: lsp.Position) -> tuple[int, int]:
    return position.line, position.character

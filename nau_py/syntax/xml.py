"""Read Nau's XML dialect into elements, and write elements as clean XML.

The dialect is described in docs/format.md, section 1.1. The reader makes one pass over the tokens
of :mod:`nau_py.syntax.xml_tokens`. It expands no entities but the five of XML and character
references, reads no DOCTYPE, and opens no other file.
"""

from __future__ import annotations

import re
from bisect import bisect_right

from nau_py.diagnostics.location import Location
from nau_py.diagnostics.problem import Problem, ProblemKind
from nau_py.syntax.element import Element
from nau_py.syntax.parse_error import ParseError
from nau_py.syntax.xml_tokens import (
    CLOSE,
    CLOSE_EMPTY,
    EQUALS,
    NAME,
    SPACE,
    VALUE,
    Token,
    TokenKind,
    decode,
    is_name,
    tokenise_groups,
)

_INDENT = "  "
_WIDTH = 100
_MOST_LEVELS = 256
"""Depth at which elements are refused: their tree is walked by recursion."""
_FORBIDDEN = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")
"""Characters that XML 1.0 (production 2, ``Char``) does not allow."""


def parse_xml(text: str, file: str, problems: list[Problem]) -> Element:
    """Read the root element of ``text``, written in Nau's dialect or in clean XML.

    Stray text between tags is ignored and added to ``problems``. Whatever follows the root element
    is ignored, as Nau does. Raises :class:`~nau_py.syntax.parse_error.ParseError` at the first
    place that cannot be read.
    """
    return _Parser(text, file).parse(problems)


class _Parser:
    def __init__(self, text: str, file: str) -> None:
        self.text = text
        self.file = file
        self.lines = [0] + [found.end() for found in re.finditer("\n", text)]
        self.open: list[Element] = []
        self.stray: list[Problem] = []
        self.forbidden = _FORBIDDEN.search(text) is not None

    def parse(self, problems: list[Problem]) -> Element:
        """Read up to the end of the root element."""
        for tokens in tokenise_groups(self.text):
            root = self._take(tokens)
            if root is not None:
                problems += self.stray
                return root
        if self.open:
            element = self.open[-1]
            message = f"element <{element.tag}> is not closed: no </{element.tag}> follows"
            raise ParseError(element.location, message)
        raise self._error(0, "the document is empty: it has no root element")

    def _take(self, tokens: list[Token]) -> Element | None:
        """Take one tag, or one token between tags. Return the root element when it ends here."""
        token = tokens[0]
        kind = token.kind
        if kind is TokenKind.TEXT:
            self._take_text(token)
        elif kind is TokenKind.START:
            return self._take_start_tag([t for t in tokens if t.kind is not SPACE])
        elif kind is TokenKind.END:
            return self._take_end_tag(token, tokens[-1])
        elif kind is TokenKind.COMMENT and not token.closed:
            raise self._error(token.offset + 4, "the comment is not closed: no '-->' follows")
        elif kind is TokenKind.DECLARATION and not token.closed:
            raise self._error(token.offset, "the declaration is not closed: no '>' follows")
        return None

    def _take_text(self, token: Token) -> None:
        words = token.text.strip()
        if not words:
            return
        offset = token.offset + token.text.index(words)
        if not self.open:
            raise self._error(offset, f"text before the root element: {words[:40]!r}")
        where = self._location(offset)
        self.stray.append(Problem(ProblemKind.STRAY_TEXT, where, value=words[:60]))

    def _take_end_tag(self, token: Token, last: Token) -> Element | None:
        name = self._name(token, 2)
        if last.kind is not CLOSE:
            raise self._error(token.end, f"end tag </{name} is not closed: no '>' follows")
        if not self.open or self.open[-1].tag != name:
            inner = self.open[-1] if self.open else None
            opened = f"<{inner.tag}> from {inner.location}" if inner else "nothing"
            message = f"end tag </{name}> does not match: {opened} is open"
            raise self._error(token.offset, message)
        element = self.open.pop()
        return None if self.open else element

    def _take_start_tag(self, tokens: list[Token]) -> Element | None:
        """Take a start tag, given without its white space."""
        first, last = tokens[0], tokens[-1]
        element = Element(self._name(first, 1), location=self._location(first.offset))
        if len(self.open) == _MOST_LEVELS:
            raise ParseError(element.location, "elements are nested too deeply")
        closed = last.kind is CLOSE or last.kind is CLOSE_EMPTY
        for index in range(1, len(tokens) - closed, 3):
            self._take_attribute(element, tokens, index)
        if not closed:
            raise self._unfinished(element, last.end)
        if self.open:
            self.open[-1].children.append(element)
        if last.kind is CLOSE:
            self.open.append(element)
        return None if self.open else element

    def _unfinished(self, element: Element, end: int) -> ParseError:
        """Return the error of a start tag that another tag, or the end of the text, cuts off."""
        rest = len(self.text[end:]) - len(self.text[end:].lstrip())
        if end + rest < len(self.text):
            return self._unexpected(end + rest, f"attribute name in <{element.tag}>")
        message = f"start tag <{element.tag} is not closed: no '>' follows"
        return ParseError(element.location, message)

    def _take_attribute(self, element: Element, tokens: list[Token], index: int) -> None:
        """Take the name, the equals sign and the value at ``index``."""
        token, tag = tokens[index], element.tag
        name = token.text
        if token.kind is not NAME or not is_name(name):
            raise self._unexpected(token.offset, f"attribute name in <{tag}>")
        if name in element.attributes:
            raise self._error(token.offset, f"attribute '{name}' of <{tag}> is given twice")
        if index + 1 == len(tokens) or tokens[index + 1].kind is not EQUALS:
            message = f"attribute '{name}' of <{tag}> has no value ('=' expected)"
            raise self._error(token.offset, message)
        if index + 2 == len(tokens) or tokens[index + 2].kind is not VALUE:
            offset = tokens[index + 2].offset if index + 2 < len(tokens) else len(self.text)
            raise self._error(offset, f"attribute '{name}' of <{tag}> has no value")
        value = tokens[index + 2]
        offset, raw = value.offset, value.text
        if raw[0] in "\"'":
            if len(raw) == 1 or raw[-1] != raw[0]:
                raise self._error(offset, f"{_subject(name, tag)} has no closing {raw[0]}")
            offset, raw = offset + 1, raw[1:-1]
        elif '"' in raw or "'" in raw:
            raise self._error(offset, f"{_subject(name, tag)} has a quote inside: {raw}")
        if self.forbidden and (found := _FORBIDDEN.search(raw)):
            message = f"has a character that XML forbids: U+{ord(found[0]):04X}"
            raise self._error(offset + found.start(), f"{_subject(name, tag)} {message}")
        element.attributes[name] = decode(raw)
        element.attribute_locations[name] = self._location(offset)

    def _name(self, token: Token, marks: int) -> str:
        """Return the element name of a tag that begins with this number of marks."""
        name = token.text[marks:]
        if not is_name(name):
            raise self._unexpected(token.offset + marks, "element name")
        return name

    def _unexpected(self, offset: int, expected: str) -> ParseError:
        found = self.text[offset : offset + 12]
        return self._error(offset, f"{expected} expected, found {found!r}")

    def _error(self, offset: int, message: str) -> ParseError:
        return ParseError(self._location(min(offset, max(len(self.text) - 1, 0))), message)

    def _location(self, offset: int) -> Location:
        line = bisect_right(self.lines, offset)
        return Location(self.file, line, offset - self.lines[line - 1] + 1)


def _subject(attribute: str, tag: str) -> str:
    return f"value of attribute '{attribute}' of <{tag}>"


def format_xml(root: Element) -> str:
    """Write an element as clean, indented XML."""
    lines = ['<?xml version="1.0" encoding="UTF-8"?>']
    _format(root, 0, lines)
    return "\n".join(lines) + "\n"


def _format(element: Element, depth: int, lines: list[str]) -> None:
    from xml.sax.saxutils import quoteattr

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

"""The tokeniser of Nau's XML dialect (docs/format.md, 1.1).

Every character of a text belongs to exactly one token: the tokens joined are the text. Half-written
text is split too. A ``<`` where an attribute name is expected ends an unfinished tag, and an
unfinished comment, declaration or quoted value ends with the text. :mod:`nau_py.syntax.xml` makes a
tree of the tokens and reports the first one that does not fit; :mod:`nau_py.syntax.xml_markup`
groups them into tags for edits and for the cursor.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from enum import Enum
from functools import lru_cache
from itertools import chain
from typing import NamedTuple

MARK = "\ufeff"
"""The byte order mark that may begin a text."""
_WORD = r"[\w.:\-]"
_QUOTED = r"\"[^\"]*\"?|'[^']*'?"
_OPENING = re.compile(rf"</?{_WORD}*")
_IN_TAG = re.compile(
    rf"(?P<SPACE>\s+)|(?P<NAME>{_WORD}+)|(?P<EQUALS>=)|(?P<CLOSE>>)|(?P<CLOSE_EMPTY>/>)"
    rf"|(?P<JUNK>{_QUOTED}|[^\s\w.:\-=<>\"'/]+|/)"
)
_IN_END_TAG = re.compile(r"(?P<SPACE>\s+)|(?P<CLOSE>>)|(?P<JUNK>[^\s<>]+)")
_ATTRIBUTE = re.compile(rf"(\s+)({_WORD}+)=(\"[^\"]*\"|'[^']*'|[^\s/>\"'][^\s/>]*)")
_BLANKS = re.compile(r"\s+")
_VALUE = re.compile(rf"{_QUOTED}|[^\s/>]+")
_NAME = re.compile(r"[^\W\d][\w.:\-]*")
_ENTITY = re.compile(r"&(amp|lt|gt|quot|apos|#\d{1,9}|#x[0-9A-Fa-f]{1,8});")
_NAMED = {"amp": "&", "lt": "<", "gt": ">", "quot": '"', "apos": "'"}
_XML_NAME = (
    "[A-Z_a-z\xc0-\xd6\xd8-\xf6\xf8-\u02ff\u0370-\u037d\u037f-\u1fff\u200c\u200d\u2070-\u218f"
    "\u2c00-\u2fef\u3001-\ud7ff\uf900-\ufdcf\ufdf0-\ufffd\U00010000-\U000effff]"
    "[-.:0-9A-Z_a-z\xb7\xc0-\xd6\xd8-\xf6\xf8-\u037d\u037f-\u1fff\u200c\u200d\u203f\u2040"
    "\u2070-\u218f\u2c00-\u2fef\u3001-\ud7ff\uf900-\ufdcf\ufdf0-\ufffd\U00010000-\U000effff]*"
)
"""``Name`` of XML 1.0, fifth edition, production 5. Compiled at first use, which takes 5 ms."""


class TokenKind(Enum):
    """Kinds of token."""

    MARK = "byte order mark"
    TEXT = "text between tags"
    COMMENT = "<!-- ... -->"
    DECLARATION = "<!...> or <?...>"
    START = "<name"
    END = "</name"
    SPACE = "white space in a tag"
    NAME = "attribute name"
    EQUALS = "="
    VALUE = "attribute value with its quotes, if it has any"
    CLOSE = ">"
    CLOSE_EMPTY = "/>"
    JUNK = "anything else in a tag"


# A member takes 5 times as long to look up in its class (CPython 3.11) as in a module.
SPACE, NAME, EQUALS, VALUE = (
    TokenKind.SPACE,
    TokenKind.NAME,
    TokenKind.EQUALS,
    TokenKind.VALUE,
)
CLOSE, CLOSE_EMPTY = TokenKind.CLOSE, TokenKind.CLOSE_EMPTY


class Token(NamedTuple):
    """A stretch of the text that begins at ``offset``."""

    kind: TokenKind
    text: str
    offset: int

    @property
    def end(self) -> int:
        """The offset behind its last character."""
        return self.offset + len(self.text)

    @property
    def quote(self) -> str:
        """The quote that a value begins with; empty for an unquoted one."""
        return self.text[0] if self.text[0] in "\"'" else ""

    @property
    def closed(self) -> bool:
        """Report if a comment, a declaration or a value has its end; an unquoted value has."""
        if self.kind is TokenKind.COMMENT:
            return len(self.text) >= len("<!---->") and self.text.endswith("-->")
        if self.kind is TokenKind.DECLARATION:
            return self.text[-1] == ">"
        quote = self.quote
        return not quote or (len(self.text) > 1 and self.text[-1] == quote)

    @property
    def span(self) -> tuple[int, int]:
        """The begin and end of a value without its quotes."""
        if not self.quote:
            return self.offset, self.end
        return self.offset + 1, self.end - self.closed

    @property
    def value(self) -> str:
        """The value without quotes, with its entities replaced."""
        begin, end = self.span
        return decode(self.text[begin - self.offset : end - self.offset])


def decode(raw: str) -> str:
    """Replace the five entities of XML and character references; leave unknown ones as written."""
    return _ENTITY.sub(_decode, raw) if "&" in raw else raw


def _decode(match: re.Match[str]) -> str:
    body = match[1]
    if body in _NAMED:
        return _NAMED[body]
    code = int(body[2:], 16) if body[1] == "x" else int(body[1:])
    return chr(code) if code in (9, 10, 13) or 32 <= code < 0xD800 else match[0]


@lru_cache(maxsize=1024)
def is_name(word: str) -> bool:
    """Report if a word is a name of an element or an attribute."""
    if _NAME.fullmatch(word) is None:
        return False
    return word.isascii() or re.fullmatch(_XML_NAME, word) is not None


def tokenise(text: str) -> Iterator[Token]:
    """Split ``text`` into tokens."""
    return chain.from_iterable(tokenise_groups(text))


def tokenise_groups(text: str) -> Iterator[list[Token]]:
    """Split ``text`` into groups: the tokens of one tag, or one token between tags."""
    position, size = 0, len(text)
    if text.startswith(MARK):
        yield [Token(TokenKind.MARK, MARK, 0)]
        position = 1
    while position < size:
        found = text.find("<", position)
        end = found if found >= 0 else size
        if end > position:
            yield [Token(TokenKind.TEXT, text[position:end], position)]
        if end == size:
            return
        if text.startswith(("<!", "<?"), end):
            tokens = [_declaration(text, end)]
        else:
            tokens = _split_tag(text, end)
        yield tokens
        position = tokens[-1].end


def _declaration(text: str, begin: int) -> Token:
    if text.startswith("<!--", begin):
        kind, last, first = TokenKind.COMMENT, "-->", begin + 4
    else:
        kind, last, first = TokenKind.DECLARATION, ">", begin
    found = text.find(last, first)
    return Token(kind, text[begin : found + len(last) if found >= 0 else len(text)], begin)


def _split_attribute(
    found: re.Match[str], make: Callable[..., Token] = tuple.__new__
) -> tuple[Token, ...]:
    """Split an attribute in the usual form, ``name="value"`` behind white space.

    This is half of the work of a file. ``tuple.__new__`` takes half of the time of ``Token(...)``.
    """
    space, name, value = found.groups()
    first = found.start(2)
    return (
        make(Token, (SPACE, space, first - len(space))),
        make(Token, (NAME, name, first)),
        make(Token, (EQUALS, "=", first + len(name))),
        make(Token, (VALUE, value, found.start(3))),
    )


def _split_tag(text: str, begin: int) -> list[Token]:
    """Split one start tag or end tag."""
    opening = _OPENING.match(text, begin)
    assert opening is not None  # the text has a '<' here
    end = opening.end()
    if text.startswith("</", begin):
        tokens = [Token(TokenKind.END, opening[0], begin)]
        while rest := _IN_END_TAG.match(text, end):
            tokens.append(Token(TokenKind[rest.lastgroup or "JUNK"], rest[0], end))
            end = rest.end()
            if tokens[-1].kind is CLOSE:
                break
        return tokens
    tokens = [Token(TokenKind.START, opening[0], begin)]
    while True:
        whole = _ATTRIBUTE.match(text, end)
        if whole is not None:
            tokens += _split_attribute(whole)
            end = whole.end()
            continue
        found = _IN_TAG.match(text, end)
        if found is None:
            return tokens
        kind = TokenKind[found.lastgroup or "JUNK"]
        tokens.append(Token(kind, found[0], end))
        end = found.end()
        if kind is CLOSE or kind is CLOSE_EMPTY:
            return tokens
        if kind is EQUALS:
            for pattern, part in ((_BLANKS, SPACE), (_VALUE, VALUE)):
                if found := pattern.match(text, end):
                    tokens.append(Token(part, found[0], end))
                    end = found.end()

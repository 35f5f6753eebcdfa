"""Tokens of Nau's XML dialect grouped into tags, comments and declarations, for half-written text.

Edits and the cursor use these groups; the reader of whole files, which reports errors, is
:mod:`nau_py.syntax.xml`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from nau_py.syntax.xml_tokens import Token, TokenKind, tokenise_groups

_BETWEEN = (TokenKind.TEXT, TokenKind.MARK)


@dataclass(frozen=True, slots=True)
class WrittenAttribute:
    """An attribute of a start tag as it is written, with its index among the tag's tokens."""

    name: Token
    value: Token
    index: int


@dataclass(frozen=True, slots=True)
class TokenGroup:
    """A start tag, an end tag, a comment or a declaration: its tokens, in order."""

    tokens: tuple[Token, ...]

    @property
    def kind(self) -> TokenKind:
        """The kind of the first token, which is the kind of the whole."""
        return self.tokens[0].kind

    @property
    def begin(self) -> int:
        """The offset of its ``<``."""
        return self.tokens[0].offset

    @property
    def end(self) -> int:
        """The offset behind its last character."""
        return self.tokens[-1].end

    @property
    def name(self) -> str:
        """The name of a tag; empty for one that has none yet."""
        return self.tokens[0].text.lstrip("</")

    @property
    def name_span(self) -> tuple[int, int]:
        """The begin and end of the name of a tag."""
        end = self.tokens[0].end
        return end - len(self.name), end

    @property
    def closed(self) -> bool:
        """Report if it has its ``>``."""
        last = self.tokens[-1]
        if self.kind is TokenKind.COMMENT or self.kind is TokenKind.DECLARATION:
            return last.closed
        return last.kind is TokenKind.CLOSE or last.kind is TokenKind.CLOSE_EMPTY

    @property
    def empty(self) -> bool:
        """Report if it is a tag without content, ``<name/>``."""
        return self.tokens[-1].kind is TokenKind.CLOSE_EMPTY

    @property
    def content_end(self) -> int:
        """The offset behind the last attribute, or behind the name of a tag that has none."""
        solid = (TokenKind.SPACE, TokenKind.CLOSE, TokenKind.CLOSE_EMPTY)
        return next(t.end for t in reversed(self.tokens) if t.kind not in solid)

    def attributes(self) -> dict[str, WrittenAttribute]:
        """Return the attributes that have a value, by name; the first one of each name."""
        found: dict[str, WrittenAttribute] = {}
        name: Token | None = None
        index = 0
        for position, token in enumerate(self.tokens):
            if token.kind is TokenKind.NAME:
                name, index = token, position
            elif token.kind is TokenKind.VALUE and name is not None:
                found.setdefault(name.text, WrittenAttribute(name, token, index))
            elif token.kind is TokenKind.JUNK:
                name = None
        return found


def split_markup(text: str) -> Iterator[TokenGroup]:
    """Return the tags, comments and declarations of ``text``, in order."""
    for tokens in tokenise_groups(text):
        if tokens[0].kind not in _BETWEEN:
            yield TokenGroup(tuple(tokens))

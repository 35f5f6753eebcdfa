"""Edits of XML text: :class:`~nau_py.syntax.document.Document` on the tokens of the dialect."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cached_property
from html import escape

from nau_py.syntax.document import Document, Edit, find_word, is_same_value
from nau_py.syntax.xml_markup import TokenGroup, WrittenAttribute, split_markup
from nau_py.syntax.xml_tokens import Token, TokenKind

_NEEDS_QUOTES = re.compile(r"[\s/>]|^$")


def escape_value(value: str) -> str:
    """Escape the value of an attribute for quotes of either kind."""
    return escape(value, quote=False).replace('"', "&quot;").replace("'", "&apos;")


class XmlDocument(Document):
    """The text of an XML file."""

    @cached_property
    def _markup(self) -> list[TokenGroup]:
        return list(split_markup(self.text))

    @cached_property
    def _index_at(self) -> dict[int, int]:
        """Indices into the markup, by the offset of its ``<``."""
        return {markup.begin: index for index, markup in enumerate(self._markup)}

    @cached_property
    def _attribute_at(self) -> dict[int, tuple[TokenGroup, WrittenAttribute]]:
        """Attributes and their tags, by the offset of the value without its quote."""
        return {
            attribute.value.span[0]: (markup, attribute)
            for markup in self._markup
            if markup.kind is TokenKind.START
            for attribute in markup.attributes().values()
        }

    def _tag(self, begin: int) -> TokenGroup | None:
        index = self._index_at.get(begin)
        markup = self._markup[index] if index is not None else None
        return markup if markup is not None and markup.kind is TokenKind.START else None

    def _attributes(self, begin: int) -> dict[str, WrittenAttribute]:
        tag = self._tag(begin)
        return tag.attributes() if tag is not None else {}

    def set_value(self, begin: int, value: str) -> list[Edit]:
        found = self._attribute_at.get(begin)
        return self._exchange(found[1].value, value) if found is not None else []

    def _exchange(self, written: Token, value: str) -> list[Edit]:
        """Replace a value. One without quotes gets them."""
        first, last = written.span
        new = escape_value(value)
        if is_same_value(self.text[first:last], new):
            return []
        return [(first, last, new if written.quote else f'"{new}"')]

    def set_attribute(self, begin: int, key: str, value: str) -> list[Edit]:
        tag = self._tag(begin)
        if tag is None:
            return []
        written = tag.attributes().get(key)
        if written is not None:
            return self._exchange(written.value, value)
        at = tag.content_end
        return [(at, at, f' {key}="{escape_value(value)}"')]

    def set_components(
        self, begin: int, keys: Sequence[tuple[str, ...]], values: Sequence[str]
    ) -> list[Edit]:
        written = self._attributes(begin)
        edits: list[Edit] = []
        for spellings, value in zip(keys, values):
            key = next((k for k in spellings if k in written), spellings[0])
            edits += self.set_attribute(begin, key, value)
        return edits

    def add_setting(
        self, begin: int, name: str, keys: Sequence[str], values: Sequence[str]
    ) -> list[Edit]:
        tag = self._tag(begin)
        if tag is None:
            return []
        attributes = " ".join(f'{k}="{escape_value(v)}"' for k, v in zip(keys, values))
        child = f"<{name} {attributes} />"
        outer = self.newline + self.indent(begin)
        inner = f"{outer}  "
        if tag.empty:
            return [(tag.content_end, tag.end, f">{inner}{child}{outer}</{tag.name}>")]
        following = re.compile(r"\s*").match(self.text, tag.end)
        blank = following[0] if following is not None else ""
        if "\n" not in blank or self.text.startswith("</", tag.end + len(blank)):
            blank = inner
        return [(tag.end, tag.end, f"{blank}{child}")]

    def _replace_word(self, begin: int, old: str, new: str) -> list[Edit]:
        found = self._attribute_at.get(begin)
        written = [found[1]] if found is not None else list(self._attributes(begin).values())
        for attribute in written:
            first, last = attribute.value.span
            raw = self.text[first:last]
            word = old if old in raw else escape_value(old)
            at = find_word(raw, word)
            if at < 0:
                continue
            replacement = escape_value(new)
            if not attribute.value.quote and _NEEDS_QUOTES.search(replacement):
                return [(first, last, f'"{raw[:at]}{replacement}{raw[at + len(word) :]}"')]
            return [(first + at, first + at + len(word), replacement)]
        return []

    def _rename_element(self, begin: int, old: str, new: str) -> list[Edit]:
        tag = self._tag(begin)
        if tag is None or tag.name != old:
            return []
        end = self._end_tag(begin)
        spans = [tag.name_span, *([end.name_span] if end is not None else [])]
        return [(first, last, new) for first, last in spans]

    def _end_tag(self, begin: int) -> TokenGroup | None:
        """Return the end tag of the element at ``begin``; None where it has none."""
        first = self._index_at[begin]
        depth = 0
        for markup in self._markup[first:]:
            if markup.name != self._markup[first].name:
                continue
            if markup.kind is TokenKind.END:
                depth -= 1
            elif markup.kind is TokenKind.START and not markup.empty:
                depth += 1
            if depth == 0:
                return markup if markup.kind is TokenKind.END else None
        return None

    def _rename_attribute(self, begin: int, old: str, new: str) -> list[Edit]:
        found = self._attribute_at.get(begin)
        if found is None or found[1].name.text != old:
            return []
        name = found[1].name
        return [(name.offset, name.end, new)]

    def _remove_attribute(self, begin: int, old: str) -> list[Edit]:
        found = self._attribute_at.get(begin)
        if found is None or found[1].name.text != old:
            return []
        tag, attribute = found
        before = tag.tokens[attribute.index - 1]
        first = before if before.kind is TokenKind.SPACE else attribute.name
        return [(first.offset, attribute.value.end, "")]

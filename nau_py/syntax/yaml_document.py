"""Edits of YAML text: :class:`~nau_py.syntax.document.Document` on ruamel.yaml's nodes."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cached_property

from ruamel.yaml.nodes import CollectionNode, MappingNode, Node, ScalarNode

from nau_py.syntax.document import Document, Edit, find_word, is_same_value
from nau_py.syntax.yaml_nodes import (
    YamlEntry,
    YamlNodes,
    begin_of,
    end_of,
    is_written,
    scalar_children,
    scalar_span,
)

_BLOCK_SCALARS = ("|", ">")
_BLANKS = re.compile(r"[ \t]*")


class YamlDocument(Document):
    """The text of a YAML file."""

    @cached_property
    def _nodes(self) -> YamlNodes:
        return YamlNodes(self.text)

    def _value(self, begin: int) -> Node | None:
        """Return the value of the key at ``begin``, or the value that is written there."""
        entry = self._nodes.by_key.get(begin) or self._nodes.by_value.get(begin)
        if entry is not None:
            return entry.value
        return self._nodes.items.get(begin) or self._nodes.scalars.get(begin)

    def set_value(self, begin: int, value: str) -> list[Edit]:
        scalar = self._nodes.scalars.get(begin)
        return self._exchange(scalar, value) if scalar is not None else []

    def _exchange(self, scalar: ScalarNode, value: str) -> list[Edit]:
        first, last = scalar_span(scalar)
        if scalar.style in _BLOCK_SCALARS or is_same_value(self.text[first:last], value):
            return []
        return [(first, last, value)]

    def set_attribute(self, begin: int, key: str, value: str) -> list[Edit]:
        item = self._nodes.items.get(begin)
        entry = self._nodes.by_key.get(begin)
        owner = item if item is not None else entry.value if entry is not None else None
        if not isinstance(owner, MappingNode):
            return []
        written = scalar_children(owner).get(key)
        if written is not None:
            return self._exchange(written, value)
        if any(entry[0].value == key for entry in owner.value):
            return []  # its value is a collection, or missing
        if owner.flow_style:
            return self._add_to_flow(owner, key, value)
        first = YamlEntry(owner, 0)
        at = begin_of(first.key)
        pad = self.newline + self.indent(at)
        if owner is item and self._is_on_one_line(first):
            # behind the first entry: the line with the dash stays
            end = self.line_end(end_of(first.value))
            end -= self.text[end - 1] == "\r"
            return [(end, end, f"{pad}{key}: {value}")]
        return [(at, at, f"{key}: {value}{pad}")]

    def _add_to_flow(self, owner: MappingNode, key: str, value: str) -> list[Edit]:
        blanks = _BLANKS.match(self.text, begin_of(owner) + 1)
        at = blanks.end() if blanks is not None else begin_of(owner) + 1
        return [(at, at, f"{key}: {value}{', ' if owner.value else ''}")]

    def _is_on_one_line(self, entry: YamlEntry) -> bool:
        value = entry.value
        if not isinstance(value, ScalarNode) or value.style in _BLOCK_SCALARS:
            return False
        return is_written(value)

    def set_components(
        self, begin: int, keys: Sequence[tuple[str, ...]], values: Sequence[str]
    ) -> list[Edit]:
        owner = self._value(begin)
        written = scalar_children(owner) if owner is not None else {}
        edits: list[Edit] = []
        for index, (spellings, value) in enumerate(zip(keys, values)):
            scalar = next((written[k] for k in (*spellings, str(index)) if k in written), None)
            if scalar is not None:
                edits += self._exchange(scalar, value)
            elif owner is not None and written:
                edits += self._add_component(owner, list(written.values())[-1], spellings[0], value)
        return edits

    def _add_component(self, owner: Node, last: ScalarNode, key: str, value: str) -> list[Edit]:
        """Add a component behind the last one of a list or a map."""
        if not isinstance(owner, CollectionNode):
            return []
        is_map = isinstance(owner, MappingNode)
        word = f"{key}: {value}" if is_map else value
        end = end_of(last)
        if owner.flow_style:
            return [(end, end, f", {word}")]
        blanks = _BLANKS.match(self.text, self.line_begin(begin_of(last)))
        pad = blanks[0] if blanks is not None else ""
        return [(end, end, f"{self.newline}{pad}{'' if is_map else '- '}{word}")]

    def add_setting(
        self, begin: int, name: str, keys: Sequence[str], values: Sequence[str]
    ) -> list[Edit]:
        one = values[0] if len(values) == 1 else f"[{', '.join(values)}]"
        return self.set_attribute(begin, name, one)

    def _replace_word(self, begin: int, old: str, new: str) -> list[Edit]:
        owner = self._value(begin)
        for scalar in scalar_children(owner).values() if owner is not None else ():
            first, last = scalar_span(scalar)
            at = find_word(self.text[first:last], old)
            if at >= 0:
                return [(first + at, first + at + len(old), new)]
        return []

    def _rename_element(self, begin: int, old: str, new: str) -> list[Edit]:
        entry = self._nodes.by_key.get(begin)
        if entry is None or self.text[begin : end_of(entry.key)] != old:
            return []
        return [(begin, begin + len(old), new)]

    def _rename_attribute(self, begin: int, old: str, new: str) -> list[Edit]:
        entry = self._attribute(begin, old)
        if entry is None or not isinstance(entry.key, ScalarNode):
            return []
        return [(*scalar_span(entry.key), new)]

    def _attribute(self, begin: int, name: str) -> YamlEntry | None:
        entry = self._nodes.by_value.get(begin)
        return entry if entry is not None and entry.key.value == name else None

    def _remove_attribute(self, begin: int, old: str) -> list[Edit]:
        entry = self._attribute(begin, old)
        if entry is None:
            return []
        first, last = begin_of(entry.key), end_of(entry.value)
        line = self.line_begin(first)
        if not self.text[line:first].strip():  # a line of its own
            return [(line, min(self.line_end(last) + 1, len(self.text)), "")]
        entries = entry.map.value
        if not entry.map.flow_style or len(entries) == 1:
            return []
        if entry.index + 1 < len(entries):
            return [(first, begin_of(entries[entry.index + 1][0]), "")]
        return [(end_of(entries[entry.index - 1][1]), last, "")]

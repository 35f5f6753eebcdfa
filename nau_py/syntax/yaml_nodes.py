"""Positions of the keys and values of a YAML text, as ruamel.yaml's composer marks them."""

from __future__ import annotations

from dataclasses import dataclass

from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError
from ruamel.yaml.nodes import CollectionNode, MappingNode, Node, ScalarNode, SequenceNode


@dataclass(frozen=True, slots=True)
class YamlEntry:
    """A key of a map and its value. ``index``: its place among the entries of the map."""

    map: MappingNode
    index: int

    @property
    def key(self) -> Node:
        key: Node = self.map.value[self.index][0]
        return key

    @property
    def value(self) -> Node:
        value: Node = self.map.value[self.index][1]
        return value


def begin_of(node: Node) -> int:
    """Return the offset of the first character of a node."""
    return int(node.start_mark.index)


def end_of(node: Node) -> int:
    """Return the offset behind the last character of a node.

    Of a collection in block style it is the offset of what follows.
    """
    return int(node.end_mark.index)


def scalar_span(node: ScalarNode) -> tuple[int, int]:
    """Return the begin and end of a scalar without its quotes."""
    quoted = node.style in ("'", '"')
    return begin_of(node) + quoted, end_of(node) - quoted


def is_written(node: Node) -> bool:
    """Report if a node has text. A key without a value has a scalar that begins where the next
    token does."""
    return end_of(node) > begin_of(node)


def scalar_children(node: Node) -> dict[str, ScalarNode]:
    """Return the written scalars of a value: itself as "0", or its items by index or by key."""
    if isinstance(node, ScalarNode):
        return {"0": node} if is_written(node) else {}
    if isinstance(node, MappingNode):
        children = [(str(key.value), value) for key, value in node.value]
    else:
        children = [(str(index), value) for index, value in enumerate(node.value)]
    return {
        key: value for key, value in children if isinstance(value, ScalarNode) and is_written(value)
    }


class YamlNodes:
    """The written nodes of a text by the offset of their first character.

    A text that cannot be parsed has none.

    ``by_key``: entries of maps by their keys. ``by_value``: the same ones by their values.
    ``scalars``: scalars that are values or items. ``items``: maps and lists that are items of a
    list, which begin where their first key does.
    """

    def __init__(self, text: str) -> None:
        self.by_key: dict[int, YamlEntry] = {}
        self.by_value: dict[int, YamlEntry] = {}
        self.scalars: dict[int, ScalarNode] = {}
        self.items: dict[int, CollectionNode] = {}
        try:
            root = YAML(typ="safe", pure=True).compose(text)
        except (YAMLError, ValueError, RecursionError):
            root = None
        if root is not None:
            self._add(root)

    def _add(self, node: Node) -> None:
        if not is_written(node):
            return
        if isinstance(node, ScalarNode):
            self.scalars.setdefault(begin_of(node), node)
        elif isinstance(node, SequenceNode):
            for item in node.value:
                if isinstance(item, CollectionNode):
                    self.items.setdefault(begin_of(item), item)
                self._add(item)
        elif isinstance(node, MappingNode):
            for index in range(len(node.value)):
                entry = YamlEntry(node, index)
                self.by_key.setdefault(begin_of(entry.key), entry)
                if is_written(entry.value):
                    self.by_value.setdefault(begin_of(entry.value), entry)
                self._add(entry.value)

"""Read YAML into maps, lists and scalars with positions, and write them."""

from __future__ import annotations

from io import StringIO
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap
from ruamel.yaml.error import MarkedYAMLError, YAMLError

from nau_py.diagnostics.location import Location
from nau_py.syntax.parse_error import ParseError


def parse_yaml(text: str, file: str) -> CommentedMap:
    """Read the map of a text. Tags execute nothing.

    Raises :class:`~nau_py.syntax.parse_error.ParseError`.
    """
    try:
        data = YAML(typ="rt", pure=True).load(text)
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        where = Location(file, mark.line + 1, mark.column + 1) if mark else Location(file, 1, 1)
        raise ParseError(where, str(error.problem or error.context)) from None
    except (YAMLError, ValueError) as error:  # characters that YAML forbids, numbers beyond reason
        first = str(error).splitlines()[0]
        raise ParseError(Location(file, 1, 1), first) from None
    if not isinstance(data, CommentedMap):
        raise ParseError(Location(file, 1, 1), "a mapping is expected at the top")
    return data


def value_location(container: object, key: object, file: str) -> Location:
    """Return the place of the value of a key, or of the item at an index."""
    try:
        if isinstance(container, CommentedMap):
            line, column = container.lc.value(key)
        else:
            line, column = container.lc.item(key)  # type: ignore[attr-defined]
    except (AttributeError, KeyError, TypeError, IndexError):
        return Location(file)
    return Location(file, line + 1, column + 1)


def key_location(container: CommentedMap, key: object, file: str) -> Location:
    """Return the place of a key."""
    try:
        line, column = container.lc.key(key)
    except (AttributeError, KeyError, TypeError):
        return Location(file)
    return Location(file, line + 1, column + 1)


def format_yaml(data: Any) -> str:
    """Write maps, lists and scalars as YAML."""
    yaml = YAML(typ="rt", pure=True)
    yaml.indent(mapping=2, sequence=4, offset=2)
    yaml.width = 100
    stream = StringIO()
    yaml.dump(data, stream)
    return stream.getvalue()

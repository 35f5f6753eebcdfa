"""The cursor of an editor: what is being written, and the elements around it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

ITEM = "-"
"""The tag of a step into an item of a YAML list."""


class CursorKind(StrEnum):
    """Kinds of text at a cursor."""

    CHILD = "child"
    """An element, or its name."""
    ATTRIBUTE = "attribute"
    VALUE = "value"
    END = "end"
    """The name of an end tag, or text that takes no completion: a comment, a declaration."""
    KEY = "key"
    """A key of a YAML map: attribute or child."""


@dataclass(frozen=True, slots=True)
class CursorStep:
    """One element on the way from the root, with the attributes that are written so far."""

    tag: str
    attributes: dict[str, str]


@dataclass(frozen=True, slots=True)
class Cursor:
    """A cursor in its surroundings.

    ``path``: the elements around it, outermost first. ``name``: the attribute whose value is being
    written. ``begin``, ``end``: the span of the word that is being written, in characters.
    """

    kind: CursorKind
    path: tuple[CursorStep, ...]
    name: str
    begin: int
    end: int

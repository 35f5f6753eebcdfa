"""Problems of reading a file. Readers collect them; lint makes diagnostics of them."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from nau_py.diagnostics.location import Location


class ProblemKind(StrEnum):
    """Kinds of problem; each has a lint rule."""

    UNREADABLE = "unreadable"
    SYNTAX = "syntax"
    STRAY_TEXT = "stray text"
    UNCONVERTIBLE = "unconvertible"
    TRAILING_TEXT = "trailing text"
    INCOMPLETE = "incomplete"
    REPEATED = "repeated"
    READ_ONLY = "read only"
    LEGACY = "legacy"


@dataclass(frozen=True, slots=True)
class Problem:
    """One problem: kind, place, and the words for its message."""

    kind: ProblemKind
    location: Location
    element: str = ""
    attribute: str = ""
    value: str = ""
    expected: str = ""
    detail: str = ""

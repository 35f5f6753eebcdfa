"""What a reader could not take in. Readers collect problems; lint turns them into diagnostics."""

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
    """One finding of a reader: what it is, where, and the words for the message."""

    kind: ProblemKind
    location: Location
    element: str = ""
    attribute: str = ""
    value: str = ""
    expected: str = ""
    detail: str = ""

"""One finding about a project: rule, severity, place, message, fixes."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum

from nau_py.diagnostics.location import NOWHERE, Location


class Severity(StrEnum):
    """Severity of a finding. Only an error stops a run."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


class Part(StrEnum):
    """The part of a file that a change replaces."""

    VALUE = "value"
    """A value: at its position, or in the element at that position."""
    ELEMENT = "element"
    """The name of an element (of a key in YAML), its end tag included."""
    ATTRIBUTE = "attribute"
    """The name of an attribute; the position is that of its value."""


@dataclass(frozen=True, slots=True)
class Change:
    """Replacement of ``old`` by ``new`` at a place.

    An attribute whose ``new`` is empty is removed with its value.
    """

    location: Location
    part: Part
    old: str
    new: str


@dataclass(frozen=True, slots=True)
class Fix:
    """A correction of a finding. ``safe``: the picture stays the same; else it is a guess."""

    title: str
    changes: tuple[Change, ...]
    safe: bool = False


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """A rule id, a place, and a message that uses the names of the file."""

    rule: str
    severity: Severity
    location: Location
    message: str
    related: tuple[tuple[Location, str], ...] = field(default=())
    """Further places that the message mentions."""
    fixes: tuple[Fix, ...] = field(default=(), compare=False)
    """Possible corrections, the most likely one first."""

    def __str__(self) -> str:
        where = f"{self.location}: " if self.location != NOWHERE else ""
        return f"{where}{self.severity}[{self.rule}]: {self.message}"


def error(rule: str, location: Location, message: str, fixes: tuple[Fix, ...] = ()) -> Diagnostic:
    """Make a diagnostic that stops a run."""
    return Diagnostic(rule, Severity.ERROR, location, message, fixes=fixes)


def warning(rule: str, location: Location, message: str) -> Diagnostic:
    """Make a diagnostic that does not stop a run."""
    return Diagnostic(rule, Severity.WARNING, location, message)

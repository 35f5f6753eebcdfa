"""One finding about a project, for the person who wrote it."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum

from nau_py.diagnostics.location import NOWHERE, Location


class Severity(StrEnum):
    """How bad a finding is. Only an error stops a run."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


class Part(StrEnum):
    """What of a file a change is about."""

    VALUE = "value"
    """A value: at its position, or in the element that stands there."""
    ELEMENT = "element"
    """The name of an element (of a key in YAML), its end tag included."""
    ATTRIBUTE = "attribute"
    """The name of an attribute, whose value stands at the position."""


@dataclass(frozen=True, slots=True)
class Change:
    """``old`` becomes ``new`` at a place; an attribute whose ``new`` is empty goes, value and
    all."""

    location: Location
    part: Part
    old: str
    new: str


@dataclass(frozen=True, slots=True)
class Fix:
    """A way to mend a finding. ``safe``: the picture stays the same; else it is a guess."""

    title: str
    changes: tuple[Change, ...]
    safe: bool = False


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """A rule id, a place, and what is wrong there, with the names that the file uses."""

    rule: str
    severity: Severity
    location: Location
    message: str
    related: tuple[tuple[Location, str], ...] = field(default=())
    """Further places that the message speaks of."""
    fixes: tuple[Fix, ...] = field(default=(), compare=False)
    """Ways to mend it; the first one is the likely one."""

    def __str__(self) -> str:
        where = f"{self.location}: " if self.location != NOWHERE else ""
        return f"{where}{self.severity}[{self.rule}]: {self.message}"


def error(rule: str, location: Location, message: str, fixes: tuple[Fix, ...] = ()) -> Diagnostic:
    return Diagnostic(rule, Severity.ERROR, location, message, fixes=fixes)


def warning(rule: str, location: Location, message: str) -> Diagnostic:
    return Diagnostic(rule, Severity.WARNING, location, message)

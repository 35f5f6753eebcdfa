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


def near(name: str, known: list[str]) -> str | None:
    """The known name that ``name`` may have been meant for."""
    from difflib import get_close_matches

    lower = {k.lower(): k for k in known}
    found = get_close_matches(name.lower(), list(lower), n=1, cutoff=0.6)
    return lower[found[0]] if found else None


def nearest(name: str, known: list[str]) -> str:
    """`` (did you mean 'x'?)``, or nothing where no name is near."""
    found = near(name, known)
    return f" (did you mean '{found}'?)" if found else ""


def guess(
    location: Location, name: str, known: list[str], part: Part = Part.VALUE
) -> tuple[Fix, ...]:
    """The fix that writes the nearest known name for ``name``; none where no name is near."""
    found = near(name, known)
    if found is None or found == name:
        return ()
    return (Fix(f"Change to '{found}'", (Change(location, part, name, found),)),)


def listing(known: list[str] | tuple[str, ...], most: int = 12) -> str:
    """``'a', 'b' … (3 more)``; ``none`` for an empty list."""
    if not known:
        return "none"
    shown = ", ".join(f"'{k}'" for k in known[:most])
    return shown + (f" … ({len(known) - most} more)" if len(known) > most else "")

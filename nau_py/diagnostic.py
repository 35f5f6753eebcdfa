"""One finding about a project, for the person who wrote it."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum

from nau_py.model.location import NOWHERE, Location


class Severity(StrEnum):
    """How bad a finding is. Only an error stops a run."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """A rule id, a place, and what is wrong there, with the names that the file uses."""

    rule: str
    severity: Severity
    location: Location
    message: str
    related: tuple[tuple[Location, str], ...] = field(default=())
    """Further places that the message speaks of."""

    def __str__(self) -> str:
        where = f"{self.location}: " if self.location != NOWHERE else ""
        return f"{where}{self.severity}[{self.rule}]: {self.message}"


def error(rule: str, location: Location, message: str) -> Diagnostic:
    return Diagnostic(rule, Severity.ERROR, location, message)


def warning(rule: str, location: Location, message: str) -> Diagnostic:
    return Diagnostic(rule, Severity.WARNING, location, message)


def nearest(name: str, known: list[str]) -> str:
    """`` (did you mean 'x'?)``, or nothing where no name is near."""
    from difflib import get_close_matches

    lower = {k.lower(): k for k in known}
    found = get_close_matches(name.lower(), list(lower), n=1, cutoff=0.6)
    return f" (did you mean '{lower[found[0]]}'?)" if found else ""


def listing(known: list[str] | tuple[str, ...], most: int = 12) -> str:
    """``'a', 'b' … (3 more)``; ``none`` for an empty list."""
    if not known:
        return "none"
    shown = ", ".join(f"'{k}'" for k in known[:most])
    return shown + (f" … ({len(known) - most} more)" if len(known) > most else "")

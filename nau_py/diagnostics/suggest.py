"""Suggestions for misspelt names: texts for a message, and fixes."""

from __future__ import annotations

from difflib import get_close_matches

from nau_py.diagnostics.diagnostic import Change, Fix, Part
from nau_py.diagnostics.location import Location


def find_near(name: str, known: list[str]) -> str | None:
    """Return the known name most similar to ``name``, ignoring case; None if none is similar."""
    lower = {k.lower(): k for k in known}
    found = get_close_matches(name.lower(), list(lower), n=1, cutoff=0.6)
    return lower[found[0]] if found else None


def suggest_name(name: str, known: list[str]) -> str:
    """Return `` (did you mean 'x'?)``, or an empty text if no known name is similar."""
    found = find_near(name, known)
    return f" (did you mean '{found}'?)" if found else ""


def suggest_fix(
    location: Location, name: str, known: list[str], part: Part = Part.VALUE
) -> tuple[Fix, ...]:
    """Make a fix that writes the most similar known name for ``name``, if there is one."""
    found = find_near(name, known)
    if found is None or found == name:
        return ()
    return (Fix(f"Change to '{found}'", (Change(location, part, name, found),)),)


def format_names(known: list[str] | tuple[str, ...], most: int = 12) -> str:
    """Write names as ``'a', 'b' … (3 more)``, or ``none`` for an empty list."""
    if not known:
        return "none"
    shown = ", ".join(f"'{k}'" for k in known[:most])
    return shown + (f" … ({len(known) - most} more)" if len(known) > most else "")

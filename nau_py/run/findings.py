"""Diagnostics collected while a project runs."""

from __future__ import annotations

from collections.abc import Iterable

from nau_py.diagnostics.diagnostic import Diagnostic


def add_new(diagnostics: list[Diagnostic], found: Iterable[Diagnostic]) -> None:
    """Append the findings that are not in ``diagnostics`` yet, by rule, location and message."""
    known = {(d.rule, d.location, d.message) for d in diagnostics}
    diagnostics += [d for d in found if (d.rule, d.location, d.message) not in known]

"""The catalogue of rules: stable ids with the texts for reports and for the reference page.

A rule is registered beside its check in :mod:`nau_py.rules` or in a plug-in. Findings that only a
run reports have theirs in :mod:`nau_py.diagnostics.run_rules`.
"""

from __future__ import annotations

from dataclasses import dataclass

from nau_py.diagnostics.diagnostic import Diagnostic, Fix, Severity
from nau_py.diagnostics.location import Location


@dataclass(frozen=True, slots=True)
class Rule:
    """One rule. ``bad`` and ``good`` are short pieces of a file."""

    id: str
    severity: Severity
    title: str
    explanation: str
    bad: str
    good: str

    def at(
        self,
        location: Location,
        message: str,
        related: tuple[tuple[Location, str], ...] = (),
        fixes: tuple[Fix, ...] = (),
    ) -> Diagnostic:
        """Make a finding of this rule."""
        return Diagnostic(self.id, self.severity, location, message, related, fixes)


RULES: dict[str, Rule] = {}
"""Every registered rule by its id."""

ERROR, WARNING, NOTE = Severity.ERROR, Severity.WARNING, Severity.NOTE


def rule(id_: str, severity: Severity, title: str, explanation: str, bad: str, good: str) -> Rule:
    """Register a rule. An id is never reused. Raises ValueError for an id that is taken."""
    if id_ in RULES:
        raise ValueError(f"rule {id_} is registered twice")
    RULES[id_] = Rule(id_, severity, title, explanation, bad, good)
    return RULES[id_]

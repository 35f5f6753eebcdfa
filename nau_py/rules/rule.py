"""The registry of rules: stable ids with what a page about them needs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from nau_py.diagnostics.diagnostic import Diagnostic, Fix, Severity
from nau_py.diagnostics.location import Location
from nau_py.graph.contract import Contracts
from nau_py.model.linked import Project


@dataclass(frozen=True, slots=True)
class Rule:
    """One rule. ``bad`` and ``good`` are small pieces of a file."""

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
        """A finding of this rule."""
        return Diagnostic(self.id, self.severity, location, message, related, fixes)


@dataclass(frozen=True, slots=True)
class Facts:
    """What a check may look at: the project, and the contracts of the pass classes.

    ``materials``: names in the default library, models' included; None where a model's are not
    known without loading it.
    """

    project: Project
    contracts: Contracts
    materials: frozenset[str] | None = None


Check = Callable[[Facts], Iterator[Diagnostic]]

RULES: dict[str, Rule] = {}
CHECKS: list[Check] = []


def rule(id_: str, severity: Severity, title: str, explanation: str, bad: str, good: str) -> Rule:
    """Register a rule. An id is never used again for something else."""
    if id_ in RULES:
        raise ValueError(f"rule {id_} is registered twice")
    RULES[id_] = Rule(id_, severity, title, explanation, bad, good)
    return RULES[id_]


def check(function: Check) -> Check:
    """Register a function that yields findings."""
    CHECKS.append(function)
    return function


ERROR, WARNING, NOTE = Severity.ERROR, Severity.WARNING, Severity.NOTE

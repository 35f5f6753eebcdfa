"""The registry of lint checks, and the data that a check may read."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.graph.contract import Contracts
from nau_py.model.linked import Project


@dataclass(frozen=True, slots=True)
class LintContext:
    """Input of every check: the project, and the contracts of the pass classes.

    ``materials`` holds the names in the default library, models' included; None where the names
    of a model are unknown without loading it.
    """

    project: Project
    contracts: Contracts
    materials: frozenset[str] | None = None


Check = Callable[[LintContext], Iterator[Diagnostic]]
CHECKS: list[Check] = []
"""Every registered check, in the order of registration."""


def check(function: Check) -> Check:
    """Register a function that yields findings."""
    CHECKS.append(function)
    return function

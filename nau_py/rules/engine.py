"""Run every check over a project."""

from __future__ import annotations

from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.graph.contract import Contracts
from nau_py.model.linked import Project
from nau_py.rules.loading import load_rules
from nau_py.rules.registry import CHECKS, LintContext


def lint(
    project: Project, contracts: Contracts, materials: frozenset[str] | None = None
) -> list[Diagnostic]:
    """Collect all findings, in file and line order. Looks files up, executes nothing.

    ``contracts``: the resources that each pass class reads and writes
    (:func:`nau_py.passes.pass_classes`). ``materials``: names in the default library, models'
    included, if they are known.
    """
    load_rules()
    context = LintContext(project, contracts, materials)
    found = [d for check in CHECKS for d in check(context)]
    unique = list(dict.fromkeys(found))
    main = str(project.path)
    return sorted(
        unique,
        key=lambda d: (
            d.location.file != main,
            d.location.file,
            d.location.line,
            d.location.column,
            d.rule,
        ),
    )

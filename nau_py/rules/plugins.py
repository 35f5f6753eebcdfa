"""E: plug-ins that cannot be loaded."""

from __future__ import annotations

from collections.abc import Iterator

import nau_py.plugins as plugins
from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.diagnostics.run_rules import E005
from nau_py.rules.registry import LintContext, check


@check
def check_plug_ins(context: LintContext) -> Iterator[Diagnostic]:
    """Load the plug-ins that lint has not loaded yet, and report those that failed."""
    plugins.load_plugins(plugins.READERS)
    plugins.program_files()
    for message in plugins.failures():
        yield E005.at(context.project.file.location, message)

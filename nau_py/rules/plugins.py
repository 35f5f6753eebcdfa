"""E: plug-ins that cannot be loaded."""

from __future__ import annotations

from collections.abc import Iterator

import nau_py.plugins as plugins
from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.rules.rule import RULES, Facts, check


@check
def plug_ins(facts: Facts) -> Iterator[Diagnostic]:
    """Those of passes and rules are loaded by now, those of readers when a model asks."""
    plugins.loaded(plugins.READERS)
    plugins.program_files()
    for said in plugins.failures():
        yield RULES["E005"].at(facts.project.file.location, said)

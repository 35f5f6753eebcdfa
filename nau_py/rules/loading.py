"""Registration of all rules and checks: one module a family, and the modules of plug-ins."""

from __future__ import annotations

import nau_py.diagnostics.run_rules
import nau_py.rules.accuracy
import nau_py.rules.compiled_programs
import nau_py.rules.dataflow
import nau_py.rules.files
import nau_py.rules.names
import nau_py.rules.numerics
import nau_py.rules.passes
import nau_py.rules.plugins
import nau_py.rules.ray_programs
import nau_py.rules.raytrace
import nau_py.rules.references
import nau_py.rules.syntax
import nau_py.rules.unsupported
import nau_py.rules.values  # noqa: F401
from nau_py.plugins import RULES, load_plugins


def load_rules() -> None:
    """Load the rules of plug-ins. Importing this module registers the built-in ones."""
    load_plugins(RULES)

"""Faults of the compiled programs of a pass, found without executing them."""

from __future__ import annotations

from collections.abc import Iterator

from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.model.linked import Project
from nau_py.model.raytrace import RaytracePass
from nau_py.raytrace.ptx.host.contracts import check_contracts
from nau_py.raytrace.ptx.host.modules import check_modules, read_modules
from nau_py.raytrace.ptx.host.variable_faults import check_variables


def check_programs(project: Project, pass_: RaytracePass) -> Iterator[Diagnostic]:
    """Yield faults of modules, variables, records, payloads and parameters of a pass."""
    modules = read_modules(pass_, project.folder)
    yield from check_modules(pass_, modules, project.folder)
    yield from check_variables(project, pass_, modules)
    yield from check_contracts(project, pass_, modules)

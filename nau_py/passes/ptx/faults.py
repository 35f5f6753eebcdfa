"""What of a pass's compiled programs cannot be run: by reading them only."""

from __future__ import annotations

from collections.abc import Iterator

from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.model.linked import Project
from nau_py.model.raytrace import RaytracePass
from nau_py.passes.ptx.contracts import contract_faults
from nau_py.passes.ptx.programs import module_faults, modules_of
from nau_py.passes.ptx.variables import variable_faults


def ptx_faults(project: Project, pass_: RaytracePass) -> Iterator[Diagnostic]:
    """Broken modules, what is not supported in them, variables that nothing sets, records and
    payloads that do not fit."""
    modules = modules_of(pass_, project.folder)
    yield from module_faults(pass_, modules, project.folder)
    yield from variable_faults(project, pass_, modules)
    yield from contract_faults(project, pass_, modules)

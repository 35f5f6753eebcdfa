"""Contracts between programs and their pass: records, payloads, entries and parameters.

See docs/format.md, 7.1 and 13.3.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from nau_py.diagnostics.diagnostic import Diagnostic, error, warning
from nau_py.model.linked import Project
from nau_py.model.raytrace import GEOMETRY_KINDS, Program, RaytracePass
from nau_py.raytrace.programs.description import MISS
from nau_py.raytrace.programs.used import used_programs
from nau_py.raytrace.ptx.compiler.analysis import ProgramUses, analyse_program
from nau_py.raytrace.ptx.compiler.module import PtxModule
from nau_py.raytrace.ptx.host.modules import Modules, find_function, program_path
from nau_py.raytrace.ptx.host.variable_faults import find_named_variables, value_bytes
from nau_py.raytrace.ptx.optix.variables import uses_variables

HIT_RECORD, OTHER_RECORD = 112, 16
"""Bytes of data in a hit record, and in a record of ray generation or a miss."""
IGNORED_ATTRIBUTES = (
    "SAMPLER",
    "ACCUMULATE",
    "TARGET_ERROR",
    "LIGHT_SAMPLES",
    "OCCLUSION_DISTANCE",
)
"""Attributes of the pass that compiled programs ignore."""
PAYLOAD_WORDS = 2
"""Words of a ray's payload in Nau's pipeline."""


def check_contracts(
    project: Project, pass_: RaytracePass, modules: Modules
) -> Iterator[Diagnostic]:
    """Yield warnings of records and payloads that are too short, of incomplete entries and of
    parameters without alignment (T008, T020 to T024)."""
    for name in (n for n in IGNORED_ATTRIBUTES if n in (pass_.settings or {})):
        yield warning(
            "T024",
            pass_.location,
            f"pass '{pass_.name}': {name} has no effect on compiled programs, which draw their own "
            "samples",
        )
    used = list(_analyse_used(project.folder, pass_, modules))
    if any(isinstance(m, PtxModule) and uses_variables(m) for m in modules.values()):
        yield from _check_old_payloads(pass_, used)
        for kind in GEOMETRY_KINDS:
            if not any(program.type == kind for program in pass_.rtGeometryProgram):
                yield error(
                    "T008",
                    pass_.location,
                    f"raytrace pass '{pass_.name}' has no {kind} program: programs of OptiX 3 "
                    "to 6 need one to hit geometry",
                )
        return
    yield from _check_records(pass_, used)
    yield from _check_payloads(pass_, used)
    yield from _check_entries(pass_)
    yield from _check_parameters(project, pass_)


UsedCode = tuple[Program, PtxModule, ProgramUses]


def _analyse_used(folder: Path, pass_: RaytracePass, modules: Modules) -> Iterator[UsedCode]:
    """Analyse each program of a pass whose module can be read."""
    seen: set[tuple[Path, str]] = set()
    for program, *_ in used_programs(pass_):
        path = program_path(folder, program.file)
        module, name = modules.get(path), program.proc or ""
        if not isinstance(module, PtxModule) or (path, name) in seen:
            continue
        seen.add((path, name))
        function = find_function(module, name)
        if function is not None:
            yield program, module, analyse_program(module, function)


def _label(pass_: RaytracePass, program: Program) -> str:
    return f"pass '{pass_.name}': program '{program.proc}' of '{program.file}'"


def _check_records(pass_: RaytracePass, used: list[UsedCode]) -> Iterator[Diagnostic]:
    for program, _, uses in used:
        hit = getattr(program, "type", None) in ("CLOSEST_HIT", "ANY_HIT")
        size = HIT_RECORD if hit else OTHER_RECORD
        if uses.record > size:
            yield warning(
                "T020",
                program.where("proc"),
                f"{_label(pass_, program)} reads up to byte {uses.record} of its record, which has "
                f"{size}",
            )


def _check_payloads(pass_: RaytracePass, used: list[UsedCode]) -> Iterator[Diagnostic]:
    sent = {words for _, _, uses in used for words in uses.sent}
    most = max(sent, default=0)
    for program, _, uses in used:
        label = _label(pass_, program)
        if uses.sent and max(uses.sent) > PAYLOAD_WORDS:
            yield warning(
                "T021",
                program.where("proc"),
                f"{label} sends {max(uses.sent)} words of payload: Nau's pipeline has "
                f"{PAYLOAD_WORDS}, so this runs in nau_py only",
            )
        if sent and uses.payload > most:
            yield warning(
                "T021",
                program.where("proc"),
                f"{label} uses word {uses.payload - 1} of the payload, but rays carry {most} words",
            )


def _check_old_payloads(pass_: RaytracePass, used: list[UsedCode]) -> Iterator[Diagnostic]:
    most = max((size for _, _, uses in used for size in uses.sent_bytes), default=0)
    for program, module, _ in used if most else []:
        for name, variable in find_named_variables(module, program.proc or "").items():
            if variable.semantic == "rtPayload" and variable.size > most:
                yield warning(
                    "T021",
                    program.where("proc"),
                    f"{_label(pass_, program)} has a payload '{name}' of {variable.size} bytes, "
                    f"but rays carry {most}",
                )


def _check_entries(pass_: RaytracePass) -> Iterator[Diagnostic]:
    """Find entries without a ray type or miss program that the default has (13.3, 63 and 64)."""
    types, default = pass_.ray_types, pass_.rtDefaultMaterial
    for entry in pass_.rtMaterialMap:
        has = [group.name for group in entry.rayTypes]
        lacking = [name for name in types if name not in has]
        if lacking:
            listed = ", ".join(f"'{name}'" for name in lacking)
            yield warning(
                "T022",
                entry.location,
                f"pass '{pass_.name}': material '{entry.to}' has no entry for ray type {listed}: "
                "such rays run no program on it; in Nau the records behind it would be shifted",
            )
        for name in has:
            wanted = default.program(name or "", MISS) if default else None
            if wanted is not None and entry.program(name or "", MISS) is None:
                yield warning(
                    "T022",
                    entry.location,
                    f"pass '{pass_.name}': material '{entry.to}' has no miss program of ray type "
                    f"'{name}': if its geometry is the first by name, misses run no program",
                )


def _check_parameters(project: Project, pass_: RaytracePass) -> Iterator[Diagnostic]:
    """Find addresses that are not at a multiple of their size (13.3, 67)."""
    at = 0
    for node in pass_.rtGlobalParams:
        size = value_bytes(project, node) or 4
        if node.component == "ID" and node.type in ("TEXTURE", "BUFFER") and at % 8:
            yield warning(
                "T023",
                node.location,
                f"pass '{pass_.name}': parameter '{node.name}' has 8 bytes and is at byte {at} of "
                "the block, which has no alignment: compilers expect it at a multiple of 8",
            )
        at += size

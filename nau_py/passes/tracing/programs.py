"""Programs of a raytrace pass: loaded from the files that the rule of trust allows."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from nau_py.model.raytrace import Program, RayMaterial, RaytracePass
from nau_py.passes.frame import Session
from nau_py.plugins import program_files
from nau_py.raytrace.programs.description import (
    ANY_HIT,
    CLOSEST_HIT,
    EXCEPTION,
    MISS,
    RAY_GENERATION,
)
from nau_py.raytrace.tracing.program_loader import BoundProgram, ProgramLoader, TrustRule
from nau_py.raytrace.tracing.scene_tables import ProgramTable

PINHOLE = Program(file="builtin", proc="pinhole")
"""Ray generation of a pass without one."""


@dataclass(frozen=True, slots=True)
class LoadedPrograms:
    """Programs of a pass: ray generation, exception, and the others by ray type and material."""

    generation: BoundProgram
    exception: BoundProgram | None
    table: ProgramTable


def make_trust_rule(session: Session) -> TrustRule:
    """Return the rule of the folders and files from which a project may load programs."""
    project, options = session.project, session.options
    package = Path(__file__).resolve().parents[2]
    folders = [project.folder, package]
    folders += [Path(lib.file).parent for lib in project.libraries if lib.file]
    folders += [Path(folder) for folder in options.allow_programs]
    files = tuple(program_files().values())
    return TrustRule(tuple(folders), options.no_programs, files)


def load_programs(
    pass_: RaytracePass,
    session: Session,
    materials: Sequence[tuple[str, RayMaterial | None]],
    provided: Mapping[tuple[str, str], Callable[..., Any]],
    label: str,
) -> LoadedPrograms:
    """Load the programs of a pass.

    ``materials``: name of each material of the scene, and the node with its programs;
    ``provided``: built-ins that the pass makes, by kind and name; ``label``: project and pass, for
    messages. Raises :class:`~nau_py.ProgramError`.
    """
    loader = ProgramLoader(session.project.folder, make_trust_rule(session), provided)
    entry = pass_.rtEntryPoint
    assert entry is not None
    generate = entry.rayGen or PINHOLE
    generation = loader.load(
        generate, f"{label}, ray generation program '{generate.proc}'", RAY_GENERATION
    )
    exception = None
    if entry.exception is not None:
        name = f"{label}, exception program '{entry.exception.proc}'"
        exception = loader.load(entry.exception, name, EXCEPTION)
    return LoadedPrograms(generation, exception, _load_table(pass_, loader, materials, label))


def _load_table(
    pass_: RaytracePass,
    loader: ProgramLoader,
    materials: Sequence[tuple[str, RayMaterial | None]],
    label: str,
) -> ProgramTable:
    """Load closest-hit and any-hit programs by ray type and material, and miss programs."""
    table: ProgramTable = {}
    for ray_type in pass_.ray_types:
        for kind in (CLOSEST_HIT, ANY_HIT):
            table[ray_type, kind] = [None] * len(materials)
        for index, (name, entry) in enumerate(materials):
            for kind in (CLOSEST_HIT, ANY_HIT):
                node = entry.program(ray_type, kind) if entry else None
                if node is not None:
                    text = (
                        f"{label}, material '{name}', {kind} program '{node.proc}' of "
                        f"ray type '{ray_type}'"
                    )
                    table[ray_type, kind][index] = loader.load(node, text, kind)
        default = pass_.rtDefaultMaterial
        miss = default.program(ray_type, MISS) if default else None
        if miss is not None:
            text = f"{label}, MISS program '{miss.proc}' of ray type '{ray_type}'"
            table[ray_type, MISS] = [loader.load(miss, text, MISS)]
    return table

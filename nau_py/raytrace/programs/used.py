"""The programs that a raytrace pass names, with their kinds."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from nau_py.model.raytrace import Program, RaytracePass
from nau_py.raytrace.programs.description import EXCEPTION, RAY_GENERATION
from nau_py.raytrace.programs.source import is_compiled


class UsedProgram(NamedTuple):
    """A program of a pass. ``owner``: its material and ray type in words, for messages."""

    program: Program
    kind: str
    owner: list[str]


def used_programs(pass_: RaytracePass) -> Iterator[UsedProgram]:
    """Yield every program that a pass can run.

    Geometry programs count only beside compiled ray generation: Python programs meet triangles.
    """
    entry = pass_.rtEntryPoint
    if entry is not None and entry.rayGen is not None:
        yield UsedProgram(entry.rayGen, RAY_GENERATION, [])
    if entry is not None and entry.exception is not None:
        yield UsedProgram(entry.exception, EXCEPTION, [])
    for material in pass_.materials:
        for group in material.rayTypes:
            owner = [f"material '{material.to or 'default'}'", f"ray type '{group.name}'"]
            for program in group.programs:
                yield UsedProgram(program, program.type or "", owner)
    if is_compiled(entry.rayGen if entry else None):
        for geometry in pass_.rtGeometryProgram:
            yield UsedProgram(geometry, geometry.type or "", [])

"""Common part of the two environments that compiled programs run in."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nau_py.model.raytrace import Program
from nau_py.raytrace.ptx.host.inputs import OutputTexels, PassSetup, PtxFrame
from nau_py.raytrace.ptx.host.programs import CompiledPrograms
from nau_py.raytrace.ptx.host.resources import ProgramResources
from nau_py.raytrace.ptx.runtime.launch import PtxLaunch, record_table, set_program
from nau_py.raytrace.ptx.runtime.native import NativeModule

Records = NDArray[np.uint8]
"""Records of one width, uint8 (count, bytes); see ``runtime.launch.record_table``."""


@dataclass(frozen=True, slots=True)
class BoundPrograms:
    """Programs of a pass in machine code, with the records of misses and of the context."""

    programs: CompiledPrograms
    types: list[str]
    misses: Records
    context: Records
    generate: tuple[NativeModule, int]
    exception: int

    @property
    def natives(self) -> list[NativeModule]:
        """Machine code of all modules that take part in a launch."""
        return list(self.programs.natives.values())


def bind_programs(
    setup: PassSetup,
    programs: CompiledPrograms,
    types: list[str],
    find_miss: Callable[[int], Program | None],
    miss_bytes: int,
    context_bytes: int,
) -> BoundPrograms:
    """Compile ray generation, exception and miss programs.

    ``find_miss``: miss program by index of the ray type; ``miss_bytes``, ``context_bytes``: size of
    the data in the records. Raises :class:`~nau_py.ProgramError`.
    """
    misses = record_table(len(types), miss_bytes)
    for index in range(len(types)):
        set_program(misses[index], "closest", programs.address(find_miss(index)))
    entry = setup.pass_.rtEntryPoint
    assert entry is not None
    assert entry.rayGen is not None
    begin = programs.address(entry.rayGen)
    return BoundPrograms(
        programs,
        types,
        misses,
        record_table(1, context_bytes),
        (programs.native(entry.rayGen), begin),
        programs.address(entry.exception),
    )


class LaunchEnvironment(ABC):
    """Geometry, records and parameters of a pass, kept from frame to frame."""

    bound: BoundPrograms

    def __init__(self, setup: PassSetup) -> None:
        self.setup = setup
        self.resources = ProgramResources(setup)

    @abstractmethod
    def bind(self, programs: CompiledPrograms) -> None:
        """Compile the programs and prepare records. Raises :class:`~nau_py.ProgramError`; the
        programs bound before then stay in use."""

    @abstractmethod
    def prepare_launch(self, frame: PtxFrame) -> PtxLaunch:
        """Write the parameters of a frame and return its launch."""

    @abstractmethod
    def collect_outputs(self, frame: PtxFrame) -> list[OutputTexels]:
        """Return the texels that programs wrote, in the order of ``frame.outputs``."""

    def notes(self) -> list[str]:
        """Return remarks for the report."""
        return []

    def find_nonfinite(self) -> NDArray[np.int64]:
        """Return the pixels of the first output that are not finite."""
        return np.zeros(0, np.int64)

    def make_launch(self, scene: int, hits: Records, size: tuple[int, int]) -> PtxLaunch:
        """Return a launch over ``size`` (width, height). ``scene``: Embree's handle, 0 for none."""
        bound = self.bound
        return PtxLaunch(
            bound.generate,
            scene,
            hits,
            bound.misses,
            bound.context,
            size,
            len(bound.types),
            bound.exception,
            flush=bound.programs.flushes,
        )

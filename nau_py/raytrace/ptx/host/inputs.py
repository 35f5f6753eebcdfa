"""Values that a pass hands to its compiled programs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.model.linked import Project
from nau_py.model.raytrace import RaytracePass, RayVariable
from nau_py.raytrace.tracing.program_loader import TrustRule
from nau_py.scene.camera import CameraState
from nau_py.scene.mapping import PassMaterials
from nau_py.scene.material import RenderMaterial
from nau_py.scene.world import World

FIRST_OUTPUT = "output0"
"""Variable of the first colour texture of the target."""


class GpuAccess(Protocol):
    """Access to textures, buffers and attribute values of a frame."""

    def read_texture(self, name: str) -> NDArray[Any] | None:
        """Read a texture: (layers, height, width, channels) of its own type; None if undefined."""
        ...

    def read_buffer(self, name: str) -> bytes | None:
        """Read a buffer; None if it is undefined."""
        ...

    def write_buffer(self, name: str, data: bytes) -> None:
        """Replace the content of a buffer."""
        ...

    def resolve_value(
        self, node: RayVariable, material: RenderMaterial | None
    ) -> NDArray[Any] | None:
        """Return the attribute value that ``node`` names, for ``material`` where it means one."""
        ...

    def report(self, finding: Diagnostic) -> None:
        """Add a finding to the run's diagnostics."""
        ...


@dataclass(frozen=True, slots=True)
class PassSetup:
    """Parts of a session that the programs of a pass keep from frame to frame."""

    project: Project
    pass_: RaytracePass
    world: World
    materials: PassMaterials
    trust: TrustRule


@dataclass(frozen=True, slots=True)
class OutputFormat:
    """A texture that programs write. ``name``: of the variable; ``dtype``: of the texels."""

    name: str
    height: int
    width: int
    channels: int
    dtype: type[np.generic]


@dataclass(frozen=True, slots=True)
class PtxFrame:
    """Values of one frame.

    ``width``, ``height``: launch indices, the pixels of the target; ``aspect``: width by height of
    the picture; ``outputs``: textures to write, the target's first; ``pixels``: int64, the selected
    launch indices, None for all; ``samples``: replaces RAYS_PER_PIXEL where it is given;
    ``threads``: 0 for one per core; ``effects``: the effects that the run or project asks for;
    ``progress(done, total)`` is called while the launch runs; ``end_stage(name)`` ends a stage of
    the time measurement.
    """

    index: int
    camera: CameraState
    width: int
    height: int
    aspect: float
    gpu: GpuAccess
    outputs: tuple[OutputFormat, ...]
    pixels: NDArray[np.int64] | None
    samples: int | None
    threads: int
    effects: str
    progress: Callable[[int, int], None]
    end_stage: Callable[[str], None]


@dataclass(frozen=True, slots=True)
class OutputTexels:
    """Texels that programs wrote, (height, width, channels), row 0 at the bottom.

    ``as_colours``: bytes stand for 0 to 1 and are converted to the format of the texture; otherwise
    they have the format of the texture, half floats as float32.
    """

    name: str
    texels: NDArray[Any]
    as_colours: bool

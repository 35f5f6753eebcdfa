"""``unoccluded``: the result of a shadow ray that meets nothing."""

from __future__ import annotations

from typing import Any

from nau_py.raytrace.kernels.core.jit import inner
from nau_py.raytrace.kernels.shading.radiance import add_radiance
from nau_py.raytrace.programs.description import MISS, BuiltInProgram


@inner
def add_one(scene: Any, tile: Any, path: Any) -> None:
    """Add 1 to every component."""
    add_radiance(tile, path, (1.0, 1.0, 1.0), 1.0)


PROGRAM = BuiltInProgram("unoccluded", MISS, "1: nothing was in the way.", add_one)

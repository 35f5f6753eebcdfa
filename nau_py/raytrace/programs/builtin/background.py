"""``background``: the clear colour of the render target."""

from __future__ import annotations

from typing import Any

from nau_py.raytrace.kernels.core.jit import inner
from nau_py.raytrace.kernels.core.tables import background_of
from nau_py.raytrace.kernels.shading.radiance import add_radiance, take_rgb
from nau_py.raytrace.programs.description import MISS, BuiltInProgram


@inner
def add_background(scene: Any, tile: Any, path: Any) -> None:
    """Add the clear colour, with its alpha."""
    b = background_of(scene)
    add_radiance(tile, path, take_rgb(b), b[3])


PROGRAM = BuiltInProgram(
    "background", MISS, "The clear colour of the render target.", add_background
)

"""``mirror``: perfect reflection."""

from __future__ import annotations

from typing import Any

from nau_py.raytrace.kernels.core.jit import inner
from nau_py.raytrace.kernels.core.tables import specular_of
from nau_py.raytrace.kernels.shading.radiance import add_coverage
from nau_py.raytrace.kernels.shading.scatter import continue_mirrored
from nau_py.raytrace.programs.description import CLOSEST_HIT, BuiltInProgram, Effect


@inner
def shade_mirror(scene: Any, tile: Any, ray_type: int, path: Any, hit: Any) -> bool:
    """Continue the path in the mirror direction, weighted by SPECULAR."""
    add_coverage(tile, path)
    return continue_mirrored(scene, path, hit, specular_of(hit.material))


PROGRAM = BuiltInProgram(
    "mirror",
    CLOSEST_HIT,
    "SPECULAR times what the mirror direction sees.",
    shade_mirror,
    effects=(Effect("reflection", ("SPECULAR",), chain=True),),
)

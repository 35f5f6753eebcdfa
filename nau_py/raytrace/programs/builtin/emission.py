"""``emission``: the EMISSION colour."""

from __future__ import annotations

from typing import Any

from nau_py.raytrace.kernels.core.jit import inner
from nau_py.raytrace.kernels.shading.emitters import add_emission
from nau_py.raytrace.kernels.shading.radiance import add_coverage
from nau_py.raytrace.programs.description import CLOSEST_HIT, BuiltInProgram


@inner
def shade_emission(scene: Any, tile: Any, ray_type: int, path: Any, hit: Any) -> bool:
    """Add EMISSION."""
    add_emission(scene, tile, path, hit.material, hit.face)
    add_coverage(tile, path)
    return False


PROGRAM = BuiltInProgram("emission", CLOSEST_HIT, "The EMISSION colour.", shade_emission)

"""``direct``: diffuse surfaces lit by every light of the pass."""

from __future__ import annotations

from typing import Any

from nau_py.raytrace.kernels.core.jit import inner
from nau_py.raytrace.kernels.core.tables import emission_of
from nau_py.raytrace.kernels.shading.closest_hit import evaluate_albedo, shadow_origin
from nau_py.raytrace.kernels.shading.lights import reflect_diffuse, sample_lights
from nau_py.raytrace.kernels.shading.radiance import add_radiance
from nau_py.raytrace.programs.description import CLOSEST_HIT, BuiltInProgram, LightUse


@inner
def shade_direct(scene: Any, tile: Any, ray_type: int, path: Any, hit: Any) -> bool:
    """Add EMISSION, and the light of each light."""
    albedo = evaluate_albedo(scene, hit)
    origin = shadow_origin(scene, hit)
    add_radiance(tile, path, emission_of(hit.material), 1.0)
    sample_lights(scene, tile, ray_type, path, origin, hit.normal, reflect_diffuse, albedo)
    return False


PROGRAM = BuiltInProgram(
    "direct",
    CLOSEST_HIT,
    "DIFFUSE times texture, lit by every light of the pass by its SHAPE, with shadows.",
    shade_direct,
    lights=LightUse.ALL,
)

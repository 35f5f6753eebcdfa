"""``path``: diffuse path tracing."""

from __future__ import annotations

from typing import Any

from nau_py.raytrace.kernels.core.jit import V3, inner
from nau_py.raytrace.kernels.shading.closest_hit import evaluate_albedo, shadow_origin
from nau_py.raytrace.kernels.shading.emitters import add_emission, sample_emitters
from nau_py.raytrace.kernels.shading.lights import reflect_diffuse, sample_lights
from nau_py.raytrace.kernels.shading.radiance import add_coverage
from nau_py.raytrace.kernels.shading.scatter import continue_diffusely
from nau_py.raytrace.programs.description import CLOSEST_HIT, BuiltInProgram, Effect, LightUse


@inner
def light_diffuse_surface(
    scene: Any, tile: Any, ray_type: int, path: Any, hit: Any, albedo: V3
) -> bool:
    """Add the light of a diffuse surface. Return True if the path continues from it."""
    origin, normal = shadow_origin(scene, hit), hit.normal
    sample_lights(scene, tile, ray_type, path, origin, normal, reflect_diffuse, albedo)
    if path.depth >= scene.max_depth:
        return False
    sample_emitters(scene, tile, ray_type, path, origin, normal, reflect_diffuse, albedo)
    return continue_diffusely(scene, path, hit, albedo)


@inner
def shade_path(scene: Any, tile: Any, ray_type: int, path: Any, hit: Any) -> bool:
    """Add EMISSION and light; continue the path in a cosine-weighted direction."""
    add_coverage(tile, path)
    add_emission(scene, tile, path, hit.material, hit.face)
    albedo = evaluate_albedo(scene, hit)
    return light_diffuse_surface(scene, tile, ray_type, path, hit, albedo)


PROGRAM = BuiltInProgram(
    "path",
    CLOSEST_HIT,
    "Diffuse path tracing: EMISSION, the pass's lights, emissive triangles by next-event "
    "estimation with multiple importance sampling, Russian roulette from depth 4.",
    shade_path,
    effects=(Effect("indirect", recursive=True),),
    lights=LightUse.EMITTERS,
)

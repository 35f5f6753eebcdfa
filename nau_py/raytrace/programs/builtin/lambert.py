"""``lambert``: Nau's default material; and the shading that Phong's models share with it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from nau_py.raytrace.kernels.core.jit import V3, inner
from nau_py.raytrace.kernels.core.sampling import sample_2d
from nau_py.raytrace.kernels.core.tables import RECTANGLE, diffuse_of, emission_of, light_at
from nau_py.raytrace.kernels.core.vec import add, dot, multiply, normalize, scale
from nau_py.raytrace.kernels.intersect.embree import INFINITE
from nau_py.raytrace.kernels.shading.closest_hit import evaluate_colour, shadow_origin
from nau_py.raytrace.kernels.shading.lights import (
    LIGHT_DIMENSION,
    count_light_samples,
    sample_light,
)
from nau_py.raytrace.kernels.shading.radiance import add_light, add_radiance, take_rgb
from nau_py.raytrace.programs.description import CLOSEST_HIT, BuiltInProgram, LightUse

AMBIENT_FACTOR = 0.3


@inner
def shade_default(
    scene: Any,
    tile: Any,
    ray_type: int,
    path: Any,
    hit: Any,
    add_highlight: Callable[[V3, Any, V3, V3], V3],
) -> None:
    """Shade by the first light, with shadows if the pass has a ray type for them.

    Nau's default material (docs/format.md, 8.5). ``add_highlight(lit, hit, to_light, colour)``
    adds a highlight to the light that arrives. A light with a shape is the mean over its points.
    """
    material, texel = hit.material, evaluate_colour(scene, hit)
    origin = shadow_origin(scene, hit)
    diffuse = take_rgb(diffuse_of(material))
    rest = scale(diffuse, AMBIENT_FACTOR)
    if material.texture >= 0:
        rest = (AMBIENT_FACTOR, AMBIENT_FACTOR, AMBIENT_FACTOR)
    add_radiance(tile, path, multiply(add(rest, emission_of(material)), texel), 1.0)
    if scene.lights_count == 0:
        return
    light = light_at(scene.lights, 0)
    samples = count_light_samples(scene, light)
    for k in range(samples):
        number = np.uint32(path.sample * samples + k)
        dimension = np.uint32(LIGHT_DIMENSION + path.depth * 64)
        x, y = 0.5, 0.5
        if light.shape >= RECTANGLE:
            x, y = sample_2d(scene.seed, path.pixel, number, dimension)
        to, distance, colour = sample_light(light, origin, x, y)
        to_light = normalize(to)
        cosine = dot(hit.normal, to_light)
        if not (distance > 0.0 and cosine > 0.0):
            continue
        colour = scale(colour, 1.0 / samples)
        lit = multiply(scale(multiply(diffuse, colour), cosine), texel)
        lit = add_highlight(lit, hit, to_light, colour)
        if scene.shadow_type < 0:
            add_radiance(tile, path, lit, 0.0)
        else:
            tmax = 1.0 if distance < INFINITE else INFINITE
            add_light(scene, tile, ray_type, path, 0, origin, to, tmax, lit)


@inner
def add_no_highlight(lit: V3, hit: Any, to_light: V3, colour: V3) -> V3:
    """Return the light as it is."""
    return lit


@inner
def shade_lambert(scene: Any, tile: Any, ray_type: int, path: Any, hit: Any) -> bool:
    """Add diffuse light."""
    shade_default(scene, tile, ray_type, path, hit, add_no_highlight)
    return False


PROGRAM = BuiltInProgram(
    "lambert",
    CLOSEST_HIT,
    "The default look: diffuse by the first light, with shadow rays where the pass has a "
    "ray type called Shadow, plus 0.3 of the diffuse colour, times the texture of unit 0.",
    shade_lambert,
    lights=LightUse.FIRST,
)

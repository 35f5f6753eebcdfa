"""Emissive triangles as lights: next-event estimation with multiple importance sampling."""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt
from typing import Any

from nau_py.raytrace.kernels.core.jit import V3, inner
from nau_py.raytrace.kernels.core.memory import f64, i32
from nau_py.raytrace.kernels.core.sampling import sample_2d
from nau_py.raytrace.kernels.core.tables import INDIRECT, emission_of, heading_of, material_at
from nau_py.raytrace.kernels.core.vec import (
    add,
    cross,
    dot,
    multiply,
    normalize,
    scale,
    subtract,
)
from nau_py.raytrace.kernels.geometry.surface import load_corner, locate_point, offset_origin
from nau_py.raytrace.kernels.intersect.counters import is_skipped
from nau_py.raytrace.kernels.shading.radiance import add_light, add_radiance
from nau_py.raytrace.kernels.shading.scatter import INVERSE_PI, SECOND, THIRD, hit_dimension


@inner
def sample_emitter(scene: Any, choice: float, x: float, y: float) -> tuple[int, V3, V3, float]:
    """Sample a point of the emissive triangles. Return triangle, point, unit normal and density
    over area."""
    low, high = 0, scene.emitters_count - 1
    while low < high:  # the last entry whose cumulative power does not exceed the choice
        middle = (low + high + 1) // 2
        if f64(scene.emitter_cdf, middle) <= choice:
            low = middle
        else:
            high = middle - 1
    triangle = i32(scene.emitters, low)
    root = sqrt(x)
    u, v = root * (1.0 - y), root * y
    a, b = load_corner(scene, triangle, 0), load_corner(scene, triangle, 1)
    c = load_corner(scene, triangle, 2)
    p = add(a, add(scale(subtract(b, a), u), scale(subtract(c, a), v)))
    n = normalize(cross(subtract(b, a), subtract(c, a)))
    return triangle, p, n, f64(scene.emitter_pdf, triangle)


@inner
def weigh_strategies(a: float, b: float) -> float:
    """Return the weight of the strategy of density ``a`` against that of ``b``: the power
    heuristic (Veach 1997, 9.2.4)."""
    if not a > 0.0:
        return 0.0
    r = b / a
    return 1.0 / (1.0 + r * r)


@inner
def add_emission(scene: Any, tile: Any, path: Any, material: Any, face: V3) -> None:
    """Add EMISSION, weighted against light sampling if that can also find the direction (multiple
    importance sampling, Veach 1997)."""
    e = emission_of(material)
    if e[0] == 0.0 and e[1] == 0.0 and e[2] == 0.0:
        return
    if scene.caustics == 0 and path.scattered != 0 and path.pdf == 0.0:
        return
    weight = 1.0
    area = f64(scene.emitter_pdf, path.triangle)
    if path.pdf > 0.0 and area > 0.0:
        distance = float(path.travelled) + float(path.t)
        cosine = max(abs(dot(face, heading_of(path))), 1e-7)
        weight = weigh_strategies(float(path.pdf), area * distance * distance / cosine)
    add_radiance(tile, path, scale(e, weight), 0.0)


@inner
def sample_emitters(
    scene: Any,
    tile: Any,
    ray_type: int,
    path: Any,
    origin: V3,
    normal: V3,
    reflect: Callable[[Any, V3, float], V3],
    lobe: Any,
) -> None:
    """Add the light of a sampled emissive triangle, weighted against a cosine-weighted direction.

    ``reflect`` and ``lobe``: as for ``sample_lights``.
    """
    if scene.emitters_count == 0:
        return
    x, y = sample_2d(scene.seed, path.pixel, path.sample, hit_dimension(path, SECOND))
    choice, _ = sample_2d(scene.seed, path.pixel, path.sample, hit_dimension(path, THIRD))
    triangle, target, n, area = sample_emitter(scene, choice, x, y)
    if triangle == path.triangle:
        return
    # the far end is lifted off the lamp, too: a ray to it must not meet it
    lift = locate_point(scene, triangle, 0.0, 0.0)[2]
    target = offset_origin(target, n, 2.0 * lift, subtract(origin, target))
    to = subtract(target, origin)
    distance2 = dot(to, to)
    if not distance2 > 0.0:
        return
    inverse = 1.0 / sqrt(distance2)
    near, far = dot(normal, to) * inverse, abs(dot(n, to)) * inverse
    if not (near > 0.0 and far > 0.0):
        return
    pdf = area * distance2 / far
    factor = near / pdf
    if not is_skipped(scene, INDIRECT):
        factor *= weigh_strategies(pdf, near * INVERSE_PI)
    emission = emission_of(material_at(scene.materials, i32(scene.owner, triangle)))
    brdf = scale(reflect(lobe, to, sqrt(distance2)), INVERSE_PI)
    brought = scale(multiply(brdf, emission), factor)
    add_light(scene, tile, ray_type, path, scene.lights_count, origin, to, 1.0, brought)

"""What stands in a ray's way: any-hit programs, and shadow rays."""

from __future__ import annotations

from math import isfinite
from typing import Any

import numpy as np

from nau_py.raytrace.kernels.core.codes import ALPHA_TEST, NONE, ONE_SIDED, STOCHASTIC_ALPHA
from nau_py.raytrace.kernels.core.jit import V3, inner, read_cycles
from nau_py.raytrace.kernels.core.memory import i8, i32, i64, put_i64
from nau_py.raytrace.kernels.core.sampling import sample_1d
from nau_py.raytrace.kernels.core.tables import (
    CONTINUATION,
    CUT,
    DECIDED,
    IN_EMBREE,
    NONFINITE,
    USER,
    diffuse_of,
    material_at,
)
from nau_py.raytrace.kernels.core.vec import dot
from nau_py.raytrace.kernels.geometry.surface import evaluate_alpha, locate_point, offset_origin
from nau_py.raytrace.kernels.intersect.embree import ask, blocked, hit, nearest, whose

ALPHA_THRESHOLD = 0.25
MAX_LAYERS = 256
"""Hits that one ray may pass through after Embree found them; reaching it is reported."""
FAINT = 1e-6
"""Transmittance that counts as none."""


@inner
def count(tile: Any, slot: int) -> None:
    """Add one to a counter."""
    put_i64(tile.counts, slot, i64(tile.counts, slot) + 1)


@inner
def spent(tile: Any, since: int) -> None:
    """Note the cycles since ``since`` as those of rays."""
    put_i64(tile.counts, IN_EMBREE, i64(tile.counts, IN_EMBREE) + read_cycles() - since)


@inner
def skips(scene: Any, kind: int) -> bool:
    """Whether rays of a kind are not sent."""
    return (scene.skipped >> kind) & 1 != 0


@inner
def finite(v: V3) -> bool:
    return isfinite(v[0]) and isfinite(v[1]) and isfinite(v[2])


@inner
def opacity(
    scene: Any,
    ray_type: int,
    triangle: int,
    u: float,
    v: float,
    direction: V3,
    pixel: np.uint32,
    sample: np.uint32,
    depth: int,
) -> float:
    """How much of a ray the built-in any-hit program of a hit stops, 0 to 1.

    Chance is keyed by the triangle, so that an answer does not depend on the order of the hits.
    """
    owner = i32(scene.owner, triangle)
    code = i8(scene.any_hit, ray_type * scene.material_count + owner)
    if code == NONE or code == USER:
        return 1.0
    if code == ONE_SIDED:
        return 1.0 if dot(locate_point(scene, triangle, u, v)[1], direction) < 0.0 else 0.0
    material = material_at(scene.materials, owner)
    alpha = evaluate_alpha(scene, material, triangle, u, v)
    if code == ALPHA_TEST:
        return 1.0 if alpha > ALPHA_THRESHOLD else 0.0
    alpha = min(max(alpha * diffuse_of(material)[3], 0.0), 1.0)
    if code == STOCHASTIC_ALPHA:
        key = np.uint32(0x40000000 + triangle * 32 + min(depth, 31))
        return 1.0 if sample_1d(scene.seed, pixel, sample, key) < alpha else 0.0
    return alpha


@inner
def sound(tile: Any, origin: V3, direction: V3) -> bool:
    """Whether a ray may be sent to Embree; one that is not finite, or goes nowhere, is counted."""
    if finite(origin) and finite(direction) and dot(direction, direction) > 0.0:
        return True
    count(tile, NONFINITE)
    return False


@inner
def visibility(
    scene: Any,
    tile: Any,
    ray_type: int,
    origin: V3,
    direction: V3,
    tmax: float,
    pixel: np.uint32,
    sample: np.uint32,
    depth: int,
) -> float:
    """The part of the light along a sound ray that arrives, 0 to 1. ``tmax`` in lengths of
    ``direction``. A ray that passes more half-transparent hits than the limit is blocked, and
    counted."""
    ray, query = tile.ray, ask(scene, tile, ray_type, 0)
    whose(tile, 0, pixel, sample, depth)
    if i8(scene.has_any_hit, ray_type) <= DECIDED:
        return 0.0 if blocked(scene, ray, query, origin, direction, tmax) else 1.0
    through = 1.0
    for _ in range(MAX_LAYERS):
        triangle = nearest(scene, ray, query, origin, direction, tmax)
        if triangle < 0:
            return through
        t, u, v = hit(ray)
        stopped = opacity(scene, ray_type, triangle, u, v, direction, pixel, sample, depth)
        through *= 1.0 - stopped
        if through < FAINT:
            return 0.0
        p, n, bound = locate_point(scene, triangle, u, v)
        origin = offset_origin(p, n, bound, direction)
        tmax = max(tmax - t, 0.0)
        count(tile, CONTINUATION)
    count(tile, CUT)
    return 0.0


@inner
def shadow_type_of(scene: Any, ray_type: int) -> int:
    """The ray type that asks for shadows; without one, the ray's own."""
    return int(scene.shadow_type) if scene.shadow_type >= 0 else ray_type

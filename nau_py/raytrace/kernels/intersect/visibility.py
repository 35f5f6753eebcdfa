"""Visibility: the built-in any-hit programs of a hit, and the transmittance along a ray."""

from __future__ import annotations

from typing import Any

import numpy as np

from nau_py.raytrace.kernels.core.jit import V3, inner
from nau_py.raytrace.kernels.core.kernel_tables import ANY_HIT_KERNELS, NONE, USER
from nau_py.raytrace.kernels.core.memory import i8, i32
from nau_py.raytrace.kernels.core.tables import (
    CONTINUATION,
    CUT,
    DECIDED,
    material_at,
)
from nau_py.raytrace.kernels.geometry.surface import locate_point, offset_origin
from nau_py.raytrace.kernels.intersect.counters import (
    increment_counter,
)
from nau_py.raytrace.kernels.intersect.embree import (
    intersect_closest,
    is_occluded,
    key_lane,
    prepare_query,
    read_hit,
)

_run_program = ANY_HIT_KERNELS.run
MAX_LAYERS = 256
"""Most partly transparent hits that one ray passes; reaching the limit is reported."""
FAINT = 1e-6
"""Transmittance below which a ray counts as blocked."""


@inner
def evaluate_opacity(
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
    """Return the part of a ray that the built-in any-hit program of a hit stops, 0 to 1."""
    owner = i32(scene.owner, triangle)
    code = i8(scene.any_hit, ray_type * scene.material_count + owner)
    if code == NONE or code == USER:
        return 1.0
    material = material_at(scene.materials, owner)
    stopped = _run_program(code, scene, material, triangle, u, v, direction, pixel, sample, depth)
    return float(stopped)


@inner
def trace_visibility(
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
    """Return the part of the light that arrives along a ray that passed ``check_ray``, 0 to 1.

    ``tmax`` is in lengths of ``direction``. A ray that passes more partly transparent hits than
    MAX_LAYERS is blocked and counted as CUT.
    """
    ray, query = tile.ray, prepare_query(scene, tile, ray_type, 0)
    key_lane(tile, 0, pixel, sample, depth)
    if i8(scene.has_any_hit, ray_type) <= DECIDED:
        return 0.0 if is_occluded(scene, ray, query, origin, direction, tmax) else 1.0
    through = 1.0
    for _ in range(MAX_LAYERS):
        triangle = intersect_closest(scene, ray, query, origin, direction, tmax)
        if triangle < 0:
            return through
        t, u, v = read_hit(ray)
        stopped = evaluate_opacity(scene, ray_type, triangle, u, v, direction, pixel, sample, depth)
        through *= 1.0 - stopped
        if through < FAINT:
            return 0.0
        p, n, bound = locate_point(scene, triangle, u, v)
        origin = offset_origin(p, n, bound, direction)
        tmax = max(tmax - t, 0.0)
        increment_counter(tile, CONTINUATION)
    increment_counter(tile, CUT)
    return 0.0


@inner
def shadow_ray_type(scene: Any, ray_type: int) -> int:
    """Return the ray type of shadow rays; without one, that of the ray itself."""
    return int(scene.shadow_type) if scene.shadow_type >= 0 else ray_type

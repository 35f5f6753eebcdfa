"""Intersection of arrays of rays that come from Python."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.kernels.core.jit import V3, inner, kernel
from nau_py.raytrace.kernels.core.tables import LANES
from nau_py.raytrace.kernels.intersect.counters import is_finite
from nau_py.raytrace.kernels.intersect.embree import (
    RAY_FLOATS,
    initialize_rays,
    intersect_closest,
    is_occluded,
    read_hit,
)

F32 = NDArray[np.float32]
I32 = NDArray[np.int32]


@inner
def read_vector(values: Any, i: int) -> V3:
    """Read row ``i`` of an array (n, 3)."""
    return float(values[i, 0]), float(values[i, 1]), float(values[i, 2])


@kernel
def initialize_tile(tiles: Any) -> None:
    """Initialize the single ray and the packet of a tile."""
    initialize_rays(tiles[0].ray, 1)
    initialize_rays(tiles[0].packet, LANES)


@kernel
def intersect_rays(
    scenes: Any,
    origin: F32,
    direction: F32,
    tmax: F32,
    triangle: I32,
    u: F32,
    v: F32,
    t: F32,
) -> None:
    """Find the closest hits of rays (n, 3); ``tmax`` has one entry, or one a ray.

    ``triangle`` gets -1 for a miss, and for a ray that is not finite.
    """
    ray = np.empty(RAY_FLOATS, np.float32)
    initialize_rays(ray.ctypes.data, 1)
    for i in range(origin.shape[0]):
        limit = float(tmax[i if tmax.shape[0] > 1 else 0])
        o, d = read_vector(origin, i), read_vector(direction, i)
        triangle[i] = -1
        if is_finite(o) and is_finite(d):
            triangle[i] = intersect_closest(scenes[0], ray.ctypes.data, np.uint64(0), o, d, limit)
        if triangle[i] >= 0:
            t[i], u[i], v[i] = read_hit(ray.ctypes.data)


@kernel
def find_occluded_rays(
    scenes: Any, origin: F32, direction: F32, tmax: F32, found: NDArray[np.bool_]
) -> None:
    """Set ``found`` (n,) for rays that hit anything before ``tmax``."""
    ray = np.empty(RAY_FLOATS, np.float32)
    initialize_rays(ray.ctypes.data, 1)
    for i in range(origin.shape[0]):
        limit = float(tmax[i if tmax.shape[0] > 1 else 0])
        o, d = read_vector(origin, i), read_vector(direction, i)
        if is_finite(o) and is_finite(d):
            found[i] = is_occluded(scenes[0], ray.ctypes.data, np.uint64(0), o, d, limit)

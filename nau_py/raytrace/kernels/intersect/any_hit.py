"""The any-hit programs that Embree asks while it traces.

They stop a ray or let it pass, for each candidate by itself, so that a ray finds its hit in one go
however many it ignores. What lets a part of the light through is asked afterwards, in the order of
the hits (``visibility.py``, ``bundle.py``).
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from nau_py.raytrace.kernels.core.codes import NONE, TRANSPARENCY
from nau_py.raytrace.kernels.core.jit import callback
from nau_py.raytrace.kernels.core.memory import (
    f32,
    i8,
    i32,
    i64,
    put_f32,
    put_i32,
    put_i64,
    record_reader,
)
from nau_py.raytrace.kernels.core.tables import CONTINUATION, QUERY, SCENE, USER
from nau_py.raytrace.kernels.intersect.embree import (
    CONTEXT,
    DEPTH,
    DIRECTION,
    ID,
    IGNORED,
    PIXEL,
    SAMPLE,
    TFAR,
)
from nau_py.raytrace.kernels.intersect.visibility import opacity

_query_at, _scene_at = record_reader(QUERY), record_reader(SCENE)
_VALID, _IGNORED = -1, 0
SAME = 1e-6
"""Relative difference of distances of what counts as one layer."""


def _decide(arguments: Any) -> None:
    """An RTCFilterFunctionN: takes candidates that are ignored out of the valid ones.

    ``arguments``: address of RTCFilterFunctionNArguments (rtcore_geometry.h): valid, user pointer,
    context, RTCRayN, RTCHitN, N.
    """
    valid, ray = np.uint64(i64(arguments, 0)), np.uint64(i64(arguments, 3))
    candidate = np.uint64(i64(arguments, 4))
    asked = np.uint64(i64(arguments, 2) - CONTEXT)
    query = _query_at(asked, 0)
    scene = _scene_at(query.scene, 0)
    n = i32(arguments, 10)
    last, code = -1, NONE
    for lane in range(n):
        if i32(valid, lane) != _VALID:
            continue
        triangle = i32(candidate, 5 * n + lane) + query.first
        if triangle != last:
            last = triangle
            at = query.ray_type * scene.material_count + i32(scene.owner, triangle)
            code = i8(scene.any_hit, at)
        if code == NONE or code == TRANSPARENCY or code == USER:
            continue
        u, v = f32(candidate, 3 * n + lane), f32(candidate, 4 * n + lane)
        k = DIRECTION * n + lane
        direction = (f32(ray, k), f32(ray, k + n), f32(ray, k + 2 * n))
        own = i32(ray, ID * n + lane)
        pixel, sample = np.uint32(i32(asked, PIXEL + own)), np.uint32(i32(asked, SAMPLE + own))
        depth = i32(asked, DEPTH + own)
        stopped = opacity(scene, query.ray_type, triangle, u, v, direction, pixel, sample, depth)
        if stopped <= 0.0:
            put_i32(valid, lane, _IGNORED)
            distance, last = f32(ray, TFAR * n + lane), f32(asked, IGNORED + own)
            if abs(distance - last) > SAME * distance:  # an edge of two triangles counts once
                put_i64(query.counts, CONTINUATION, i64(query.counts, CONTINUATION) + 1)
            put_f32(asked, IGNORED + own, distance)


@lru_cache(maxsize=1)
def filter_address() -> int:
    """Where the compiled filter stands, for the QUERY."""
    return callback(_decide)

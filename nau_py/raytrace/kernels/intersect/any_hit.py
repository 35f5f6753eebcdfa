"""The built-in any-hit programs that Embree calls during traversal, as its filter function.

Programs that either stop a ray or let it pass run here, once a candidate hit, so that one traversal
finds the hit however many candidates are ignored. Programs that let a part of the light pass run
after traversal, in the order of the hits (``visibility.py``, ``path/run_programs.py``).
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from nau_py.raytrace.kernels.core.jit import callback
from nau_py.raytrace.kernels.core.kernel_tables import NONE, PARTIAL
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
from nau_py.raytrace.kernels.core.tables import CONTINUATION, QUERY, SCENE
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
from nau_py.raytrace.kernels.intersect.visibility import evaluate_opacity

_query_at, _scene_at = record_reader(QUERY), record_reader(SCENE)
_VALID, _IGNORED = -1, 0
SAME = 1e-6
"""Relative difference of distances below which two ignored hits count as one layer."""


def _filter_candidates(arguments: Any) -> None:
    """Invalidate the candidate hits that any-hit programs ignore (an RTCFilterFunctionN).

    ``arguments``: address of RTCFilterFunctionNArguments (rtcore_geometry.h): valid, user pointer,
    context, RTCRayN, RTCHitN, N.
    """
    valid, ray = np.uint64(i64(arguments, 0)), np.uint64(i64(arguments, 3))
    candidate = np.uint64(i64(arguments, 4))
    address = np.uint64(i64(arguments, 2) - CONTEXT)
    query = _query_at(address, 0)
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
        if code == NONE or code >= PARTIAL:
            continue
        u, v = f32(candidate, 3 * n + lane), f32(candidate, 4 * n + lane)
        k = DIRECTION * n + lane
        direction = (f32(ray, k), f32(ray, k + n), f32(ray, k + 2 * n))
        own = i32(ray, ID * n + lane)
        pixel, sample = np.uint32(i32(address, PIXEL + own)), np.uint32(i32(address, SAMPLE + own))
        depth = i32(address, DEPTH + own)
        stopped = evaluate_opacity(
            scene, query.ray_type, triangle, u, v, direction, pixel, sample, depth
        )
        if stopped <= 0.0:
            put_i32(valid, lane, _IGNORED)
            distance, previous = f32(ray, TFAR * n + lane), f32(address, IGNORED + own)
            if abs(distance - previous) > SAME * distance:  # an edge of two triangles counts once
                put_i64(query.counts, CONTINUATION, i64(query.counts, CONTINUATION) + 1)
            put_f32(address, IGNORED + own, distance)


@lru_cache(maxsize=1)
def filter_address() -> int:
    """Return the address of the compiled filter function, for the QUERY."""
    return callback(_filter_candidates)

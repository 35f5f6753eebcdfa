"""Rays through Embree's C functions, called from compiled code: one by one, or in packets.

The symbols are found by name: ``raytrace/tracing/accelerator.py`` loads the library before any
kernel runs.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import types

from nau_py.raytrace.kernels.core.jit import V3, inner
from nau_py.raytrace.kernels.core.memory import f32, i8, i32, put_f32, put_i32, put_i64
from nau_py.raytrace.kernels.core.tables import LANES, NOTHING, QUERY

_SINGLE = types.void(types.uintp, types.uintp, types.uintp)
_PACKET = types.void(types.uintp, types.uintp, types.uintp, types.uintp)
rtcIntersect1 = types.ExternalFunction("rtcIntersect1", _SINGLE)
rtcOccluded1 = types.ExternalFunction("rtcOccluded1", _SINGLE)
rtcIntersect16 = types.ExternalFunction("rtcIntersect16", _PACKET)
rtcOccluded16 = types.ExternalFunction("rtcOccluded16", _PACKET)
INVALID = -1
"""RTC_INVALID_GEOMETRY_ID, as an int32."""
RAY_FLOATS = 32
"""Size of the ray buffer, float32: RTCRayHit with room to spare."""
INFINITE = float("inf")
FILTER, COHERENT = 1 << 1, 1 << 16
"""RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER and RTC_RAY_QUERY_FLAG_COHERENT."""
# Rows of RTCRayHit (rtcore_ray.h); a packet has LANES entries a row.
TNEAR, DIRECTION, TIME, TFAR, MASK, ID, FLAGS = 3, 4, 7, 8, 9, 10, 11
U, V, PRIMITIVE, GEOMETRY, INSTANCE, INSTANCE_PRIMITIVE = 15, 16, 17, 18, 19, 20
MIN_LANES = 6
"""Below so many rays, a packet takes longer than the rays one by one (measured)."""
NARROW = 0.99**2
"""Squared cosine to the first ray: what is wider takes longer in a packet (measured)."""


def _place(name: str) -> int:
    assert QUERY.fields is not None
    return int(QUERY.fields[name][1])


CONTEXT = _place("instance")
_RAY_TYPE, _FIRST = _place("ray_type") // 8, _place("first") // 8
PIXEL, SAMPLE, DEPTH = _place("pixel") // 4, _place("sample") // 4, _place("depth") // 4
IGNORED = _place("ignored") // 4
"""Places in a QUERY, by words of the size of what stands there."""


@inner
def blank(ray: int, lanes: int) -> None:
    """Set what is the same for all rays of a packet of ``lanes`` (1 for a single ray)."""
    for lane in range(lanes):
        put_f32(ray, TNEAR * lanes + lane, 0.0)
        put_f32(ray, TIME * lanes + lane, 0.0)
        put_i32(ray, MASK * lanes + lane, -1)
        put_i32(ray, ID * lanes + lane, lane)
        put_i32(ray, FLAGS * lanes + lane, 0)
        put_i32(ray, INSTANCE * lanes + lane, INVALID)
        put_i32(ray, INSTANCE_PRIMITIVE * lanes + lane, INVALID)


@inner
def fill(ray: int, lanes: int, lane: int, origin: V3, direction: V3, tmax: float) -> None:
    """Write a ray without a hit into a blank packet of ``lanes``."""
    for k in range(3):
        put_f32(ray, k * lanes + lane, origin[k])
        put_f32(ray, (DIRECTION + k) * lanes + lane, direction[k])
    put_f32(ray, TFAR * lanes + lane, tmax)
    put_i32(ray, GEOMETRY * lanes + lane, INVALID)


@inner
def ask(scene: Any, tile: Any, ray_type: int, flags: int) -> Any:
    """The address of Embree's arguments for rays of a type; 0 where the defaults do."""
    if i8(scene.has_any_hit, ray_type) != NOTHING:
        flags |= FILTER
    if flags == 0:
        return np.uint64(0)
    put_i32(tile.query, 0, flags)
    put_i64(tile.query, _RAY_TYPE, ray_type)
    return tile.query


@inner
def whose(tile: Any, lane: int, pixel: Any, sample: Any, depth: int) -> None:
    """Note whose ray is in a lane: chance in any-hit programs is keyed by that."""
    put_i32(tile.query, PIXEL + lane, pixel)
    put_i32(tile.query, SAMPLE + lane, sample)
    put_i32(tile.query, DEPTH + lane, depth)
    put_f32(tile.query, IGNORED + lane, -1.0)


@inner
def _first(query: Any, triangle: int) -> None:
    if query != 0:
        put_i64(query, _FIRST, triangle)


@inner
def nearest(scene: Any, ray: int, query: Any, origin: V3, direction: V3, tmax: float) -> int:
    """The first triangle that a finite ray hits, or -1; ``hit`` then tells t, u and v.

    What stands still and what moves lie in two scenes: the nearer hit counts, at equal distance
    the moving one.
    """
    found = -1
    fill(ray, 1, 0, origin, direction, tmax)
    if scene.standing != 0:
        _first(query, 0)
        rtcIntersect1(scene.standing, ray, query)
        if i32(ray, GEOMETRY) != INVALID:
            found = i32(ray, PRIMITIVE)
    if scene.moving != 0:
        put_i32(ray, GEOMETRY, INVALID)
        _first(query, scene.first_moving)
        rtcIntersect1(scene.moving, ray, query)
        if i32(ray, GEOMETRY) != INVALID:
            found = i32(ray, PRIMITIVE) + scene.first_moving
    # beyond about 1e18 Embree's distances overflow: such a hit is none
    return found if f32(ray, TFAR) < INFINITE else -1


@inner
def hit(ray: int) -> V3:
    """Distance and barycentrics of the hit that ``nearest`` found."""
    return f32(ray, TFAR), f32(ray, U), f32(ray, V)


@inner
def blocked(scene: Any, ray: int, query: Any, origin: V3, direction: V3, tmax: float) -> bool:
    """Whether a finite ray hits anything before ``tmax``. Embree says so by tfar = -inf."""
    if scene.standing != 0:
        fill(ray, 1, 0, origin, direction, tmax)
        _first(query, 0)
        rtcOccluded1(scene.standing, ray, query)
        if f32(ray, TFAR) < 0.0:
            return True
    if scene.moving != 0:
        fill(ray, 1, 0, origin, direction, tmax)
        _first(query, scene.first_moving)
        rtcOccluded1(scene.moving, ray, query)
        return bool(f32(ray, TFAR) < 0.0)
    return False


@inner
def narrow(packet: int, count: int) -> bool:
    """Whether a packet's first ``count`` rays are enough, and close enough, to be traced together.

    All directions must lie in one octant: Embree's frustum of wider ones is not watertight.
    """
    if count < MIN_LANES:
        return False
    x, y, z = (
        row(packet, DIRECTION, 0),
        row(packet, DIRECTION + 1, 0),
        row(packet, DIRECTION + 2, 0),
    )
    length2 = x * x + y * y + z * z
    for lane in range(1, count):
        a, b = row(packet, DIRECTION, lane), row(packet, DIRECTION + 1, lane)
        c = row(packet, DIRECTION + 2, lane)
        if (a < 0.0) != (x < 0.0) or (b < 0.0) != (y < 0.0) or (c < 0.0) != (z < 0.0):
            return False
        along = a * x + b * y + c * z
        if not (along > 0.0 and along * along >= NARROW * length2 * (a * a + b * b + c * c)):
            return False
    return True


@inner
def row(packet: int, which: int, lane: int) -> float:
    """An entry of a packet."""
    return f32(packet, which * LANES + lane)


@inner
def _enable(valid: int, count: int) -> None:
    for lane in range(LANES):
        put_i32(valid, lane, -1 if lane < count else 0)


@inner
def nearest_packet(scene: Any, tile: Any, query: Any, count: int) -> None:
    """``nearest`` for the first ``count`` rays of the tile's packet: the packet's PRIMITIVE tells
    the triangles."""
    packet = tile.packet
    _enable(tile.valid, count)
    for lane in range(count):
        put_i32(packet, PRIMITIVE * LANES + lane, -1)
    if scene.standing != 0:
        _first(query, 0)
        rtcIntersect16(tile.valid, scene.standing, packet, query)
    if scene.moving != 0:
        for lane in range(count):
            put_i32(packet, GEOMETRY * LANES + lane, INVALID)
        _first(query, scene.first_moving)
        rtcIntersect16(tile.valid, scene.moving, packet, query)
        for lane in range(count):
            if i32(packet, GEOMETRY * LANES + lane) != INVALID:
                triangle = i32(packet, PRIMITIVE * LANES + lane) + scene.first_moving
                put_i32(packet, PRIMITIVE * LANES + lane, triangle)
    for lane in range(count):
        if not row(packet, TFAR, lane) < INFINITE:
            put_i32(packet, PRIMITIVE * LANES + lane, -1)


@inner
def blocked_packet(scene: Any, tile: Any, query: Any, count: int) -> None:
    """``blocked`` for the first ``count`` rays of the tile's packet: their tfar is then below 0."""
    _enable(tile.valid, count)
    if scene.standing != 0:
        _first(query, 0)
        rtcOccluded16(tile.valid, scene.standing, tile.packet, query)
    if scene.moving != 0:
        for lane in range(count):
            if row(tile.packet, TFAR, lane) < 0.0:
                put_i32(tile.valid, lane, 0)
        _first(query, scene.first_moving)
        rtcOccluded16(tile.valid, scene.moving, tile.packet, query)

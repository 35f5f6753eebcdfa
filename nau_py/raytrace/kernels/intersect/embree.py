"""Embree's C functions, called from compiled code for single rays and for packets of LANES rays.

The linker finds the symbols by name: ``raytrace/tracing/accelerator.py`` loads the library before
any kernel runs.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from nau_py.raytrace.kernels.core.jit import V3, external, inner
from nau_py.raytrace.kernels.core.memory import f32, i8, i32, put_f32, put_i32, put_i64
from nau_py.raytrace.kernels.core.tables import LANES, NOTHING, QUERY

rtcIntersect1, rtcOccluded1 = external("rtcIntersect1", 3), external("rtcOccluded1", 3)
rtcIntersect16, rtcOccluded16 = external("rtcIntersect16", 4), external("rtcOccluded16", 4)
INVALID = -1
"""RTC_INVALID_GEOMETRY_ID, as an int32."""
RAY_FLOATS = 32
"""Size of a ray buffer in float32: an RTCRayHit is smaller."""
INFINITE = float("inf")
FILTER, COHERENT = 1 << 1, 1 << 16
"""RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER and RTC_RAY_QUERY_FLAG_COHERENT."""
# Rows of RTCRayHit (rtcore_ray.h); a packet has LANES entries a row.
TNEAR, DIRECTION, TIME, TFAR, MASK, ID, FLAGS = 3, 4, 7, 8, 9, 10, 11
U, V, PRIMITIVE, GEOMETRY, INSTANCE, INSTANCE_PRIMITIVE = 15, 16, 17, 18, 19, 20
MIN_LANES = 6
"""Fewest rays for which a packet is faster than single rays (measured)."""
MIN_COSINE2 = 0.99**2
"""Least squared cosine to the first ray for which a packet is faster (measured)."""


def _offset(name: str) -> int:
    """Return the byte offset of a field of a QUERY."""
    assert QUERY.fields is not None
    return int(QUERY.fields[name][1])


CONTEXT = _offset("instance")
_RAY_TYPE, _FIRST = _offset("ray_type") // 8, _offset("first") // 8
PIXEL, SAMPLE, DEPTH = _offset("pixel") // 4, _offset("sample") // 4, _offset("depth") // 4
IGNORED = _offset("ignored") // 4
"""Offsets in a QUERY, in units of the size of the field's entries."""


@inner
def initialize_rays(ray: int, lanes: int) -> None:
    """Set the fields that no ray changes, in a packet of ``lanes`` (1 for a single ray)."""
    for lane in range(lanes):
        put_f32(ray, TNEAR * lanes + lane, 0.0)
        put_f32(ray, TIME * lanes + lane, 0.0)
        put_i32(ray, MASK * lanes + lane, -1)
        put_i32(ray, ID * lanes + lane, lane)
        put_i32(ray, FLAGS * lanes + lane, 0)
        put_i32(ray, INSTANCE * lanes + lane, INVALID)
        put_i32(ray, INSTANCE_PRIMITIVE * lanes + lane, INVALID)


@inner
def write_ray(ray: int, lanes: int, lane: int, origin: V3, direction: V3, tmax: float) -> None:
    """Write a ray without a hit into an initialized packet of ``lanes``."""
    for k in range(3):
        put_f32(ray, k * lanes + lane, origin[k])
        put_f32(ray, (DIRECTION + k) * lanes + lane, direction[k])
    put_f32(ray, TFAR * lanes + lane, tmax)
    put_i32(ray, GEOMETRY * lanes + lane, INVALID)


@inner
def prepare_query(scene: Any, tile: Any, ray_type: int, flags: int) -> Any:
    """Return the address of Embree's arguments for a ray type; 0 selects Embree's defaults."""
    if i8(scene.has_any_hit, ray_type) != NOTHING:
        flags |= FILTER
    if flags == 0:
        return np.uint64(0)
    put_i32(tile.query, 0, flags)
    put_i64(tile.query, _RAY_TYPE, ray_type)
    return tile.query


@inner
def key_lane(tile: Any, lane: int, pixel: Any, sample: Any, depth: int) -> None:
    """Record the path of a packet lane; any-hit random numbers are keyed by it."""
    put_i32(tile.query, PIXEL + lane, pixel)
    put_i32(tile.query, SAMPLE + lane, sample)
    put_i32(tile.query, DEPTH + lane, depth)
    put_f32(tile.query, IGNORED + lane, -1.0)


@inner
def _set_first_triangle(query: Any, triangle: int) -> None:
    """Set the index that the first triangle of the Embree scene has in the tables."""
    if query != 0:
        put_i64(query, _FIRST, triangle)


@inner
def intersect_closest(
    scene: Any, ray: int, query: Any, origin: V3, direction: V3, tmax: float
) -> int:
    """Return the first triangle that a finite ray hits, or -1; ``read_hit`` returns t, u and v.

    Static and moving triangles form two Embree scenes. The nearer hit counts, at equal distance
    the moving one.
    """
    found = -1
    write_ray(ray, 1, 0, origin, direction, tmax)
    if scene.standing != 0:
        _set_first_triangle(query, 0)
        rtcIntersect1(scene.standing, ray, query)
        if i32(ray, GEOMETRY) != INVALID:
            found = i32(ray, PRIMITIVE)
    if scene.moving != 0:
        put_i32(ray, GEOMETRY, INVALID)
        _set_first_triangle(query, scene.first_moving)
        rtcIntersect1(scene.moving, ray, query)
        if i32(ray, GEOMETRY) != INVALID:
            found = i32(ray, PRIMITIVE) + scene.first_moving
    # Embree's distances overflow beyond about 1e18: such a hit counts as a miss
    return found if f32(ray, TFAR) < INFINITE else -1


@inner
def read_hit(ray: int) -> V3:
    """Return t, u and v of the hit that ``intersect_closest`` found."""
    return f32(ray, TFAR), f32(ray, U), f32(ray, V)


@inner
def is_occluded(scene: Any, ray: int, query: Any, origin: V3, direction: V3, tmax: float) -> bool:
    """Test if a finite ray hits anything before ``tmax``. Embree then sets tfar to -inf."""
    if scene.standing != 0:
        write_ray(ray, 1, 0, origin, direction, tmax)
        _set_first_triangle(query, 0)
        rtcOccluded1(scene.standing, ray, query)
        if f32(ray, TFAR) < 0.0:
            return True
    if scene.moving != 0:
        write_ray(ray, 1, 0, origin, direction, tmax)
        _set_first_triangle(query, scene.first_moving)
        rtcOccluded1(scene.moving, ray, query)
        return bool(f32(ray, TFAR) < 0.0)
    return False


@inner
def is_coherent(packet: int, count: int) -> bool:
    """Test if the first ``count`` rays of a packet are traced faster together than one by one.

    All directions must lie in one octant: Embree's frustum of wider packets is not watertight.
    """
    if count < MIN_LANES:
        return False
    x, y, z = (
        read_row(packet, DIRECTION, 0),
        read_row(packet, DIRECTION + 1, 0),
        read_row(packet, DIRECTION + 2, 0),
    )
    length2 = x * x + y * y + z * z
    for lane in range(1, count):
        a, b = read_row(packet, DIRECTION, lane), read_row(packet, DIRECTION + 1, lane)
        c = read_row(packet, DIRECTION + 2, lane)
        if (a < 0.0) != (x < 0.0) or (b < 0.0) != (y < 0.0) or (c < 0.0) != (z < 0.0):
            return False
        along = a * x + b * y + c * z
        if not (along > 0.0 and along * along >= MIN_COSINE2 * length2 * (a * a + b * b + c * c)):
            return False
    return True


@inner
def read_row(packet: int, field: int, lane: int) -> float:
    """Read a field (row) of one lane of a packet."""
    return f32(packet, field * LANES + lane)


@inner
def _enable_lanes(valid: int, count: int) -> None:
    """Enable the first ``count`` lanes."""
    for lane in range(LANES):
        put_i32(valid, lane, -1 if lane < count else 0)


@inner
def intersect_packet(scene: Any, tile: Any, query: Any, count: int) -> None:
    """Do ``intersect_closest`` for the first ``count`` rays of the tile's packet. Writes the
    triangles to the packet's PRIMITIVE row."""
    packet = tile.packet
    _enable_lanes(tile.valid, count)
    for lane in range(count):
        put_i32(packet, PRIMITIVE * LANES + lane, -1)
    if scene.standing != 0:
        _set_first_triangle(query, 0)
        rtcIntersect16(tile.valid, scene.standing, packet, query)
    if scene.moving != 0:
        for lane in range(count):
            put_i32(packet, GEOMETRY * LANES + lane, INVALID)
        _set_first_triangle(query, scene.first_moving)
        rtcIntersect16(tile.valid, scene.moving, packet, query)
        for lane in range(count):
            if i32(packet, GEOMETRY * LANES + lane) != INVALID:
                triangle = i32(packet, PRIMITIVE * LANES + lane) + scene.first_moving
                put_i32(packet, PRIMITIVE * LANES + lane, triangle)
    for lane in range(count):
        if not read_row(packet, TFAR, lane) < INFINITE:
            put_i32(packet, PRIMITIVE * LANES + lane, -1)


@inner
def occlude_packet(scene: Any, tile: Any, query: Any, count: int) -> None:
    """Do ``is_occluded`` for the first ``count`` rays of the tile's packet. The tfar of occluded
    rays is then below 0."""
    _enable_lanes(tile.valid, count)
    if scene.standing != 0:
        _set_first_triangle(query, 0)
        rtcOccluded16(tile.valid, scene.standing, tile.packet, query)
    if scene.moving != 0:
        for lane in range(count):
            if read_row(tile.packet, TFAR, lane) < 0.0:
                put_i32(tile.valid, lane, 0)
        _set_first_triangle(query, scene.first_moving)
        rtcOccluded16(tile.valid, scene.moving, tile.packet, query)

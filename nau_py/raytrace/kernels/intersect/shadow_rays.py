"""Shadow rays: collected while a bundle is shaded, then traced together, light by light."""

from __future__ import annotations

from typing import Any

import numpy as np

from nau_py.raytrace.kernels.core.jit import V3, inner, read_cycles
from nau_py.raytrace.kernels.core.memory import f32, i8, i32, i64, put_f32, put_i64
from nau_py.raytrace.kernels.core.tables import (
    DECIDED,
    LANES,
    SHADOW,
    SHADOWS,
    light_of,
    ray_heading_of,
    ray_origin_of,
    set_light,
    set_ray_heading,
    set_ray_origin,
    shadow_at,
)
from nau_py.raytrace.kernels.intersect.embree import (
    COHERENT,
    DEPTH,
    DIRECTION,
    PIXEL,
    SAMPLE,
    TFAR,
    ask,
    blocked_packet,
    fill,
    narrow,
    row,
    whose,
)
from nau_py.raytrace.kernels.intersect.visibility import (
    count,
    shadow_type_of,
    sound,
    spent,
    visibility,
)


@inner
def see(scene: Any, tile: Any, ray_type: int, lanes: int) -> None:
    """What the first ``lanes`` rays of the packet see, 0 to 1, into ``tile.seen``."""
    packet, begun = tile.packet, read_cycles()
    if i8(scene.has_any_hit, ray_type) <= DECIDED and narrow(packet, lanes):
        blocked_packet(scene, tile, ask(scene, tile, ray_type, COHERENT), lanes)
        for lane in range(lanes):
            put_f32(tile.seen, lane, 0.0 if row(packet, TFAR, lane) < 0.0 else 1.0)
        spent(tile, begun)
        return
    for lane in range(lanes):
        origin = (row(packet, 0, lane), row(packet, 1, lane), row(packet, 2, lane))
        direction = (
            row(packet, DIRECTION, lane),
            row(packet, DIRECTION + 1, lane),
            row(packet, DIRECTION + 2, lane),
        )
        pixel = np.uint32(i32(tile.query, PIXEL + lane))
        sample = np.uint32(i32(tile.query, SAMPLE + lane))
        depth = i32(tile.query, DEPTH + lane)
        seen = visibility(
            scene, tile, ray_type, origin, direction, row(packet, TFAR, lane), pixel, sample, depth
        )
        put_f32(tile.seen, lane, seen)
    spent(tile, begun)


@inner
def collect(
    scene: Any,
    tile: Any,
    ray_type: int,
    path: Any,
    source: int,
    origin: V3,
    direction: V3,
    tmax: float,
    light: V3,
) -> None:
    """Add ``light`` to the result of ``path`` as far as a ray from ``origin`` gets through."""
    if not sound(tile, origin, direction):
        return
    if tile.pending == SHADOWS:
        flush(scene, tile, ray_type)
    entry = shadow_at(tile.shadows, tile.pending)
    tile.pending += 1
    set_ray_origin(entry, origin)
    set_ray_heading(entry, direction)
    set_light(entry, light)
    entry.tmax = tmax
    entry.index = path.index
    entry.pixel = path.pixel
    entry.sample = path.sample
    entry.depth = path.depth
    entry.source = source


@inner
def flush(scene: Any, tile: Any, ray_type: int) -> None:
    """Trace what was collected, and add what arrives. Rays to one light go together."""
    todo = tile.pending
    tile.pending = 0
    asks = shadow_type_of(scene, ray_type)
    left, source = todo, 0
    while left > 0:
        lanes = 0
        for k in range(todo):
            entry = shadow_at(tile.shadows, k)
            if entry.source != source:
                continue
            origin, direction = ray_origin_of(entry), ray_heading_of(entry)
            fill(tile.packet, LANES, lanes, origin, direction, float(entry.tmax))
            whose(tile, lanes, entry.pixel, entry.sample, entry.depth)
            put_i64(tile.lanes, lanes, k)
            count(tile, SHADOW)
            left -= 1
            lanes += 1
            if lanes == LANES:
                _arrive(scene, tile, asks, lanes)
                lanes = 0
        if lanes > 0:
            _arrive(scene, tile, asks, lanes)
        source += 1


@inner
def _arrive(scene: Any, tile: Any, asks: int, lanes: int) -> None:
    see(scene, tile, asks, lanes)
    for lane in range(lanes):
        seen = f32(tile.seen, lane)
        if seen > 0.0:
            entry = shadow_at(tile.shadows, i64(tile.lanes, lane))
            light, at = light_of(entry), 4 * entry.index
            for k in range(3):
                put_f32(tile.radiance, at + k, f32(tile.radiance, at + k) + light[k] * seen)

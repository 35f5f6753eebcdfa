"""Shadow rays: collected while a packet is shaded, then traced together, light by light."""

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
from nau_py.raytrace.kernels.intersect.counters import (
    add_ray_cycles,
    check_ray,
    increment_counter,
)
from nau_py.raytrace.kernels.intersect.embree import (
    COHERENT,
    DEPTH,
    DIRECTION,
    PIXEL,
    SAMPLE,
    TFAR,
    is_coherent,
    key_lane,
    occlude_packet,
    prepare_query,
    read_row,
    write_ray,
)
from nau_py.raytrace.kernels.intersect.visibility import (
    shadow_ray_type,
    trace_visibility,
)


@inner
def trace_packet_visibility(scene: Any, tile: Any, ray_type: int, lanes: int) -> None:
    """Write the visibility (0 to 1) of the first ``lanes`` rays of the packet to ``tile.seen``."""
    packet, begun = tile.packet, read_cycles()
    if i8(scene.has_any_hit, ray_type) <= DECIDED and is_coherent(packet, lanes):
        occlude_packet(scene, tile, prepare_query(scene, tile, ray_type, COHERENT), lanes)
        for lane in range(lanes):
            put_f32(tile.seen, lane, 0.0 if read_row(packet, TFAR, lane) < 0.0 else 1.0)
        add_ray_cycles(tile, begun)
        return
    for lane in range(lanes):
        origin = (read_row(packet, 0, lane), read_row(packet, 1, lane), read_row(packet, 2, lane))
        direction = (
            read_row(packet, DIRECTION, lane),
            read_row(packet, DIRECTION + 1, lane),
            read_row(packet, DIRECTION + 2, lane),
        )
        pixel = np.uint32(i32(tile.query, PIXEL + lane))
        sample = np.uint32(i32(tile.query, SAMPLE + lane))
        depth = i32(tile.query, DEPTH + lane)
        seen = trace_visibility(
            scene,
            tile,
            ray_type,
            origin,
            direction,
            read_row(packet, TFAR, lane),
            pixel,
            sample,
            depth,
        )
        put_f32(tile.seen, lane, seen)
    add_ray_cycles(tile, begun)


@inner
def collect_shadow_ray(
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
    """Queue a shadow ray. Its visibility times ``light`` is added to the result of ``path``."""
    if not check_ray(tile, origin, direction):
        return
    if tile.pending == SHADOWS:
        trace_shadow_rays(scene, tile, ray_type)
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
def trace_shadow_rays(scene: Any, tile: Any, ray_type: int) -> None:
    """Trace the queued shadow rays, those to one light together, and add the light that arrives."""
    pending = tile.pending
    tile.pending = 0
    shadow_type = shadow_ray_type(scene, ray_type)
    left, source = pending, 0
    while left > 0:
        lanes = 0
        for k in range(pending):
            entry = shadow_at(tile.shadows, k)
            if entry.source != source:
                continue
            origin, direction = ray_origin_of(entry), ray_heading_of(entry)
            write_ray(tile.packet, LANES, lanes, origin, direction, float(entry.tmax))
            key_lane(tile, lanes, entry.pixel, entry.sample, entry.depth)
            put_i64(tile.lanes, lanes, k)
            increment_counter(tile, SHADOW)
            left -= 1
            lanes += 1
            if lanes == LANES:
                _add_unoccluded_light(scene, tile, shadow_type, lanes)
                lanes = 0
        if lanes > 0:
            _add_unoccluded_light(scene, tile, shadow_type, lanes)
        source += 1


@inner
def _add_unoccluded_light(scene: Any, tile: Any, ray_type: int, lanes: int) -> None:
    """Trace the shadow rays in the first ``lanes`` lanes and add the light that arrives."""
    trace_packet_visibility(scene, tile, ray_type, lanes)
    for lane in range(lanes):
        seen = f32(tile.seen, lane)
        if seen > 0.0:
            entry = shadow_at(tile.shadows, i64(tile.lanes, lane))
            light, at = light_of(entry), 4 * entry.index
            for k in range(3):
                put_f32(tile.radiance, at + k, f32(tile.radiance, at + k) + light[k] * seen)

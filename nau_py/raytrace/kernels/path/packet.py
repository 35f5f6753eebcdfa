"""A packet: up to LANES paths that are followed together until they end or Python must continue.

Rays that stay close to each other, as those of one pixel do, are traced in Embree's packets. The
result of a path depends on that path alone, and packets are made by pixel, so that pictures do not
depend on the tile size.
"""

from __future__ import annotations

from typing import Any

from nau_py.raytrace.kernels.core.jit import inner, read_cycles
from nau_py.raytrace.kernels.core.memory import f32, i8, i32, i64, put_i64
from nau_py.raytrace.kernels.core.tables import (
    AMBIENT,
    CONTINUATION,
    LANES,
    MISSED,
    PYTHON,
    SHADOW,
    SKIPPED,
    TRACE,
    copy_path,
    heading_of,
    origin_of,
    path_at,
    set_weight,
    weight_of,
)
from nau_py.raytrace.kernels.intersect.counters import (
    add_ray_cycles,
    check_ray,
    increment_counter,
    is_skipped,
)
from nau_py.raytrace.kernels.intersect.embree import (
    COHERENT,
    PRIMITIVE,
    TFAR,
    U,
    V,
    intersect_closest,
    intersect_packet,
    is_coherent,
    key_lane,
    prepare_query,
    read_hit,
    read_row,
    write_ray,
)
from nau_py.raytrace.kernels.intersect.shadow_rays import trace_packet_visibility, trace_shadow_rays
from nau_py.raytrace.kernels.path.run_programs import handle_escaped_ray, run_hit_programs


@inner
def load_lane(tile: Any, path: Any, lane: int, index: int) -> None:
    """Write the ray of path ``index`` of the packet into an Embree lane."""
    write_ray(tile.packet, LANES, lane, origin_of(path), heading_of(path), float(path.tmax))
    key_lane(tile, lane, path.pixel, path.sample, path.depth)
    put_i64(tile.lanes, lane, index)


@inner
def intersect_paths(scene: Any, tile: Any, ray_type: int, lanes: int) -> None:
    """Intersect the rays in the lanes; write triangle, t, u and v to their paths."""
    if is_coherent(tile.packet, lanes):
        intersect_packet(scene, tile, prepare_query(scene, tile, ray_type, COHERENT), lanes)
        for lane in range(lanes):
            path = path_at(tile.work, i64(tile.lanes, lane))
            path.triangle = i32(tile.packet, PRIMITIVE * LANES + lane)
            path.t = read_row(tile.packet, TFAR, lane)
            path.u, path.v = read_row(tile.packet, U, lane), read_row(tile.packet, V, lane)
        return
    query = prepare_query(scene, tile, ray_type, 0)
    for lane in range(lanes):
        path = path_at(tile.work, i64(tile.lanes, lane))
        key_lane(tile, 0, path.pixel, path.sample, path.depth)
        path.triangle = intersect_closest(
            scene, tile.ray, query, origin_of(path), heading_of(path), float(path.tmax)
        )
        path.t, path.u, path.v = read_hit(tile.ray)


@inner
def trace_visibility_paths(scene: Any, tile: Any, ray_type: int, size: int) -> None:
    """Trace a packet of a ray type without closest-hit programs: only visibility is computed."""
    lanes = 0
    for index in range(size):
        path = path_at(tile.work, index)
        if is_skipped(scene, int(path.kind)):
            increment_counter(tile, SKIPPED + int(path.kind))
            handle_escaped_ray(scene, tile, ray_type, path)
        elif check_ray(tile, origin_of(path), heading_of(path)):
            increment_counter(tile, int(path.kind))
            load_lane(tile, path, lanes, index)
            lanes += 1
    if lanes == 0:
        return
    trace_packet_visibility(scene, tile, ray_type, lanes)
    for lane in range(lanes):
        seen = f32(tile.seen, lane)
        if seen > 0.0:
            path = path_at(tile.work, i64(tile.lanes, lane))
            w = weight_of(path)
            set_weight(path, (w[0] * seen, w[1] * seen, w[2] * seen, w[3] * seen))
            handle_escaped_ray(scene, tile, ray_type, path)


@inner
def advance_packet(scene: Any, tile: Any, ray_type: int, size: int) -> int:
    """Trace and shade the packet's ``size`` paths once. Return the number of paths that continue;
    they are moved to the front."""
    lanes = 0
    for index in range(size):
        path = path_at(tile.work, index)
        if path.status != TRACE:
            continue
        path.triangle = -1
        visibility = i8(scene.visibility, ray_type) != 0
        kind = int(path.kind)
        if path.layers == 0 and is_skipped(scene, kind):
            increment_counter(tile, SKIPPED + kind)
            if kind != SHADOW and kind != AMBIENT:
                path.status = MISSED
            continue
        too_deep = path.depth > scene.max_depth and not visibility
        if too_deep or not check_ray(tile, origin_of(path), heading_of(path)):
            path.status = MISSED
        else:
            increment_counter(tile, kind if path.layers == 0 else CONTINUATION)
            load_lane(tile, path, lanes, index)
            lanes += 1
    if lanes > 0:
        begun = read_cycles()
        intersect_paths(scene, tile, ray_type, lanes)
        add_ray_cycles(tile, begun)
    alive = 0
    for index in range(size):
        path = path_at(tile.work, index)
        if path.status != MISSED and run_hit_programs(scene, tile, ray_type, path):
            if alive < index:
                copy_path(path_at(tile.work, alive), path)
            alive += 1
    trace_shadow_rays(scene, tile, ray_type)
    return alive


@inner
def trace_packet(scene: Any, tile: Any, ray_type: int, size: int) -> None:
    """Follow the ``size`` paths in ``tile.work``, and paths that split off them, to their ends."""
    if i8(scene.visibility, ray_type) != 0 and i8(scene.has_any_hit, ray_type) < PYTHON:
        trace_visibility_paths(scene, tile, ray_type, size)
        return
    tile.top = 0
    tile.pending = 0
    while size > 0:
        while size > 0:
            size = advance_packet(scene, tile, ray_type, size)
        size = min(int(tile.top), LANES)
        for index in range(size):
            tile.top -= 1
            copy_path(path_at(tile.work, index), path_at(tile.stack, tile.top))

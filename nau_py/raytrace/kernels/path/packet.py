"""A bundle: up to LANES paths that are followed together until they end or Python must answer.

Rays that stay close to each other, as those of one pixel do, are traced in packets. What a bundle
brings depends on its own paths alone, so bundles, which are made by pixel, are what keeps pictures
the same for any tile size.
"""

from __future__ import annotations

from typing import Any

from nau_py.raytrace.kernels.core.codes import BACKGROUND, NONE, TRANSPARENCY, UNOCCLUDED
from nau_py.raytrace.kernels.core.jit import inner, read_cycles
from nau_py.raytrace.kernels.core.memory import f32, i8, i32, i64, put_i32, put_i64
from nau_py.raytrace.kernels.core.tables import (
    AMBIENT,
    CANDIDATE,
    CONTINUATION,
    CUT,
    HIT,
    LANES,
    MISSED,
    PRIMARY,
    PYTHON,
    SHADE,
    SHADOW,
    SKIPPED,
    STACK,
    TRACE,
    USER,
    background_of,
    copy_path,
    heading_of,
    media_of,
    origin_of,
    path_at,
    set_weight,
    weight_of,
)
from nau_py.raytrace.kernels.intersect.embree import (
    COHERENT,
    PRIMITIVE,
    TFAR,
    U,
    V,
    ask,
    fill,
    hit,
    narrow,
    nearest,
    nearest_packet,
    row,
    whose,
)
from nau_py.raytrace.kernels.intersect.shadow_rays import flush, see
from nau_py.raytrace.kernels.intersect.visibility import (
    MAX_LAYERS,
    count,
    opacity,
    skips,
    sound,
    spent,
)
from nau_py.raytrace.kernels.shading.closest_hit import evaluate_material
from nau_py.raytrace.kernels.shading.direct import add_radiance, defer_path, take_rgb
from nau_py.raytrace.kernels.shading.sample_bsdf import apply_absorption, pass_hit


@inner
def missed(scene: Any, tile: Any, ray_type: int, path: Any) -> None:
    """Run the miss program of the ray type."""
    code = i8(scene.miss, ray_type)
    if code == USER:
        defer_path(tile, path, MISSED)
    elif code == BACKGROUND:
        b = background_of(scene)
        add_radiance(tile, path, take_rgb(b), b[3])
    elif code == UNOCCLUDED:
        add_radiance(tile, path, (1.0, 1.0, 1.0), 1.0)
    elif path.initial != 0.0:
        initial = float(path.initial)
        add_radiance(tile, path, (initial, initial, initial), initial)


@inner
def split(scene: Any, tile: Any, path: Any, stopped: float) -> None:
    """Part of the path goes on behind the hit, the part ``stopped`` is shaded."""
    rest = path_at(tile.stack, tile.top)
    copy_path(rest, path)
    tile.top += 1
    w, on = weight_of(path), 1.0 - stopped
    set_weight(rest, (w[0] * on, w[1] * on, w[2] * on, w[3] * on))
    set_weight(path, (w[0] * stopped, w[1] * stopped, w[2] * stopped, w[3] * stopped))
    pass_hit(scene, rest)


@inner
def board(tile: Any, path: Any, lane: int, which: int) -> None:
    """Put the ray of path ``which`` of the bundle into a lane of the packet."""
    fill(tile.packet, LANES, lane, origin_of(path), heading_of(path), float(path.tmax))
    whose(tile, lane, path.pixel, path.sample, path.depth)
    put_i64(tile.lanes, lane, which)


@inner
def shoot(scene: Any, tile: Any, ray_type: int, lanes: int) -> None:
    """Trace the rays in the lanes; their paths get triangle, t, u and v."""
    if narrow(tile.packet, lanes):
        nearest_packet(scene, tile, ask(scene, tile, ray_type, COHERENT), lanes)
        for lane in range(lanes):
            path = path_at(tile.work, i64(tile.lanes, lane))
            path.triangle = i32(tile.packet, PRIMITIVE * LANES + lane)
            path.t = row(tile.packet, TFAR, lane)
            path.u, path.v = row(tile.packet, U, lane), row(tile.packet, V, lane)
        return
    query = ask(scene, tile, ray_type, 0)
    for lane in range(lanes):
        path = path_at(tile.work, i64(tile.lanes, lane))
        whose(tile, 0, path.pixel, path.sample, path.depth)
        path.triangle = nearest(
            scene, tile.ray, query, origin_of(path), heading_of(path), float(path.tmax)
        )
        path.t, path.u, path.v = hit(tile.ray)


@inner
def any_hit(scene: Any, tile: Any, ray_type: int, path: Any) -> bool:
    """Ask what Embree did not: Python's programs, and those that stop a part. Returns whether the
    hit stands; else the path is deferred, or on its way behind it."""
    at = ray_type * scene.material_count + i32(scene.owner, path.triangle)
    code = i8(scene.any_hit, at)
    if code != USER and code != TRANSPARENCY:
        return True
    if path.layers >= MAX_LAYERS:
        count(tile, CUT)
        return True
    if code == USER:
        defer_path(tile, path, CANDIDATE)
        return False
    stopped = opacity(
        scene, ray_type, int(path.triangle), float(path.u), float(path.v), heading_of(path),
        path.pixel, path.sample, int(path.depth),
    )  # fmt: skip
    if stopped <= 0.0:
        pass_hit(scene, path)
        return False
    if stopped < 1.0 and tile.top < STACK:
        split(scene, tile, path, stopped)
    return True


@inner
def arrive(scene: Any, tile: Any, ray_type: int, path: Any) -> bool:
    """Miss, any hit or closest hit of a traced ray. Returns whether the path goes on."""
    if path.status == TRACE:
        if path.triangle < 0:
            missed(scene, tile, ray_type, path)
            return False
        m = media_of(path)
        if max(m[0], m[1], m[2], m[3]) >= 0:
            apply_absorption(scene, path)
        layers = path.layers
        if not any_hit(scene, tile, ray_type, path):
            return bool(path.layers > layers)
    at = ray_type * scene.material_count + i32(scene.owner, path.triangle)
    code = i8(scene.closest, at)
    if code == NONE:
        return False
    if path.kind == PRIMARY:
        put_i32(tile.viewed, i32(scene.owner, path.triangle), 1)
    if code == USER:
        defer_path(tile, path, HIT)
        return False
    path.status = SHADE
    return evaluate_material(scene, tile, ray_type, code, path)


@inner
def look(scene: Any, tile: Any, ray_type: int, size: int) -> None:
    """A bundle that asks for visibility only, with any-hit programs that are compiled."""
    lanes = 0
    for which in range(size):
        path = path_at(tile.work, which)
        if skips(scene, int(path.kind)):
            count(tile, SKIPPED + int(path.kind))
            missed(scene, tile, ray_type, path)
        elif sound(tile, origin_of(path), heading_of(path)):
            count(tile, int(path.kind))
            board(tile, path, lanes, which)
            lanes += 1
    if lanes == 0:
        return
    see(scene, tile, ray_type, lanes)
    for lane in range(lanes):
        seen = f32(tile.seen, lane)
        if seen > 0.0:
            path = path_at(tile.work, i64(tile.lanes, lane))
            w = weight_of(path)
            set_weight(path, (w[0] * seen, w[1] * seen, w[2] * seen, w[3] * seen))
            missed(scene, tile, ray_type, path)


@inner
def step(scene: Any, tile: Any, ray_type: int, size: int) -> int:
    """Trace and shade the bundle's ``size`` paths once. Returns how many go on; they come first."""
    lanes = 0
    for which in range(size):
        path = path_at(tile.work, which)
        if path.status != TRACE:
            continue
        path.triangle = -1
        asks = i8(scene.visibility, ray_type) != 0
        kind = int(path.kind)
        if path.layers == 0 and skips(scene, kind):
            count(tile, SKIPPED + kind)
            if kind != SHADOW and kind != AMBIENT:
                path.status = MISSED
            continue
        too_deep = path.depth > scene.max_depth and not asks
        if too_deep or not sound(tile, origin_of(path), heading_of(path)):
            path.status = MISSED
        else:
            count(tile, kind if path.layers == 0 else CONTINUATION)
            board(tile, path, lanes, which)
            lanes += 1
    if lanes > 0:
        begun = read_cycles()
        shoot(scene, tile, ray_type, lanes)
        spent(tile, begun)
    going = 0
    for which in range(size):
        path = path_at(tile.work, which)
        if path.status != MISSED and arrive(scene, tile, ray_type, path):
            if going < which:
                copy_path(path_at(tile.work, going), path)
            going += 1
    flush(scene, tile, ray_type)
    return going


@inner
def follow(scene: Any, tile: Any, ray_type: int, size: int) -> None:
    """Follow the ``size`` paths in ``tile.work``, and what splits off them, to their ends."""
    if i8(scene.visibility, ray_type) != 0 and i8(scene.has_any_hit, ray_type) < PYTHON:
        look(scene, tile, ray_type, size)
        return
    tile.top = 0
    tile.pending = 0
    while size > 0:
        while size > 0:
            size = step(scene, tile, ray_type, size)
        size = min(int(tile.top), LANES)
        for which in range(size):
            tile.top -= 1
            copy_path(path_at(tile.work, which), path_at(tile.stack, tile.top))

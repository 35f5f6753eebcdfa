"""Programs at the end of a ray: miss, any hit, closest hit; compiled, or deferred to Python."""

from __future__ import annotations

from typing import Any

from nau_py.raytrace.kernels.core.jit import inner
from nau_py.raytrace.kernels.core.kernel_tables import MISS_KERNELS, NONE, PARTIAL, USER
from nau_py.raytrace.kernels.core.memory import i8, i32, put_i32
from nau_py.raytrace.kernels.core.tables import (
    CANDIDATE,
    CUT,
    HIT,
    MISSED,
    PRIMARY,
    SHADE,
    STACK,
    TRACE,
    copy_path,
    heading_of,
    media_of,
    path_at,
    set_weight,
    weight_of,
)
from nau_py.raytrace.kernels.intersect.counters import increment_counter
from nau_py.raytrace.kernels.intersect.visibility import MAX_LAYERS, evaluate_opacity
from nau_py.raytrace.kernels.shading.closest_hit import evaluate_material
from nau_py.raytrace.kernels.shading.media import apply_absorption
from nau_py.raytrace.kernels.shading.radiance import add_radiance, defer_path
from nau_py.raytrace.kernels.shading.scatter import pass_hit

_run_miss_program = MISS_KERNELS.run


@inner
def handle_escaped_ray(scene: Any, tile: Any, ray_type: int, path: Any) -> None:
    """Run the miss program of the ray type."""
    code = i8(scene.miss, ray_type)
    if code == USER:
        defer_path(tile, path, MISSED)
    elif code != NONE:
        _run_miss_program(code, scene, tile, path)
    elif path.initial != 0.0:
        initial = float(path.initial)
        add_radiance(tile, path, (initial, initial, initial), initial)


@inner
def split_path(scene: Any, tile: Any, path: Any, stopped: float) -> None:
    """Split a path at a partly transparent hit: ``stopped`` of it is shaded, the rest continues."""
    rest = path_at(tile.stack, tile.top)
    copy_path(rest, path)
    tile.top += 1
    w, on = weight_of(path), 1.0 - stopped
    set_weight(rest, (w[0] * on, w[1] * on, w[2] * on, w[3] * on))
    set_weight(path, (w[0] * stopped, w[1] * stopped, w[2] * stopped, w[3] * stopped))
    pass_hit(scene, rest)


@inner
def run_any_hit(scene: Any, tile: Any, ray_type: int, path: Any) -> bool:
    """Run the any-hit programs that Embree's filter does not run: Python's, and transparency.

    Return True if the hit is accepted. Else the path is deferred to Python or continues behind the
    hit.
    """
    at = ray_type * scene.material_count + i32(scene.owner, path.triangle)
    code = i8(scene.any_hit, at)
    if code < PARTIAL:
        return True
    if path.layers >= MAX_LAYERS:
        increment_counter(tile, CUT)
        return True
    if code == USER:
        defer_path(tile, path, CANDIDATE)
        return False
    stopped = evaluate_opacity(
        scene, ray_type, int(path.triangle), float(path.u), float(path.v), heading_of(path),
        path.pixel, path.sample, int(path.depth),
    )  # fmt: skip
    if stopped <= 0.0:
        pass_hit(scene, path)
        return False
    if stopped < 1.0 and tile.top < STACK:
        split_path(scene, tile, path, stopped)
    return True


@inner
def run_hit_programs(scene: Any, tile: Any, ray_type: int, path: Any) -> bool:
    """Run miss, any-hit and closest-hit programs of a traced path. Return True if it continues."""
    if path.status == TRACE:
        if path.triangle < 0:
            handle_escaped_ray(scene, tile, ray_type, path)
            return False
        m = media_of(path)
        if max(m[0], m[1], m[2], m[3]) >= 0:
            apply_absorption(scene, path)
        layers = path.layers
        if not run_any_hit(scene, tile, ray_type, path):
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

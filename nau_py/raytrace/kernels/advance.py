"""The engine's inner loop: paths are followed until they end, or until Python must answer."""

from __future__ import annotations

from math import sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.kernels.codes import (
    AMBIENT_OCCLUSION,
    BACKGROUND,
    BLINN_PHONG,
    DIELECTRIC,
    DIRECT,
    EMISSION,
    FLUORESCENT,
    GLOSSY,
    LAMBERT,
    MIRROR,
    NONE,
    PHONG,
    UNOCCLUDED,
)
from nau_py.raytrace.kernels.embree import hit, nearest
from nau_py.raytrace.kernels.jit import V3, inner, kernel
from nau_py.raytrace.kernels.launch import start
from nau_py.raytrace.kernels.lights import INVERSE_PI, emitter_point, power
from nau_py.raytrace.kernels.memory import f32, f64, i8, i32, i64, put_f32, put_i64
from nau_py.raytrace.kernels.sampling import sobol2
from nau_py.raytrace.kernels.scatter import (
    SECOND,
    THIRD,
    absorb,
    bounce,
    dielectric,
    dimension,
    glossy,
    mirror,
    pass_through,
    reradiate,
)
from nau_py.raytrace.kernels.shade import (
    add,
    ambient_occlusion,
    default_look,
    defer,
    direct_light,
    light_term,
    rgb,
)
from nau_py.raytrace.kernels.surface import (
    facing,
    shading_normal,
    spawn,
    surface_point,
    terminator_point,
    texel,
)
from nau_py.raytrace.kernels.tables import (
    CANDIDATE,
    CONTINUATION,
    COUNTERS,
    CUT,
    HIT,
    MISSED,
    NONFINITE,
    SHADE,
    STACK,
    TRACE,
    USER,
    background_of,
    copy_path,
    diffuse_of,
    emission_of,
    heading_of,
    material_at,
    media_of,
    origin_of,
    path_at,
    set_weight,
    specular_of,
    weight_of,
)
from nau_py.raytrace.kernels.vec import dot, minus, scaled, times
from nau_py.raytrace.kernels.visibility import MAX_LAYERS, count, finite, opacity, visibility


@inner
def emitted(scene: Any, tile: Any, path: Any, material: Any, face: V3) -> None:
    """Add EMISSION, weighted against light sampling where the direction could have come from it
    (multiple importance sampling, Veach 1997)."""
    e = emission_of(material)
    if e[0] == 0.0 and e[1] == 0.0 and e[2] == 0.0:
        return
    weight = 1.0
    area = f64(scene.emitter_pdf, path.triangle)
    if path.pdf > 0.0 and area > 0.0:
        distance = float(path.travelled) + float(path.t)
        cosine = max(abs(dot(face, heading_of(path))), 1e-7)
        weight = power(float(path.pdf), area * distance * distance / cosine)
    add(tile, path, scaled(e, weight), 0.0)


@inner
def emitter_light(
    scene: Any, tile: Any, ray_type: int, path: Any, origin: V3, normal: V3, brdf: V3
) -> None:
    """Next-event estimation: a point of the emissive triangles, weighted against ``bounce``."""
    if scene.emitters_count == 0:
        return
    x, y = sobol2(scene.seed, path.pixel, path.sample, dimension(path, SECOND))
    choice, _ = sobol2(scene.seed, path.pixel, path.sample, dimension(path, THIRD))
    triangle, target, n, area = emitter_point(scene, choice, x, y)
    if triangle == path.triangle:
        return
    # the far end is lifted off the lamp, too: a ray to it must not meet it
    lift = surface_point(scene, triangle, 0.0, 0.0)[2]
    target = spawn(target, n, 2.0 * lift, minus(origin, target))
    to = minus(target, origin)
    distance2 = dot(to, to)
    if not distance2 > 0.0:
        return
    inverse = 1.0 / sqrt(distance2)
    near, far = dot(normal, to) * inverse, abs(dot(n, to)) * inverse
    if not (near > 0.0 and far > 0.0):
        return
    pdf = area * distance2 / far
    factor = near / pdf * power(pdf, near * INVERSE_PI)
    emission = emission_of(material_at(scene.materials, i32(scene.owner, triangle)))
    light_term(scene, tile, ray_type, path, origin, to, 1.0, scaled(times(brdf, emission), factor))


@inner
def without_alpha(path: Any) -> None:
    w = weight_of(path)
    set_weight(path, (w[0], w[1], w[2], 0.0))


@inner
def shade(scene: Any, tile: Any, ray_type: int, code: int, path: Any) -> bool:
    """Run built-in ``code`` at the hit of ``path``. Returns whether the path goes on."""
    triangle = int(path.triangle)
    owner = i32(scene.owner, triangle)
    material = material_at(scene.materials, owner)
    u, v = float(path.u), float(path.v)
    d = heading_of(path)
    p, face, bound = surface_point(scene, triangle, u, v)
    if code == EMISSION:
        add(tile, path, emission_of(material), 1.0)
        return False
    normal = facing(shading_normal(scene, triangle, u, v, face), d)
    if code == MIRROR or code == GLOSSY or code == DIELECTRIC:
        add(tile, path, (0.0, 0.0, 0.0), 1.0)
        without_alpha(path)
        if code == DIELECTRIC:
            return dielectric(scene, tile, path, owner, p, face, bound, normal)
        if code == MIRROR:
            return mirror(path, p, face, bound, normal, specular_of(material))
        return glossy(scene, path, p, face, bound, normal, material)
    colour = rgb(texel(scene, material, triangle, u, v))
    albedo = times(rgb(diffuse_of(material)), colour)
    if code == AMBIENT_OCCLUSION:
        ambient_occlusion(scene, tile, ray_type, path, p, face, bound, normal, albedo)
        return False
    geometric = facing(face, d)
    side = 1.0 if dot(face, d) < 0.0 else -1.0
    lifted = terminator_point(scene, triangle, u, v, p, side)
    origin = spawn(lifted, geometric, bound, geometric)
    if code == LAMBERT or code == PHONG or code == BLINN_PHONG:
        default_look(scene, tile, ray_type, code, path, origin, normal, material, colour)
        return False
    if code == DIRECT:
        add(tile, path, emission_of(material), 1.0)
        direct_light(scene, tile, ray_type, path, origin, normal, albedo)
        return False
    add(tile, path, (0.0, 0.0, 0.0), 1.0)
    emitted(scene, tile, path, material, face)
    without_alpha(path)
    if code == FLUORESCENT:
        albedo = reradiate(scene, path, material, albedo)
    direct_light(scene, tile, ray_type, path, origin, normal, albedo)
    if path.depth >= scene.max_depth:
        return False
    brdf = scaled(albedo, INVERSE_PI)
    emitter_light(scene, tile, ray_type, path, origin, normal, brdf)
    return bounce(scene, path, p, face, bound, normal, albedo)


@inner
def missed(scene: Any, tile: Any, ray_type: int, path: Any) -> None:
    """Run the miss program of the ray type."""
    code = i8(scene.miss, ray_type)
    if code == USER:
        defer(tile, path, MISSED)
    elif code == BACKGROUND:
        b = background_of(scene)
        add(tile, path, rgb(b), b[3])
    elif code == UNOCCLUDED:
        add(tile, path, (1.0, 1.0, 1.0), 1.0)
    elif path.initial != 0.0:
        initial = float(path.initial)
        add(tile, path, (initial, initial, initial), initial)


@inner
def split(scene: Any, tile: Any, path: Any, stopped: float) -> None:
    """Part of the path goes on behind the hit, the part ``stopped`` is shaded."""
    rest = path_at(tile.stack, tile.top)
    copy_path(rest, path)
    tile.top += 1
    w, on = weight_of(path), 1.0 - stopped
    set_weight(rest, (w[0] * on, w[1] * on, w[2] * on, w[3] * on))
    set_weight(path, (w[0] * stopped, w[1] * stopped, w[2] * stopped, w[3] * stopped))
    pass_through(scene, rest)


@inner
def follow(scene: Any, tile: Any, ray_type: int, path: Any) -> bool:
    """One step of ``path``: trace, ask any hit, shade. Returns whether it goes on."""
    if path.status == TRACE:
        asks = i8(scene.visibility, ray_type) != 0
        if path.depth > scene.max_depth and not asks:
            return False
        o, d = origin_of(path), heading_of(path)
        if not (finite(o) and finite(d)) or (d[0] == 0.0 and d[1] == 0.0 and d[2] == 0.0):
            count(tile, NONFINITE)
            return False
        if asks and i8(scene.has_any_hit, ray_type) < 2:
            seen = visibility(
                scene, tile, ray_type, int(path.kind), o, d, float(path.tmax), path.pixel,
                path.sample, int(path.depth),
            )  # fmt: skip
            if seen > 0.0:
                w = weight_of(path)
                set_weight(path, (w[0] * seen, w[1] * seen, w[2] * seen, w[3] * seen))
                missed(scene, tile, ray_type, path)
            return False
        count(tile, int(path.kind) if path.layers == 0 else CONTINUATION)
        triangle = nearest(scene, tile.ray, o, d, float(path.tmax))
        path.triangle = triangle
        if triangle < 0:
            missed(scene, tile, ray_type, path)
            return False
        path.t, path.u, path.v = hit(tile.ray)
        m = media_of(path)
        if max(m[0], m[1], m[2], m[3]) >= 0:
            absorb(scene, path)
        code = i8(scene.any_hit, ray_type * scene.material_count + i32(scene.owner, triangle))
        if code != NONE:
            if path.layers >= MAX_LAYERS:
                count(tile, CUT)
            elif code == USER:
                defer(tile, path, CANDIDATE)
                return False
            else:
                stopped = opacity(
                    scene, ray_type, triangle, float(path.u), float(path.v), d, path.pixel,
                    path.sample, int(path.depth),
                )  # fmt: skip
                if stopped <= 0.0:
                    pass_through(scene, path)
                    return True
                if stopped < 1.0 and tile.top < STACK:
                    split(scene, tile, path, stopped)
    at = ray_type * scene.material_count + i32(scene.owner, path.triangle)
    code = i8(scene.closest, at)
    if code == NONE:
        return False
    if code == USER:
        defer(tile, path, HIT)
        return False
    path.status = SHADE
    return shade(scene, tile, ray_type, code, path)


@inner
def finish(scene: Any, tile: Any, ray_type: int, path: Any) -> None:
    """Follow ``path``, and what splits off it, to the end."""
    tile.top = 0
    while follow(scene, tile, ray_type, path):
        pass
    while tile.top > 0:
        tile.top -= 1
        copy_path(path, path_at(tile.stack, tile.top))
        while follow(scene, tile, ray_type, path):
            pass


@kernel
def advance(
    scenes: NDArray[Any],
    ray_type: int,
    queue: NDArray[Any],
    tiles: NDArray[Any],
    current: NDArray[Any],
) -> None:
    """Follow the paths of ``queue`` from ``next`` on; add what they bring to the radiance.

    ``scenes`` and ``tiles`` hold one record each. Where the queue for Python is full, the path at
    hand is undone, ``next`` is its index, and the kernel returns. ``current``: room for one path.
    """
    scene, tile = scenes[0], tiles[0]
    before = np.empty(4)
    saved = np.empty(COUNTERS, np.int64)
    for i in range(tile.next, queue.shape[0]):
        path = queue[i]
        start = tile.waiting
        at = 4 * path.index
        if scene.asks_python:
            copy_path(current[0], path)
            for k in range(4):
                before[k] = f32(tile.radiance, at + k)
            for k in range(COUNTERS):
                saved[k] = i64(tile.counts, k)
        finish(scene, tile, ray_type, path)
        if tile.waiting > tile.capacity:
            copy_path(path, current[0])
            for k in range(4):
                put_f32(tile.radiance, at + k, before[k])
            for k in range(COUNTERS):
                put_i64(tile.counts, k, saved[k])
            tile.next = i
            tile.waiting = start
            return
    tile.next = queue.shape[0]


@kernel
def march(
    scenes: NDArray[Any],
    cameras: NDArray[Any],
    lens: int,
    rule: int,
    side: int,
    width: int,
    items: NDArray[Any],
    tiles: NDArray[Any],
    current: NDArray[Any],
) -> None:
    """``generate`` and ``advance`` in one, for programs that are all compiled: no queue."""
    scene, tile, path = scenes[0], tiles[0], current[0]
    at = 0
    for i in range(items.shape[0]):
        flat, first = int(items[i].pixel), int(items[i].first)
        for k in range(items[i].count):
            start(cameras[0], lens, rule, side, scene.seed, width, flat, first + k, at, path)
            at += 1
            finish(scene, tile, 0, path)

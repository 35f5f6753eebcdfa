"""Radiance that a path brings to its sample, and the light that shadow rays decide on.

Shadow rays are not traced here. They are collected for the packet (``intersect/shadow_rays.py``);
where their programs are Python's, they join the deferred paths with the light that they bring.
"""

from __future__ import annotations

from typing import Any

from nau_py.raytrace.kernels.core.jit import V3, inner
from nau_py.raytrace.kernels.core.memory import f32, i8, put_f32
from nau_py.raytrace.kernels.core.tables import (
    OCCLUSION,
    SHADOW,
    SKIPPED,
    copy_path,
    path_at,
    set_heading,
    set_origin,
    set_weight,
    weight_of,
)
from nau_py.raytrace.kernels.geometry.texture import RGBA
from nau_py.raytrace.kernels.intersect.counters import increment_counter, is_skipped
from nau_py.raytrace.kernels.intersect.shadow_rays import collect_shadow_ray
from nau_py.raytrace.kernels.intersect.visibility import shadow_ray_type


@inner
def take_rgb(c: RGBA) -> V3:
    """Return a colour without its alpha."""
    return c[0], c[1], c[2]


@inner
def select_band(path: Any, colour: V3) -> V3:
    """Return the colour that a path carries: one band of it after a fluorescent surface."""
    if path.band < 0:
        return colour
    b = colour[path.band]
    return b, b, b


@inner
def add_radiance(tile: Any, path: Any, colour: V3, alpha: float) -> None:
    """Add radiance at the end of ``path`` to its sample."""
    at = 4 * path.index
    w, c = weight_of(path), select_band(path, colour)
    put_f32(tile.radiance, at, f32(tile.radiance, at) + w[0] * c[0])
    put_f32(tile.radiance, at + 1, f32(tile.radiance, at + 1) + w[1] * c[1])
    put_f32(tile.radiance, at + 2, f32(tile.radiance, at + 2) + w[2] * c[2])
    put_f32(tile.radiance, at + 3, f32(tile.radiance, at + 3) + w[3] * alpha)


@inner
def add_coverage(tile: Any, path: Any) -> None:
    """Add the alpha of ``path``, which has met a surface; what follows adds none."""
    w, at = weight_of(path), 4 * path.index + 3
    put_f32(tile.radiance, at, f32(tile.radiance, at) + w[3])
    set_weight(path, (w[0], w[1], w[2], 0.0))


@inner
def scale_weight(path: Any, colour: V3) -> float:
    """Multiply the weight of a path by a colour. Return its largest component."""
    w, c = weight_of(path), select_band(path, colour)
    x, y, z = w[0] * c[0], w[1] * c[1], w[2] * c[2]
    set_weight(path, (x, y, z, w[3]))
    return max(abs(x), abs(y), abs(z))


@inner
def defer_path(tile: Any, path: Any, status: int) -> Any:
    """Queue ``path`` for Python. Return the copy. ``waiting`` counts on past a full queue."""
    at = min(tile.waiting, tile.capacity)
    tile.waiting += 1
    late = path_at(tile.deferred, at)
    copy_path(late, path)
    late.status = status
    return late


@inner
def add_light(
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
    """Add ``light`` if it is visible from ``origin`` along ``direction``.

    ``tmax`` is in lengths of ``direction``; ``source`` is the number of the light.
    """
    if light[0] == 0.0 and light[1] == 0.0 and light[2] == 0.0:
        return
    w, c = weight_of(path), select_band(path, light)
    arriving = (w[0] * c[0], w[1] * c[1], w[2] * c[2])
    if is_skipped(scene, SHADOW):
        increment_counter(tile, SKIPPED + SHADOW)
        at = 4 * path.index
        for k in range(3):
            put_f32(tile.radiance, at + k, f32(tile.radiance, at + k) + arriving[k])
        return
    if i8(scene.deferred_shadows, shadow_ray_type(scene, ray_type)) != 0:
        late = defer_path(tile, path, OCCLUSION)
        set_origin(late, origin)
        set_heading(late, direction)
        late.tmax = tmax
        set_weight(late, (arriving[0], arriving[1], arriving[2], 0.0))
        return
    collect_shadow_ray(scene, tile, ray_type, path, source, origin, direction, tmax, arriving)

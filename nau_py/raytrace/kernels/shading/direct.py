"""Shading that ends a path: the default look, Phong, lights with shape, ambient occlusion.

Shadow rays are not traced here: they are queued for the packet (``intersect/shadow_rays.py``) or,
if their programs are Python's, deferred together with the light that they would bring.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from nau_py.raytrace.kernels.core.codes import LAMBERT, PHONG
from nau_py.raytrace.kernels.core.jit import V3, inner
from nau_py.raytrace.kernels.core.memory import f32, i8, put_f32
from nau_py.raytrace.kernels.core.sampling import sample_2d, sample_hemisphere
from nau_py.raytrace.kernels.core.tables import (
    AMBIENT,
    OCCLUSION,
    RECTANGLE,
    SHADOW,
    SKIPPED,
    copy_path,
    diffuse_of,
    emission_of,
    heading_of,
    light_at,
    path_at,
    set_heading,
    set_origin,
    set_weight,
    specular_of,
    weight_of,
)
from nau_py.raytrace.kernels.core.vec import (
    add,
    dot,
    from_frame,
    make_frame,
    multiply,
    normalize,
    reflect,
    scale,
)
from nau_py.raytrace.kernels.geometry.surface import face_forward, offset_origin
from nau_py.raytrace.kernels.geometry.texture import RGBA
from nau_py.raytrace.kernels.intersect.counters import (
    check_ray,
    increment_counter,
    is_skipped,
)
from nau_py.raytrace.kernels.intersect.embree import INFINITE
from nau_py.raytrace.kernels.intersect.shadow_rays import collect_shadow_ray
from nau_py.raytrace.kernels.intersect.visibility import shadow_ray_type, trace_visibility
from nau_py.raytrace.kernels.shading.lights import sample_light

AMBIENT_FACTOR = 0.3
LIGHT_DIMENSION = 0x1000
"""First dimension of light samples: 64 lights a depth."""
HIT_DIMENSIONS = 16
"""Dimensions of a hit, by depth."""


@inner
def take_rgb(c: RGBA) -> V3:
    return c[0], c[1], c[2]


@inner
def add_radiance(tile: Any, path: Any, colour: V3, alpha: float) -> None:
    """Add what arrives at the end of ``path``."""
    at = 4 * path.index
    w, c = weight_of(path), select_band(path, colour)
    put_f32(tile.radiance, at, f32(tile.radiance, at) + w[0] * c[0])
    put_f32(tile.radiance, at + 1, f32(tile.radiance, at + 1) + w[1] * c[1])
    put_f32(tile.radiance, at + 2, f32(tile.radiance, at + 2) + w[2] * c[2])
    put_f32(tile.radiance, at + 3, f32(tile.radiance, at + 3) + w[3] * alpha)


@inner
def select_band(path: Any, colour: V3) -> V3:
    """The colour as the path sees it: one band of it after a fluorescent surface."""
    if path.band < 0:
        return colour
    b = colour[path.band]
    return b, b, b


@inner
def defer_path(tile: Any, path: Any, status: int) -> Any:
    """Queue ``path`` for Python; returns the copy. ``waiting`` counts on past a full queue."""
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
    """Add ``light`` if ``origin`` sees it along ``direction``, up to ``tmax`` lengths of it.
    ``source``: the number of the light."""
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


@inner
def shade_default(
    scene: Any,
    tile: Any,
    ray_type: int,
    code: int,
    path: Any,
    origin: V3,
    normal: V3,
    material: Any,
    texel: V3,
) -> None:
    """Nau's default material (docs/format.md, 8.5) by the first light, with shadows where the pass
    has a ray type for them; for Phong's models with the highlight SPECULAR cos^SHININESS. A light
    with a shape is the mean over its points."""
    diffuse = take_rgb(diffuse_of(material))
    rest = scale(diffuse, AMBIENT_FACTOR)
    if material.texture >= 0:
        rest = (AMBIENT_FACTOR, AMBIENT_FACTOR, AMBIENT_FACTOR)
    add_radiance(tile, path, multiply(add(rest, emission_of(material)), texel), 1.0)
    if scene.lights_count == 0:
        return
    light = light_at(scene.lights, 0)
    samples = count_light_samples(scene, light)
    for k in range(samples):
        number = np.uint32(path.sample * samples + k)
        dimension = np.uint32(LIGHT_DIMENSION + path.depth * 64)
        x, y = 0.5, 0.5
        if light.shape >= RECTANGLE:
            x, y = sample_2d(scene.seed, path.pixel, number, dimension)
        to, distance, colour = sample_light(light, origin, x, y)
        unit_to = normalize(to)
        cosine = dot(normal, unit_to)
        if not (distance > 0.0 and cosine > 0.0):
            continue
        colour = scale(colour, 1.0 / samples)
        lit = multiply(scale(multiply(diffuse, colour), cosine), texel)
        if code != LAMBERT:
            away = scale(heading_of(path), -1.0)
            if code == PHONG:
                lobe = dot(reflect(scale(unit_to, -1.0), normal), away)
            else:
                lobe = dot(normalize(add(unit_to, away)), normal)
            if lobe > 0.0:
                shine = lobe ** float(material.shininess)
                lit = add(lit, scale(multiply(specular_of(material), colour), shine))
        if scene.shadow_type < 0:
            add_radiance(tile, path, lit, 0.0)
        else:
            tmax = 1.0 if distance < INFINITE else INFINITE
            add_light(scene, tile, ray_type, path, 0, origin, to, tmax, lit)


@inner
def count_light_samples(scene: Any, light: Any) -> int:
    """Shadow rays for one light: more than one only where it has an area."""
    return max(int(scene.light_samples), 1) if light.shape >= RECTANGLE else 1


@inner
def sample_lights(
    scene: Any,
    tile: Any,
    ray_type: int,
    path: Any,
    origin: V3,
    normal: V3,
    albedo: V3,
) -> None:
    """What every light of the pass brings to a diffuse surface, with shadows."""
    for index in range(scene.lights_count):
        light = light_at(scene.lights, index)
        samples = count_light_samples(scene, light)
        dimension = np.uint32(LIGHT_DIMENSION + path.depth * 64 + index)
        for k in range(samples):
            number = np.uint32(path.sample * samples + k)
            x, y = sample_2d(scene.seed, path.pixel, number, dimension)
            to, distance, colour = sample_light(light, origin, x, y)
            length = distance if distance < INFINITE else 1.0
            if not length > 0.0:
                continue
            cosine = dot(normal, to) / length
            if not cosine > 0.0:
                continue
            tmax = 1.0 if distance < INFINITE else INFINITE
            brought = scale(multiply(albedo, colour), cosine / samples)
            add_light(scene, tile, ray_type, path, index, origin, to, tmax, brought)


@inner
def sample_occlusion(
    scene: Any,
    tile: Any,
    ray_type: int,
    path: Any,
    position: V3,
    face: V3,
    bound: float,
    normal: V3,
    albedo: V3,
) -> None:
    """Cosine-weighted sky visibility within the pass's OCCLUSION_DISTANCE, times the albedo."""
    samples = max(int(scene.light_samples), 1)
    s, t = make_frame(normal)
    geometric = face_forward(face, heading_of(path))
    open_ = 0.0
    for k in range(samples):
        number = np.uint32(path.sample * samples + k)
        dimension = np.uint32(HIT_DIMENSIONS * path.depth)
        x, y = sample_2d(scene.seed, path.pixel, number, dimension)
        d = sample_hemisphere(x, y)
        to = from_frame(s, t, normal, d[0], d[1], d[2])
        if not dot(geometric, to) > 0.0:
            continue
        origin = offset_origin(position, face, bound, to)
        if not check_ray(tile, origin, to):
            continue
        if is_skipped(scene, AMBIENT):
            increment_counter(tile, SKIPPED + AMBIENT)
            open_ += 1.0
            continue
        increment_counter(tile, AMBIENT)
        open_ += trace_visibility(
            scene, tile, shadow_ray_type(scene, ray_type), origin, to,
            float(scene.occlusion_distance), path.pixel, path.sample, int(path.depth),
        )  # fmt: skip
    add_radiance(tile, path, scale(albedo, open_ / samples), 1.0)

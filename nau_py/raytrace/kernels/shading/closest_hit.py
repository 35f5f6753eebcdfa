"""The built-in closest-hit programs, by code; and emissive triangles as lights."""

from __future__ import annotations

from math import sqrt
from typing import Any

from nau_py.raytrace.kernels.core.codes import (
    AMBIENT_OCCLUSION,
    BLINN_PHONG,
    DIELECTRIC,
    DIRECT,
    EMISSION,
    FLUORESCENT,
    GLOSSY,
    LAMBERT,
    MIRROR,
    PHONG,
)
from nau_py.raytrace.kernels.core.jit import V3, inner
from nau_py.raytrace.kernels.core.memory import f32, f64, i32, put_f32
from nau_py.raytrace.kernels.core.sampling import sobol2
from nau_py.raytrace.kernels.core.tables import (
    INDIRECT,
    diffuse_of,
    emission_of,
    heading_of,
    material_at,
    set_weight,
    specular_of,
    weight_of,
)
from nau_py.raytrace.kernels.core.vec import dot, minus, scaled, times
from nau_py.raytrace.kernels.geometry.surface import (
    facing,
    shading_normal,
    spawn,
    surface_point,
    terminator_point,
    texel,
)
from nau_py.raytrace.kernels.intersect.visibility import skips
from nau_py.raytrace.kernels.shading.direct import (
    add,
    ambient_occlusion,
    default_look,
    direct_light,
    light_term,
    rgb,
)
from nau_py.raytrace.kernels.shading.lights import INVERSE_PI, emitter_point, power
from nau_py.raytrace.kernels.shading.sample_bsdf import (
    SECOND,
    THIRD,
    bounce,
    dielectric,
    dimension,
    glossy,
    mirror,
    reradiate,
)


@inner
def emitted(scene: Any, tile: Any, path: Any, material: Any, face: V3) -> None:
    """Add EMISSION, weighted against light sampling where the direction could have come from it
    (multiple importance sampling, Veach 1997)."""
    e = emission_of(material)
    if e[0] == 0.0 and e[1] == 0.0 and e[2] == 0.0:
        return
    if scene.caustics == 0 and path.scattered != 0 and path.pdf == 0.0:
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
    factor = near / pdf
    if not skips(scene, INDIRECT):
        factor *= power(pdf, near * INVERSE_PI)
    emission = emission_of(material_at(scene.materials, i32(scene.owner, triangle)))
    brought = scaled(times(brdf, emission), factor)
    light_term(scene, tile, ray_type, path, scene.lights_count, origin, to, 1.0, brought)


@inner
def cover(tile: Any, path: Any) -> None:
    """Add the path's part of alpha: it has met something, whatever becomes of it."""
    w, at = weight_of(path), 4 * path.index + 3
    put_f32(tile.radiance, at, f32(tile.radiance, at) + w[3])
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
        emitted(scene, tile, path, material, face)
        cover(tile, path)
        return False
    normal = facing(shading_normal(scene, triangle, u, v, face), d)
    if code == MIRROR or code == GLOSSY or code == DIELECTRIC:
        cover(tile, path)
        if code == DIELECTRIC:
            return dielectric(scene, tile, path, owner, p, face, bound, normal)
        if code == MIRROR:
            return mirror(scene, path, p, face, bound, normal, specular_of(material))
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
    cover(tile, path)
    emitted(scene, tile, path, material, face)
    if code == FLUORESCENT:
        albedo = reradiate(scene, path, material, albedo)
    direct_light(scene, tile, ray_type, path, origin, normal, albedo)
    if path.depth >= scene.max_depth:
        return False
    brdf = scaled(albedo, INVERSE_PI)
    emitter_light(scene, tile, ray_type, path, origin, normal, brdf)
    return bounce(scene, path, p, face, bound, normal, albedo)

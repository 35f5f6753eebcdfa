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
from nau_py.raytrace.kernels.core.sampling import sample_2d
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
from nau_py.raytrace.kernels.core.vec import dot, multiply, scale, subtract
from nau_py.raytrace.kernels.geometry.surface import (
    evaluate_texture,
    face_forward,
    interpolate_normal,
    lift_point,
    locate_point,
    offset_origin,
)
from nau_py.raytrace.kernels.intersect.counters import (
    is_skipped,
)
from nau_py.raytrace.kernels.shading.direct import (
    add_light,
    add_radiance,
    sample_lights,
    sample_occlusion,
    shade_default,
    take_rgb,
)
from nau_py.raytrace.kernels.shading.lights import INVERSE_PI, sample_emitter, weigh_strategies
from nau_py.raytrace.kernels.shading.sample_bsdf import (
    SECOND,
    THIRD,
    hit_dimension,
    sample_dielectric,
    sample_diffuse,
    sample_fluorescence,
    sample_glossy,
    sample_mirror,
)


@inner
def add_emission(scene: Any, tile: Any, path: Any, material: Any, face: V3) -> None:
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
        weight = weigh_strategies(float(path.pdf), area * distance * distance / cosine)
    add_radiance(tile, path, scale(e, weight), 0.0)


@inner
def sample_emitters(
    scene: Any, tile: Any, ray_type: int, path: Any, origin: V3, normal: V3, brdf: V3
) -> None:
    """Next-event estimation: a point of the emissive triangles, weighted against ``bounce``."""
    if scene.emitters_count == 0:
        return
    x, y = sample_2d(scene.seed, path.pixel, path.sample, hit_dimension(path, SECOND))
    choice, _ = sample_2d(scene.seed, path.pixel, path.sample, hit_dimension(path, THIRD))
    triangle, target, n, area = sample_emitter(scene, choice, x, y)
    if triangle == path.triangle:
        return
    # the far end is lifted off the lamp, too: a ray to it must not meet it
    lift = locate_point(scene, triangle, 0.0, 0.0)[2]
    target = offset_origin(target, n, 2.0 * lift, subtract(origin, target))
    to = subtract(target, origin)
    distance2 = dot(to, to)
    if not distance2 > 0.0:
        return
    inverse = 1.0 / sqrt(distance2)
    near, far = dot(normal, to) * inverse, abs(dot(n, to)) * inverse
    if not (near > 0.0 and far > 0.0):
        return
    pdf = area * distance2 / far
    factor = near / pdf
    if not is_skipped(scene, INDIRECT):
        factor *= weigh_strategies(pdf, near * INVERSE_PI)
    emission = emission_of(material_at(scene.materials, i32(scene.owner, triangle)))
    brought = scale(multiply(brdf, emission), factor)
    add_light(scene, tile, ray_type, path, scene.lights_count, origin, to, 1.0, brought)


@inner
def add_coverage(tile: Any, path: Any) -> None:
    """Add the path's part of alpha: it has met something, whatever becomes of it."""
    w, at = weight_of(path), 4 * path.index + 3
    put_f32(tile.radiance, at, f32(tile.radiance, at) + w[3])
    set_weight(path, (w[0], w[1], w[2], 0.0))


@inner
def evaluate_material(scene: Any, tile: Any, ray_type: int, code: int, path: Any) -> bool:
    """Run built-in ``code`` at the hit of ``path``. Returns whether the path goes on."""
    triangle = int(path.triangle)
    owner = i32(scene.owner, triangle)
    material = material_at(scene.materials, owner)
    u, v = float(path.u), float(path.v)
    d = heading_of(path)
    p, face, bound = locate_point(scene, triangle, u, v)
    if code == EMISSION:
        add_emission(scene, tile, path, material, face)
        add_coverage(tile, path)
        return False
    normal = face_forward(interpolate_normal(scene, triangle, u, v, face), d)
    if code == MIRROR or code == GLOSSY or code == DIELECTRIC:
        add_coverage(tile, path)
        if code == DIELECTRIC:
            return sample_dielectric(scene, tile, path, owner, p, face, bound, normal)
        if code == MIRROR:
            return sample_mirror(scene, path, p, face, bound, normal, specular_of(material))
        return sample_glossy(scene, path, p, face, bound, normal, material)
    colour = take_rgb(evaluate_texture(scene, material, triangle, u, v))
    albedo = multiply(take_rgb(diffuse_of(material)), colour)
    if code == AMBIENT_OCCLUSION:
        sample_occlusion(scene, tile, ray_type, path, p, face, bound, normal, albedo)
        return False
    geometric = face_forward(face, d)
    side = 1.0 if dot(face, d) < 0.0 else -1.0
    lifted = lift_point(scene, triangle, u, v, p, side)
    origin = offset_origin(lifted, geometric, bound, geometric)
    if code == LAMBERT or code == PHONG or code == BLINN_PHONG:
        shade_default(scene, tile, ray_type, code, path, origin, normal, material, colour)
        return False
    if code == DIRECT:
        add_radiance(tile, path, emission_of(material), 1.0)
        sample_lights(scene, tile, ray_type, path, origin, normal, albedo)
        return False
    add_coverage(tile, path)
    add_emission(scene, tile, path, material, face)
    if code == FLUORESCENT:
        albedo = sample_fluorescence(scene, path, material, albedo)
    sample_lights(scene, tile, ray_type, path, origin, normal, albedo)
    if path.depth >= scene.max_depth:
        return False
    brdf = scale(albedo, INVERSE_PI)
    sample_emitters(scene, tile, ray_type, path, origin, normal, brdf)
    return sample_diffuse(scene, path, p, face, bound, normal, albedo)

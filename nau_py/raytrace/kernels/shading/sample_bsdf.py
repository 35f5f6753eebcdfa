"""Scattering that goes on with a path: mirrors, glossy and diffuse surfaces, dielectrics."""

from __future__ import annotations

from math import exp
from typing import Any

import numpy as np

from nau_py.raytrace.kernels.core.jit import V3, inner
from nau_py.raytrace.kernels.core.sampling import sample_2d, sample_hemisphere
from nau_py.raytrace.kernels.core.tables import (
    INDIRECT,
    REFLECTION,
    REFRACTION,
    STACK,
    TRACE,
    absorption_of,
    copy_path,
    heading_of,
    material_at,
    media_of,
    path_at,
    reradiation_of,
    set_heading,
    set_media,
    set_origin,
    set_weight,
    specular_of,
    weight_of,
)
from nau_py.raytrace.kernels.core.vec import dot, from_frame, make_frame, reflect
from nau_py.raytrace.kernels.geometry.surface import (
    face_forward,
    keep_above,
    locate_point,
    offset_origin,
)
from nau_py.raytrace.kernels.intersect.embree import INFINITE
from nau_py.raytrace.kernels.shading.bsdf import (
    SMOOTH,
    evaluate_fresnel,
    look_up_albedo,
    refract,
    sample_ggx,
)
from nau_py.raytrace.kernels.shading.direct import HIT_DIMENSIONS, select_band
from nau_py.raytrace.kernels.shading.lights import INVERSE_PI

SPLIT_DEPTH = 4
"""Depth up to which a dielectric follows both directions; deeper ones follow one by chance."""
ROULETTE_DEPTH = 4
"""Depth from which diffuse paths end by Russian roulette."""
FIRST, SECOND, THIRD, FOURTH = 0, 1, 2, 3
"""Dimensions of a hit: direction, emitter point, choices, band."""


@inner
def hit_dimension(path: Any, which: int) -> np.uint32:
    return np.uint32(HIT_DIMENSIONS * path.depth + which)


@inner
def scale_weight(path: Any, colour: V3) -> float:
    """Multiply the weight; returns its largest component."""
    w, c = weight_of(path), select_band(path, colour)
    x, y, z = w[0] * c[0], w[1] * c[1], w[2] * c[2]
    set_weight(path, (x, y, z, w[3]))
    return max(abs(x), abs(y), abs(z))


@inner
def leave_surface(
    path: Any, position: V3, face: V3, bound: float, direction: V3, kind: int
) -> None:
    """Send the path on from a surface along the unit ``direction``."""
    set_origin(path, offset_origin(position, face, bound, direction))
    set_heading(path, direction)
    path.tmax = INFINITE
    path.travelled = 0.0
    path.depth += 1
    path.layers = 0
    path.kind = kind
    path.status = TRACE


@inner
def pass_hit(scene: Any, path: Any) -> None:
    """Send the path on behind an ignored hit, in the same direction."""
    p, n, bound = locate_point(scene, int(path.triangle), float(path.u), float(path.v))
    set_origin(path, offset_origin(p, n, bound, heading_of(path)))
    path.tmax = max(path.tmax - path.t, np.float32(0.0))
    path.travelled += path.t
    path.layers += 1
    path.status = TRACE


@inner
def is_significant(scene: Any, throughput: float) -> bool:
    """Whether a specular chain goes on with so much weight."""
    return throughput > 0.0 and throughput >= scene.negligible


@inner
def sample_mirror(
    scene: Any, path: Any, position: V3, face: V3, bound: float, normal: V3, specular: V3
) -> bool:
    """SPECULAR times the mirror direction. Returns whether the path goes on."""
    going = is_significant(scene, scale_weight(path, specular))
    d = heading_of(path)
    direction = keep_above(reflect(d, normal), face_forward(face, d))
    path.pdf = 0.0
    leave_surface(path, position, face, bound, direction, REFLECTION)
    return going


@inner
def sample_glossy(
    scene: Any,
    path: Any,
    position: V3,
    face: V3,
    bound: float,
    normal: V3,
    material: Any,
) -> bool:
    """GGX with SPECULAR as its reflectance and ROUGHNESS² as its alpha, visible normals.

    The energy of multiple scattering is added back (Turquin 2019), so that SPECULAR 1 loses none.
    """
    specular = specular_of(material)
    roughness = min(max(float(material.roughness), 0.0), 1.0)
    alpha = roughness * roughness
    if alpha <= SMOOTH:
        return sample_mirror(scene, path, position, face, bound, normal, specular)
    s, t = make_frame(normal)
    d = heading_of(path)
    w = (-dot(d, s), -dot(d, t), max(-dot(d, normal), 1e-4))
    x, y = sample_2d(scene.seed, path.pixel, path.sample, hit_dimension(path, FIRST))
    out, weight = sample_ggx(w, alpha, x, y)
    kept = look_up_albedo(scene.albedo, roughness, w[2])
    lost = (1.0 - kept) / kept
    colour = (
        specular[0] * weight * (1.0 + specular[0] * lost),
        specular[1] * weight * (1.0 + specular[1] * lost),
        specular[2] * weight * (1.0 + specular[2] * lost),
    )
    direction = from_frame(s, t, normal, out[0], out[1], out[2])
    going = weight > 0.0 and is_significant(scene, scale_weight(path, colour))
    if dot(direction, face_forward(face, d)) <= 0.0:
        going = False
    path.pdf = 0.0
    leave_surface(path, position, face, bound, direction, REFLECTION)
    return going


@inner
def sample_diffuse(
    scene: Any, path: Any, position: V3, face: V3, bound: float, normal: V3, colour: V3
) -> bool:
    """A cosine-weighted direction; deep paths end by Russian roulette."""
    d = heading_of(path)
    largest = scale_weight(path, colour)
    if not largest > 0.0:
        return False
    if path.depth >= ROULETTE_DEPTH:
        survival = min(max(largest, 0.05), 0.95)
        chance = sample_2d(scene.seed, path.pixel, path.sample, hit_dimension(path, THIRD))[1]
        if chance >= survival:
            return False
        more = 1.0 / survival
        scale_weight(path, (more, more, more))
    s, t = make_frame(normal)
    x, y = sample_2d(scene.seed, path.pixel, path.sample, hit_dimension(path, FIRST))
    out = sample_hemisphere(x, y)
    direction = from_frame(s, t, normal, out[0], out[1], out[2])
    if not (dot(direction, face_forward(face, d)) > 0.0 and out[2] > 0.0):
        return False
    path.pdf = out[2] * INVERSE_PI
    path.scattered = 1
    leave_surface(path, position, face, bound, direction, INDIRECT)
    return True


@inner
def sample_fluorescence(scene: Any, path: Any, material: Any, albedo: V3) -> V3:
    """Fluorescence: choose the band whose light is followed, and weigh the path accordingly.

    The re-radiation matrix is diag(albedo) + FLUORESCENCE. Returns the colour for ``scale_weight``.
    """
    matrix = reradiation_of(material)
    if path.band >= 0:
        b = path.band
        row = (
            matrix[3 * b] + (albedo[0] if b == 0 else 0.0),
            matrix[3 * b + 1] + (albedo[1] if b == 1 else 0.0),
            matrix[3 * b + 2] + (albedo[2] if b == 2 else 0.0),
        )
        total = row[0] + row[1] + row[2]
    else:
        row = (
            matrix[0] + matrix[3] + matrix[6] + albedo[0],
            matrix[1] + matrix[4] + matrix[7] + albedo[1],
            matrix[2] + matrix[5] + matrix[8] + albedo[2],
        )
        total = row[0] + row[1] + row[2]
    if not total > 0.0:
        return (0.0, 0.0, 0.0)
    x, _ = sample_2d(scene.seed, path.pixel, path.sample, hit_dimension(path, FOURTH))
    chosen = 0
    if x * total >= row[0]:
        chosen = 1
    if x * total >= row[0] + row[1] and row[2] > 0.0:
        chosen = 2
    probability = row[chosen] / total
    if not probability > 0.0:
        return (0.0, 0.0, 0.0)
    if path.band >= 0:
        scale = row[chosen] / probability
        path.band = chosen
        return (scale, scale, scale)
    scale_weight(
        path,
        (
            (matrix[chosen] + (albedo[0] if chosen == 0 else 0.0)) / probability,
            (matrix[3 + chosen] + (albedo[1] if chosen == 1 else 0.0)) / probability,
            (matrix[6 + chosen] + (albedo[2] if chosen == 2 else 0.0)) / probability,
        ),
    )
    path.band = chosen
    return (1.0, 1.0, 1.0)


@inner
def find_medium(scene: Any, path: Any, without: int) -> int:
    """The medium that counts: the highest PRIORITY of those that contain the path; -1: vacuum.

    One entry of the medium ``without`` is left out.
    """
    best, rank = -1, 0
    skipped = False
    for m in media_of(path):
        if m < 0:
            continue
        if m == without and not skipped:
            skipped = True
            continue
        priority = material_at(scene.materials, m).priority
        if best < 0 or priority > rank:
            best, rank = m, priority
    return best


@inner
def apply_absorption(scene: Any, path: Any) -> None:
    """Beer and Lambert over the segment just traced: exp(-ABSORPTION · distance)."""
    medium = find_medium(scene, path, -1)
    if medium < 0:
        return
    a = absorption_of(material_at(scene.materials, medium))
    t = float(path.t)
    scale_weight(path, (exp(-a[0] * t), exp(-a[1] * t), exp(-a[2] * t)))


@inner
def replace_medium(path: Any, old: int, new: int) -> None:
    """Put ``new`` in the place of the first medium ``old``; one too many is forgotten."""
    a, b, c, d = media_of(path)
    if a == old:
        set_media(path, (new, b, c, d))
    elif b == old:
        set_media(path, (a, new, c, d))
    elif c == old:
        set_media(path, (a, b, new, d))
    elif d == old:
        set_media(path, (a, b, c, new))


@inner
def _refractive_index(scene: Any, medium: int) -> float:
    return float(material_at(scene.materials, medium).index) if medium >= 0 else 1.0


@inner
def sample_dielectric(
    scene: Any,
    tile: Any,
    path: Any,
    owner: int,
    position: V3,
    face: V3,
    bound: float,
    normal: V3,
) -> bool:
    """Reflection and refraction; pushes the reflected path on the stack where there is room.

    Where dielectrics overlap, the one of higher PRIORITY is there and the other's surface is not
    seen; Schmidt and Budge, *Simple Nested Dielectrics in Ray Traced Images*, JGT 7(2), 2002.
    Colours are basic radiance, L / n²: they are not scaled at the surface. Returns whether
    ``path`` goes on.
    """
    d = heading_of(path)
    entering = dot(face, d) < 0.0
    now = find_medium(scene, path, -1)
    if entering:
        false_hit = now >= 0 and (
            material_at(scene.materials, now).priority
            > material_at(scene.materials, owner).priority
        )
        before, behind_index = _refractive_index(scene, now), _refractive_index(scene, owner)
    else:
        rest = find_medium(scene, path, owner)
        false_hit = now >= 0 and now != owner
        before, behind_index = _refractive_index(scene, owner), _refractive_index(scene, rest)
    if false_hit:
        if entering:
            replace_medium(path, -1, owner)
        else:
            replace_medium(path, owner, -1)
        pass_hit(scene, path)
        return True
    eta = behind_index / before
    cosine = min(abs(dot(normal, d)), 1.0)
    share, behind = evaluate_fresnel(cosine, eta)
    path.pdf = 0.0
    away = keep_above(reflect(d, normal), face_forward(face, d))
    if share >= 1.0:
        leave_surface(path, position, face, bound, away, REFLECTION)
        return True
    through = refract(d, normal, cosine, behind, eta)
    if path.depth <= SPLIT_DEPTH and tile.top < STACK:
        other = path_at(tile.stack, tile.top)
        copy_path(other, path)
        if is_significant(scene, scale_weight(other, (share, share, share))):
            leave_surface(other, position, face, bound, away, REFLECTION)
            tile.top += 1
        going = is_significant(scene, scale_weight(path, (1.0 - share, 1.0 - share, 1.0 - share)))
    else:
        x, _ = sample_2d(scene.seed, path.pixel, path.sample, hit_dimension(path, THIRD))
        if x < share:
            leave_surface(path, position, face, bound, away, REFLECTION)
            return True
        going = True
    if entering:
        replace_medium(path, -1, owner)
    else:
        replace_medium(path, owner, -1)
    leave_surface(path, position, face, bound, through, REFRACTION)
    return going

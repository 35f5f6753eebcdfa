"""``dielectric``: glass and water, with nested media and absorption."""

from __future__ import annotations

from typing import Any

from nau_py.model.attribute import colour, number
from nau_py.model.values import DataType
from nau_py.raytrace.kernels.core.jit import inner
from nau_py.raytrace.kernels.core.sampling import sample_2d
from nau_py.raytrace.kernels.core.tables import (
    REFLECTION,
    REFRACTION,
    STACK,
    copy_path,
    material_at,
    path_at,
)
from nau_py.raytrace.kernels.core.vec import dot, reflect
from nau_py.raytrace.kernels.geometry.surface import face_forward, keep_above
from nau_py.raytrace.kernels.shading.bsdf import evaluate_fresnel, refract
from nau_py.raytrace.kernels.shading.media import find_medium, refractive_index, replace_medium
from nau_py.raytrace.kernels.shading.radiance import add_coverage, scale_weight
from nau_py.raytrace.kernels.shading.scatter import (
    THIRD,
    hit_dimension,
    is_significant,
    leave_surface,
    pass_hit,
)
from nau_py.raytrace.programs.description import CLOSEST_HIT, BuiltInProgram, Effect

SPLIT_DEPTH = 4
"""Depth up to which both directions are followed; deeper, one of them by chance."""


@inner
def cross_surface(path: Any, owner: int, entering: bool) -> None:
    """Enter or leave the medium of material ``owner``."""
    if entering:
        replace_medium(path, -1, owner)
    else:
        replace_medium(path, owner, -1)


@inner
def shade_dielectric(scene: Any, tile: Any, ray_type: int, path: Any, hit: Any) -> bool:
    """Reflect and refract; push the reflected path on the stack if there is room.

    Where dielectrics overlap, the one of higher PRIORITY counts and the other's surface is not
    seen; Schmidt and Budge, *Simple Nested Dielectrics in Ray Traced Images*, JGT 7(2), 2002.
    Colours are basic radiance, L / n²: they are not scaled at the surface. Return True if ``path``
    continues.
    """
    add_coverage(tile, path)
    d, owner = hit.direction, hit.owner
    entering = dot(hit.face, d) < 0.0
    now = find_medium(scene, path, -1)
    if entering:
        false_hit = now >= 0 and (
            material_at(scene.materials, now).priority
            > material_at(scene.materials, owner).priority
        )
        before, behind_index = refractive_index(scene, now), refractive_index(scene, owner)
    else:
        rest = find_medium(scene, path, owner)
        false_hit = now >= 0 and now != owner
        before, behind_index = refractive_index(scene, owner), refractive_index(scene, rest)
    if false_hit:
        cross_surface(path, owner, entering)
        pass_hit(scene, path)
        return True
    eta = behind_index / before
    cosine = min(abs(dot(hit.normal, d)), 1.0)
    share, behind = evaluate_fresnel(cosine, eta)
    path.pdf = 0.0
    away = keep_above(reflect(d, hit.normal), face_forward(hit.face, d))
    if share >= 1.0:
        leave_surface(path, hit, away, REFLECTION)
        return True
    through = refract(d, hit.normal, cosine, behind, eta)
    if path.depth <= SPLIT_DEPTH and tile.top < STACK:
        other = path_at(tile.stack, tile.top)
        copy_path(other, path)
        if is_significant(scene, scale_weight(other, (share, share, share))):
            leave_surface(other, hit, away, REFLECTION)
            tile.top += 1
        rest_share = 1.0 - share
        going = is_significant(scene, scale_weight(path, (rest_share, rest_share, rest_share)))
    else:
        x, _ = sample_2d(scene.seed, path.pixel, path.sample, hit_dimension(path, THIRD))
        if x < share:
            leave_surface(path, hit, away, REFLECTION)
            return True
        going = True
    cross_surface(path, owner, entering)
    leave_surface(path, hit, through, REFRACTION)
    return going


PROGRAM = BuiltInProgram(
    "dielectric",
    CLOSEST_HIT,
    "Reflection and refraction: Fresnel, Snell, total internal reflection, ABSORPTION, "
    "overlaps by PRIORITY.",
    shade_dielectric,
    attributes=(
        number(
            "INDEX_OF_REFRACTION",
            DataType.FLOAT,
            1.5,
            "nau_py: refractive index of `dielectric`.",
            minimum=0.1,
            maximum=10.0,
        ),
        colour(
            "ABSORPTION",
            (0.0, 0.0, 0.0, 1.0),
            "nau_py: what `dielectric` absorbs on the way, per world unit.",
            unit_range=False,
        ),
        number(
            "PRIORITY",
            DataType.INT,
            0,
            "nau_py: where dielectrics overlap, the one of highest priority is there.",
        ),
    ),
    effects=(Effect("reflection", chain=True), Effect("refraction", chain=True)),
)

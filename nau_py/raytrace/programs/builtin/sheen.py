"""``sheen``: cloth, a diffuse surface under a layer of fibres that shines at grazing angles."""

from __future__ import annotations

from math import cos, exp, pi, sin, sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from nau_py.model.attribute import colour, number
from nau_py.model.values import DataType
from nau_py.raytrace.kernels.core.jit import V3, inner, kernel
from nau_py.raytrace.kernels.core.memory import field_reader
from nau_py.raytrace.kernels.core.tables import MATERIAL
from nau_py.raytrace.kernels.core.vec import add, dot, normalize, scale
from nau_py.raytrace.kernels.shading.bsdf import TABLE, look_up_albedo
from nau_py.raytrace.kernels.shading.closest_hit import evaluate_albedo, shadow_origin
from nau_py.raytrace.kernels.shading.emitters import add_emission, sample_emitters
from nau_py.raytrace.kernels.shading.lights import sample_lights
from nau_py.raytrace.kernels.shading.radiance import add_coverage, scale_weight
from nau_py.raytrace.kernels.shading.scatter import (
    leave_diffusely,
    sample_cosine_direction,
    survive_roulette,
)
from nau_py.raytrace.programs.description import CLOSEST_HIT, BuiltInProgram, Effect, LightUse

LEAST_ROUGHNESS = 0.1
"""Below it, the directional albedo of the formulas exceeds 1."""
LEAST_COSINE = 1e-4
TABLE_STEPS = 64
"""Steps along each angle in the integral of an entry of the table."""

sheen_of = field_reader(MATERIAL, "sheen")


class Cloth(NamedTuple):
    """The reflectance of a surface at a hit."""

    base: V3
    """Albedo of the diffuse part, less the light that the fibres reflect."""
    sheen: V3
    """SHEEN, 0 to 1."""
    roughness: float
    normal: V3
    away: V3
    """Unit direction to the origin of the ray."""


@inner
def fit_masking(cosine: float, roughness: float) -> float:
    """Return the fitted curve L of the masking of fibres (Estevez and Kulla 2017)."""
    k = (1.0 - roughness) * (1.0 - roughness)
    a = k * 25.3245 + (1.0 - k) * 21.5473
    b = k * 3.32435 + (1.0 - k) * 3.82987
    c = k * 0.16801 + (1.0 - k) * 0.19823
    d = k * -1.27393 + (1.0 - k) * -1.97760
    e = k * -4.85967 + (1.0 - k) * -4.32054
    curve: float = a / (1.0 + b * cosine**c) + d * cosine + e
    return curve


@inner
def evaluate_masking(cosine: float, roughness: float) -> float:
    """Return Λ of the Smith masking of fibres for a direction with ``cosine`` in [0, 1]."""
    if cosine < 0.5:
        return exp(fit_masking(cosine, roughness))
    return exp(2.0 * fit_masking(0.5, roughness) - fit_masking(1.0 - cosine, roughness))


@inner
def evaluate_fibres(to: float, away: float, half: float, roughness: float) -> float:
    """Return the BRDF of fibres of reflectance 1, per steradian.

    ``to``, ``away`` and ``half``: cosines with the normal of the directions to the light and to the
    eye, and of their half vector. Estevez and Kulla, *Production Friendly Microfacet Sheen BRDF*,
    SIGGRAPH 2017 course, without its softened terminator, so that the BRDF is reciprocal.
    """
    to, away = max(to, LEAST_COSINE), max(away, LEAST_COSINE)
    inverse = 1.0 / roughness
    sine = sqrt(max(0.0, 1.0 - half * half))
    density: float = (2.0 + inverse) * sine**inverse / (2.0 * pi)
    masking = 1.0 + evaluate_masking(to, roughness) + evaluate_masking(away, roughness)
    return density / (masking * 4.0 * to * away)


@kernel
def compute_albedo_table() -> NDArray[np.float64]:
    """Compute the directional albedo of fibres of reflectance 1, [roughness, root of the cosine].

    Both are in steps of 1/31. The root makes the steps fine at grazing angles, where the albedo
    changes fast. Midpoint rule over the polar angle, and the azimuth from 0 to π.
    """
    table = np.zeros((TABLE, TABLE))
    step = 1.0 / TABLE_STEPS
    for i in range(TABLE):
        roughness = max(i / (TABLE - 1), LEAST_ROUGHNESS)
        for j in range(TABLE):
            z = max((j / (TABLE - 1)) ** 2, LEAST_COSINE)
            away = sqrt(1.0 - z * z)
            total = 0.0
            for p in range(TABLE_STEPS):
                polar = (p + 0.5) * step * 0.5 * pi
                to = cos(polar)
                for q in range(TABLE_STEPS):
                    x = sin(polar) * cos((q + 0.5) * step * pi)
                    half = (to + z) / sqrt(2.0 + 2.0 * (x * away + to * z))
                    reflected = evaluate_fibres(to, z, half, roughness)
                    total += reflected * to * sin(polar)
            table[i, j] = min(total * step * step * pi * pi, 1.0)
    return table


@inner
def make_cloth(scene: Any, hit: Any) -> Cloth:
    """Return the reflectance at a hit. The fibres take from the diffuse part the light that they
    reflect, so that white cloth keeps all light."""
    c = sheen_of(hit.material)
    sheen = (min(max(c[0], 0.0), 1.0), min(max(c[1], 0.0), 1.0), min(max(c[2], 0.0), 1.0))
    roughness = min(max(float(hit.material.sheen_roughness), LEAST_ROUGHNESS), 1.0)
    away = scale(hit.direction, -1.0)
    cosine = max(dot(away, hit.normal), LEAST_COSINE)
    reflected = look_up_albedo(scene.sheen_albedo, roughness, sqrt(cosine))
    rest = 1.0 - max(sheen[0], sheen[1], sheen[2]) * reflected
    return Cloth(scale(evaluate_albedo(scene, hit), rest), sheen, roughness, hit.normal, away)


@inner
def reflect_cloth(cloth: Any, direction: V3, length: float) -> V3:
    """Return π times the BRDF for light from ``direction``, a vector of that length."""
    to = scale(direction, 1.0 / length)
    half = dot(normalize(add(to, cloth.away)), cloth.normal)
    fibres = evaluate_fibres(
        dot(to, cloth.normal), dot(cloth.away, cloth.normal), half, cloth.roughness
    )
    return add(cloth.base, scale(cloth.sheen, pi * fibres))


@inner
def shade_sheen(scene: Any, tile: Any, ray_type: int, path: Any, hit: Any) -> bool:
    """Add EMISSION and light; continue the path in a cosine-weighted direction."""
    add_coverage(tile, path)
    add_emission(scene, tile, path, hit.material, hit.face)
    cloth = make_cloth(scene, hit)
    origin, normal = shadow_origin(scene, hit), hit.normal
    sample_lights(scene, tile, ray_type, path, origin, normal, reflect_cloth, cloth)
    if path.depth >= scene.max_depth:
        return False
    sample_emitters(scene, tile, ray_type, path, origin, normal, reflect_cloth, cloth)
    direction, cosine = sample_cosine_direction(scene, path, hit)
    if not cosine > 0.0:
        return False
    largest = scale_weight(path, reflect_cloth(cloth, direction, 1.0))
    if not (largest > 0.0 and survive_roulette(scene, path, largest)):
        return False
    leave_diffusely(path, hit, direction, cosine)
    return True


PROGRAM = BuiltInProgram(
    "sheen",
    CLOSEST_HIT,
    "As `path`, under fibres that shine at grazing angles: SHEEN as their reflectance, "
    "SHEEN_ROUGHNESS.",
    shade_sheen,
    attributes=(
        colour("SHEEN", (0.0, 0.0, 0.0, 1.0), "nau_py: reflectance of the fibres of `sheen`."),
        number(
            "SHEEN_ROUGHNESS",
            DataType.FLOAT,
            0.3,
            "nau_py: roughness of the fibres of `sheen`: the width of the rim that shines.",
            minimum=LEAST_ROUGHNESS,
            maximum=1.0,
        ),
    ),
    tables={"sheen_albedo": compute_albedo_table},
    effects=(Effect("indirect", recursive=True),),
    lights=LightUse.EMITTERS,
)

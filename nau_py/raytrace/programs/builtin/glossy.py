"""``glossy``: rough reflection by microfacets, GGX with visible normals and energy compensation."""

from __future__ import annotations

from math import cos, pi, sin, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.model.attribute import number
from nau_py.model.values import DataType
from nau_py.raytrace.kernels.core.jit import V3, inner, kernel
from nau_py.raytrace.kernels.core.sampling import sample_2d
from nau_py.raytrace.kernels.core.tables import REFLECTION, specular_of
from nau_py.raytrace.kernels.core.vec import cross, dot, from_frame, make_frame, normalize
from nau_py.raytrace.kernels.geometry.surface import face_forward
from nau_py.raytrace.kernels.shading.bsdf import TABLE, look_up_albedo
from nau_py.raytrace.kernels.shading.radiance import add_coverage, scale_weight
from nau_py.raytrace.kernels.shading.scatter import (
    FIRST,
    continue_mirrored,
    hit_dimension,
    is_significant,
    leave_surface,
)
from nau_py.raytrace.programs.description import CLOSEST_HIT, BuiltInProgram, Effect

SMOOTH = 1e-3
"""GGX alpha up to which a surface is a perfect mirror."""
TABLE_SAMPLES = 256


@inner
def evaluate_masking(z: float, alpha: float) -> float:
    """Return Smith's masking G1 of GGX for a direction with cosine ``z`` (Heitz 2014, eq. 72)."""
    c2 = z * z
    tangent2 = max(0.0, 1.0 - c2) / max(c2, 1e-30)
    return 2.0 / (1.0 + sqrt(1.0 + alpha * alpha * tangent2))


@inner
def sample_visible_normal(w: V3, alpha: float, x: float, y: float) -> V3:
    """Sample a microfacet normal that is visible from ``w``; Heitz, *Sampling the GGX Distribution
    of Visible Normals*, JCGT 7(4), 2018."""
    v = normalize((alpha * w[0], alpha * w[1], w[2]))
    length2 = v[0] * v[0] + v[1] * v[1]
    if length2 > 1e-16:
        k = 1.0 / sqrt(length2)
        a = (-v[1] * k, v[0] * k, 0.0)
    else:
        a = (1.0, 0.0, 0.0)
    b = cross(v, a)
    r, phi = sqrt(x), 2.0 * pi * y
    p1, p2 = r * cos(phi), r * sin(phi)
    s = 0.5 * (1.0 + v[2])
    p2 = (1.0 - s) * sqrt(max(0.0, 1.0 - p1 * p1)) + s * p2
    p3 = sqrt(max(0.0, 1.0 - p1 * p1 - p2 * p2))
    n = (
        p1 * a[0] + p2 * b[0] + p3 * v[0],
        p1 * a[1] + p2 * b[1] + p3 * v[1],
        p1 * a[2] + p2 * b[2] + p3 * v[2],
    )
    return normalize((alpha * n[0], alpha * n[1], max(0.0, n[2])))


@inner
def sample_ggx(w: V3, alpha: float, x: float, y: float) -> tuple[V3, float]:
    """Sample a reflected direction in the frame of the normal. Return it, and its weight G2/G1.

    The weight is 0 below the horizon. Height-correlated masking (Heitz 2014, eq. 99).
    """
    m = sample_visible_normal(w, alpha, x, y)
    k = 2.0 * dot(w, m)
    out = (k * m[0] - w[0], k * m[1] - w[1], k * m[2] - w[2])
    if out[2] <= 0.0:
        return out, 0.0
    gi, go = evaluate_masking(w[2], alpha), evaluate_masking(out[2], alpha)
    return out, go / (gi + go - gi * go)


@kernel
def compute_albedo_table(samples: int) -> NDArray[np.float64]:
    """Compute the directional albedo of GGX without Fresnel, [roughness, cosine], steps of 1/31.

    It is the energy that one scattering event keeps. The rest is multiple scattering, which
    Turquin, *Practical multiple scattering compensation for microfacet models*, 2019, adds back.
    """
    table = np.ones((TABLE, TABLE))
    for i in range(1, TABLE):
        roughness = i / (TABLE - 1)
        alpha = max(roughness * roughness, SMOOTH)
        for j in range(TABLE):
            z = max(j / (TABLE - 1), 1e-3)
            w = (sqrt(1.0 - z * z), 0.0, z)
            total = 0.0
            for k in range(samples):
                x, y = sample_2d(np.uint32(1), np.uint32(i), np.uint32(k), np.uint32(j))
                total += sample_ggx(w, alpha, x, y)[1]
            table[i, j] = total / samples
    return table


@inner
def shade_glossy(scene: Any, tile: Any, ray_type: int, path: Any, hit: Any) -> bool:
    """Continue the path by GGX, with SPECULAR as its reflectance and ROUGHNESS² as its alpha.

    The energy of multiple scattering is added back (Turquin 2019), so that SPECULAR 1 loses none.
    """
    add_coverage(tile, path)
    specular = specular_of(hit.material)
    roughness = min(max(float(hit.material.roughness), 0.0), 1.0)
    alpha = roughness * roughness
    if alpha <= SMOOTH:
        return continue_mirrored(scene, path, hit, specular)
    s, t = make_frame(hit.normal)
    d = hit.direction
    w = (-dot(d, s), -dot(d, t), max(-dot(d, hit.normal), 1e-4))
    x, y = sample_2d(scene.seed, path.pixel, path.sample, hit_dimension(path, FIRST))
    out, weight = sample_ggx(w, alpha, x, y)
    kept = look_up_albedo(scene.glossy_albedo, roughness, w[2])
    lost = (1.0 - kept) / kept
    colour = (
        specular[0] * weight * (1.0 + specular[0] * lost),
        specular[1] * weight * (1.0 + specular[1] * lost),
        specular[2] * weight * (1.0 + specular[2] * lost),
    )
    direction = from_frame(s, t, hit.normal, out[0], out[1], out[2])
    going = weight > 0.0 and is_significant(scene, scale_weight(path, colour))
    if dot(direction, face_forward(hit.face, d)) <= 0.0:
        going = False
    path.pdf = 0.0
    leave_surface(path, hit, direction, REFLECTION)
    return going


PROGRAM = BuiltInProgram(
    "glossy",
    CLOSEST_HIT,
    "GGX reflection: SPECULAR as reflectance, ROUGHNESS; multiple scattering added back.",
    shade_glossy,
    attributes=(
        number(
            "ROUGHNESS",
            DataType.FLOAT,
            0.0,
            "nau_py: GGX roughness of `glossy`.",
            minimum=0.0,
            maximum=1.0,
        ),
    ),
    tables={"glossy_albedo": lambda: compute_albedo_table(TABLE_SAMPLES)},
    effects=(Effect("reflection", ("SPECULAR",), chain=True),),
)

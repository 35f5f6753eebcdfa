"""Scattering: Fresnel, refraction, GGX with visible normals and its energy compensation."""

from __future__ import annotations

from math import cos, pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.kernels.core.jit import V3, inner, kernel
from nau_py.raytrace.kernels.core.memory import f64
from nau_py.raytrace.kernels.core.sampling import sample_2d
from nau_py.raytrace.kernels.core.vec import cross, dot, normalize

SMOOTH = 1e-3
"""GGX alpha up to which a surface is a perfect mirror."""
TABLE = 32
"""Entries along each axis of the albedo table."""


@inner
def evaluate_fresnel(cosine: float, eta: float) -> tuple[float, float]:
    """Reflectance of unpolarised light and the cosine of the refracted direction.

    ``cosine`` in [0, 1]: of the arriving angle; ``eta``: index behind over index before. Total
    internal reflection gives (1, 0). Born and Wolf, *Principles of Optics*, 1.5.2.
    """
    sine2 = max(0.0, 1.0 - cosine * cosine) / (eta * eta)
    if sine2 >= 1.0:
        return 1.0, 0.0
    behind = sqrt(max(0.0, 1.0 - sine2))
    along = (eta * cosine - behind) / (eta * cosine + behind)
    across = (cosine - eta * behind) / (cosine + eta * behind)
    return min(1.0, 0.5 * (along * along + across * across)), behind


@inner
def refract(d: V3, n: V3, cosine: float, behind: float, eta: float) -> V3:
    """Snell's direction: ``n`` faces the arriving unit ``d``.

    ``cosine`` and ``behind``: of the arriving angle and of the refracted one, from
    ``evaluate_fresnel``."""
    k = cosine / eta - behind
    return normalize((d[0] / eta + k * n[0], d[1] / eta + k * n[1], d[2] / eta + k * n[2]))


@inner
def evaluate_masking(z: float, alpha: float) -> float:
    """Smith's masking G1 of GGX for a direction with cosine ``z`` (Heitz 2014, eq. 72)."""
    c2 = z * z
    tangent2 = max(0.0, 1.0 - c2) / max(c2, 1e-30)
    return 2.0 / (1.0 + sqrt(1.0 + alpha * alpha * tangent2))


@inner
def sample_visible_normal(w: V3, alpha: float, x: float, y: float) -> V3:
    """A microfacet normal seen from ``w``; Heitz, *Sampling the GGX Distribution of Visible
    Normals*, JCGT 7(4), 2018."""
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
    """A reflected direction in the frame of the normal, and its weight G2/G1.

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
def make_albedo_table(samples: int) -> NDArray[np.float64]:
    """Directional albedo of GGX without Fresnel, [roughness, cosine], both in steps of 1/31.

    What one scattering event keeps; the rest is multiple scattering, which Turquin,
    *Practical multiple scattering compensation for microfacet models*, 2019, adds back.
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
def look_up_albedo(table: int, roughness: float, cosine: float) -> float:
    """The value of the table at address ``table``, bilinear."""
    x = min(max(roughness, 0.0), 1.0) * (TABLE - 1)
    y = min(max(cosine, 0.0), 1.0) * (TABLE - 1)
    i, j = min(int(x), TABLE - 2), min(int(y), TABLE - 2)
    fx, fy = x - i, y - j
    at = i * TABLE + j
    low = f64(table, at) * (1 - fy) + f64(table, at + 1) * fy
    high = f64(table, at + TABLE) * (1 - fy) + f64(table, at + TABLE + 1) * fy
    return max(low * (1 - fx) + high * fx, 1e-3)

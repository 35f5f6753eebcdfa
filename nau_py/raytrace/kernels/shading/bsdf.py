"""Reflectance of surfaces: Fresnel's equations, refraction, tables of directional albedo."""

from __future__ import annotations

from math import sqrt

from nau_py.raytrace.kernels.core.jit import V3, inner
from nau_py.raytrace.kernels.core.memory import f64
from nau_py.raytrace.kernels.core.vec import normalize

TABLE = 32
"""Entries along each axis of a table of directional albedo: roughness and cosine, 0 to 1."""


@inner
def evaluate_fresnel(cosine: float, eta: float) -> tuple[float, float]:
    """Return the reflectance of unpolarised light, and the cosine of the refracted direction.

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
    """Return Snell's direction: ``n`` faces the arriving unit ``d``.

    ``cosine`` and ``behind``: of the arriving angle and of the refracted one, from
    ``evaluate_fresnel``.
    """
    k = cosine / eta - behind
    return normalize((d[0] / eta + k * n[0], d[1] / eta + k * n[1], d[2] / eta + k * n[2]))


@inner
def look_up_albedo(table: int, roughness: float, cosine: float) -> float:
    """Return the directional albedo in the table at address ``table``, bilinear; at least 1/1000.

    The table is float64 (TABLE, TABLE), [roughness, cosine], both in steps of 1/(TABLE - 1).
    """
    x = min(max(roughness, 0.0), 1.0) * (TABLE - 1)
    y = min(max(cosine, 0.0), 1.0) * (TABLE - 1)
    i, j = min(int(x), TABLE - 2), min(int(y), TABLE - 2)
    fx, fy = x - i, y - j
    at = i * TABLE + j
    low = f64(table, at) * (1 - fy) + f64(table, at + 1) * fy
    high = f64(table, at + TABLE) * (1 - fy) + f64(table, at + TABLE + 1) * fy
    return max(low * (1 - fx) + high * fx, 1e-3)

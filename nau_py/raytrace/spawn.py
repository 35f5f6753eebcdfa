"""Where a ray that leaves a surface begins.

The bounded spawn point of NVIDIA's *self-intersection-avoidance* (2023): the hit position from
barycentrics, moved along the face normal by a bound of its rounding error, then by one float.
"""

from __future__ import annotations

import numpy as np

from nau_py.raytrace.vectors import F32, cross, dot, normalize

C0 = np.float32(2.0**-24)
"""Factor of the base vertex in the object-space error."""
C1 = np.float32(3.0 * 2.0**-24)
"""Factor of the triangle's extent, and of the position in the world-space error."""


def surface_point(v0: F32, v1: F32, v2: F32, u: F32, v: F32) -> tuple[F32, F32, F32]:
    """Position, unit face normal and error bound of points on triangles.

    Vertices float32 (n, 3), world space; barycentrics float32 (n,). Returns float32 (n, 3),
    (n, 3) and (n,): the bound is a distance along the normal, world units.
    """
    e1, e2 = v1 - v0, v2 - v0
    position = v0 + (u[:, None] * e1 + v[:, None] * e2)
    normal = normalize(cross(e1.astype(np.float64), e2.astype(np.float64))).astype(np.float32)
    a1, a2 = np.abs(e1), np.abs(e2)
    sides = a1 + a2 + np.abs(a1 - a2)
    extent = np.maximum(np.maximum(sides[:, 0], sides[:, 1]), sides[:, 2])
    error = C0 * np.abs(v0) + (C1 * extent)[:, None] + C1 * np.abs(position)
    bound = dot(error, np.abs(normal)).astype(np.float32)
    return position, normal, bound


def spawn(position: F32, normal: F32, bound: F32, direction: F32) -> F32:
    """Origins for rays that leave along ``direction``: on its side of the face. float32 (n, 3)."""
    side = np.where(dot(normal, direction) >= 0, np.float32(1), np.float32(-1))
    offset = normal * (bound * side)[:, None]
    moved = position + offset
    toward = np.where(offset >= 0, np.float32(np.inf), np.float32(-np.inf))
    return np.where(offset == 0, moved, np.nextafter(moved, toward)).astype(np.float32)

"""Vectors as tuples of three float64."""

from __future__ import annotations

from math import sqrt

from nau_py.raytrace.kernels.core.jit import V3, inner


@inner
def dot(a: V3, b: V3) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inner
def cross(a: V3, b: V3) -> V3:
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


@inner
def scale(a: V3, s: float) -> V3:
    return (a[0] * s, a[1] * s, a[2] * s)


@inner
def add(a: V3, b: V3) -> V3:
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@inner
def subtract(a: V3, b: V3) -> V3:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@inner
def multiply(a: V3, b: V3) -> V3:
    return (a[0] * b[0], a[1] * b[1], a[2] * b[2])


@inner
def normalize(a: V3) -> V3:
    """Return the unit vector along ``a``; zero stays zero."""
    length = sqrt(dot(a, a))
    if length > 0.0:
        inverse = 1.0 / length
        return (a[0] * inverse, a[1] * inverse, a[2] * inverse)
    return (0.0, 0.0, 0.0)


@inner
def reflect(d: V3, n: V3) -> V3:
    """Return the mirror direction d - 2 (d·n) n about the unit normal ``n``."""
    k = 2.0 * dot(d, n)
    return (d[0] - k * n[0], d[1] - k * n[1], d[2] - k * n[2])


@inner
def make_frame(n: V3) -> tuple[V3, V3]:
    """Return two unit vectors that make a right-handed frame with the unit vector ``n``.

    Duff et al., *Building an Orthonormal Basis, Revisited*, JCGT 6(1), 2017.
    """
    sign = 1.0 if n[2] >= 0.0 else -1.0
    a = -1.0 / (sign + n[2])
    b = n[0] * n[1] * a
    s = (1.0 + sign * n[0] * n[0] * a, sign * b, -sign * n[0])
    t = (b, sign + n[1] * n[1] * a, -n[1])
    return s, t


@inner
def from_frame(s: V3, t: V3, n: V3, x: float, y: float, z: float) -> V3:
    """Return x s + y t + z n."""
    return (
        x * s[0] + y * t[0] + z * n[0],
        x * s[1] + y * t[1] + z * n[1],
        x * s[2] + y * t[2] + z * n[2],
    )

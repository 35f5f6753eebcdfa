"""Random numbers keyed by (seed, pixel, sample, dimension), and the directions made of them.

Points are Sobol's, padded pair by pair and scrambled as in Burley, *Practical Hash-based Owen
Scrambling*, JCGT 9(4), 2020; the first 2^k samples of a pixel are as well spread as any can be.
"""

from __future__ import annotations

from math import cos, pi, sin, sqrt

import numpy as np

from nau_py.raytrace.kernels.core.jit import V3, inner

_M = np.uint32(1664525)
_C = np.uint32(1013904223)
_16 = np.uint32(16)
_TO_UNIT = 2.0**-24
_8 = np.uint32(8)


@inner
def pcg4d(x: np.uint32, y: np.uint32, z: np.uint32, w: np.uint32) -> np.uint32:
    """Return the first word of pcg4d; Jarzynski and Olano, *Hash Functions for GPU Rendering*,
    2020."""
    x = np.uint32(x * _M + _C)
    y = np.uint32(y * _M + _C)
    z = np.uint32(z * _M + _C)
    w = np.uint32(w * _M + _C)
    x = np.uint32(x + y * w)
    y = np.uint32(y + z * x)
    z = np.uint32(z + x * y)
    w = np.uint32(w + y * z)
    x = np.uint32(x ^ (x >> _16))
    y = np.uint32(y ^ (y >> _16))
    z = np.uint32(z ^ (z >> _16))
    w = np.uint32(w ^ (w >> _16))
    return np.uint32(x + y * w)


@inner
def sample_1d(seed: np.uint32, pixel: np.uint32, sample: np.uint32, dimension: np.uint32) -> float:
    """Return a number in [0, 1)."""
    return float(pcg4d(pixel, sample, dimension, seed) >> _8) * _TO_UNIT


@inner
def reverse_bits(x: np.uint32) -> np.uint32:
    """Return the bits of ``x`` from the lowest to the highest."""
    x = np.uint32((x << np.uint32(16)) | (x >> np.uint32(16)))
    m = np.uint32(0x00FF00FF)
    x = np.uint32(((x & m) << np.uint32(8)) | ((x >> np.uint32(8)) & m))
    m = np.uint32(0x0F0F0F0F)
    x = np.uint32(((x & m) << np.uint32(4)) | ((x >> np.uint32(4)) & m))
    m = np.uint32(0x33333333)
    x = np.uint32(((x & m) << np.uint32(2)) | ((x >> np.uint32(2)) & m))
    m = np.uint32(0x55555555)
    return np.uint32(((x & m) << np.uint32(1)) | ((x >> np.uint32(1)) & m))


@inner
def scramble_bits(x: np.uint32, seed: np.uint32) -> np.uint32:
    """Return the permutation of Burley's listing 3, on reversed bits."""
    x = np.uint32(x + seed)
    x = np.uint32(x ^ (x * np.uint32(0x6C50B47C)))
    x = np.uint32(x ^ (x * np.uint32(0xB82F1E52)))
    x = np.uint32(x ^ (x * np.uint32(0xC7AFE638)))
    return np.uint32(x ^ (x * np.uint32(0x8D22F6E6)))


@inner
def sample_2d(
    seed: np.uint32, pixel: np.uint32, sample: np.uint32, dimension: np.uint32
) -> tuple[float, float]:
    """Return two numbers in [0, 1): point ``sample`` of the (0, 2)-sequence of the dimension."""
    key = pcg4d(pixel, dimension, np.uint32(0x9E3779B9), seed)
    index = reverse_bits(scramble_bits(reverse_bits(sample), key))
    second = np.uint32(0)
    column = np.uint32(0x80000000)
    rest = index
    while rest != np.uint32(0):
        if rest & np.uint32(1):
            second = np.uint32(second ^ column)
        rest = np.uint32(rest >> np.uint32(1))
        column = np.uint32(column ^ (column >> np.uint32(1)))
    a = np.uint32(key * np.uint32(0x9E3779B1) + np.uint32(0x7F4A7C15))
    b = np.uint32(a * np.uint32(0x9E3779B1) + np.uint32(0x7F4A7C15))
    x = reverse_bits(scramble_bits(index, a))
    y = reverse_bits(scramble_bits(reverse_bits(second), b))
    return float(x >> _8) * _TO_UNIT, float(y >> _8) * _TO_UNIT


@inner
def sample_disk(x: float, y: float) -> tuple[float, float]:
    """Return a uniform point of the unit disk; Shirley and Chiu's concentric map, JGT 2(3),
    1997."""
    a, b = 2.0 * x - 1.0, 2.0 * y - 1.0
    if a == 0.0 and b == 0.0:
        return 0.0, 0.0
    if abs(a) > abs(b):
        r, phi = a, (pi / 4.0) * (b / a)
    else:
        r, phi = b, (pi / 2.0) - (pi / 4.0) * (a / b)
    return r * cos(phi), r * sin(phi)


@inner
def sample_hemisphere(x: float, y: float) -> V3:
    """Return a direction about +z with density cos/pi (Malley's method)."""
    a, b = sample_disk(x, y)
    return a, b, sqrt(max(0.0, 1.0 - a * a - b * b))


@inner
def sample_sphere(x: float, y: float) -> V3:
    """Return a uniform direction."""
    z = 1.0 - 2.0 * x
    r = sqrt(max(0.0, 1.0 - z * z))
    return r * cos(2.0 * pi * y), r * sin(2.0 * pi * y), z

"""Random numbers keyed by (seed, pixel, sample, dimension), never by call order.

The hash is pcg4d of Jarzynski and Olano, *Hash Functions for GPU Rendering*, JCGT 9(3), 2020.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

U32 = NDArray[np.uint32]
_MULTIPLIER = np.uint32(1664525)
_INCREMENT = np.uint32(1013904223)
_SHIFT = np.uint32(16)
_TO_UNIT = np.float32(2.0**-24)


def pcg4d(x: U32, y: U32, z: U32, w: U32) -> U32:
    """The first word of pcg4d of four uint32 (n,) words; wraps modulo 2^32."""
    with np.errstate(over="ignore"):
        x, y, z, w = (k * _MULTIPLIER + _INCREMENT for k in (x, y, z, w))
        for step in range(2):
            x = x + y * w
            y = y + z * x
            z = z + x * y
            w = w + y * z
            if step == 0:
                x, y, z, w = (k ^ (k >> _SHIFT) for k in (x, y, z, w))
    return x


def uniform(seed: int, pixel: U32, sample: U32, dimension: int) -> NDArray[np.float32]:
    """Numbers in [0, 1), float32 (n,), for uint32 (n,) pixels and samples."""
    key = np.full_like(pixel, np.uint32(dimension & 0xFFFFFFFF))
    word = np.full_like(pixel, np.uint32(seed & 0xFFFFFFFF))
    return (pcg4d(pixel, sample, key, word) >> np.uint32(8)).astype(np.float32) * _TO_UNIT


def stratified(
    seed: int, pixel: U32, sample: U32, count: int, dimension: int
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Jittered points of the unit square, one of ``count`` strata each, float32 (n,) twice.

    One sample lies at the centre. A count that is no square is jittered over the whole pixel.
    """
    if count == 1:
        half = np.full(len(pixel), 0.5, np.float32)
        return half, half.copy()
    jitter = [uniform(seed, pixel, sample, dimension + k) for k in range(2)]
    side = round(count**0.5)
    if side * side != count:
        return jitter[0], jitter[1]
    column = (sample % np.uint32(side)).astype(np.float32)
    row = (sample // np.uint32(side)).astype(np.float32)
    scale = np.float32(side)
    below_one = np.nextafter(np.float32(1), np.float32(0))
    x = np.minimum((column + jitter[0]) / scale, below_one)
    y = np.minimum((row + jitter[1]) / scale, below_one)
    return x, y

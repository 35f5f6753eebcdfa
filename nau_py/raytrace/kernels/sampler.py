"""Textures as CUDA reads them for compiled PTX programs: wrapped, bilinear or by point.

*CUDA C++ Programming Guide*, "Texture Fetching": with linear filtering the weights have 8 bits.
"""

from __future__ import annotations

from functools import lru_cache
from math import floor
from typing import Any

import numba
import numpy as np
from numba import types

from nau_py.raytrace.kernels.jit import inner
from nau_py.raytrace.kernels.memory import f32, i8, i32, i64, put_f32

TEXTURE = np.dtype(
    [
        ("texels", "u8"),
        ("width", "i4"),
        ("height", "i4"),
        ("depth", "i4"),
        ("channels", "i4"),
        ("linear", "i4"),
        ("dimensions", "i4"),
    ],
    align=True,
)
"""A texture object: address of the texels, row 0 at the bottom; ``linear``: bytes that are read as
0 to 1 between texels, else float32 by the nearest one; ``dimensions``: 2 or 3, in which it must be
asked for: else all is 0."""
_WEIGHT = 256.0


@inner
def _wrapped(index: int, size: int) -> int:
    return index % size if size > 0 else 0


@inner
def _texel(handle: Any, texels: Any, at: int, channel: int) -> float:
    """One channel of a texel; missing ones are 0, a missing alpha of bytes is 1."""
    channels = i32(handle, 5)
    if channel >= channels:
        return 0.0
    if i32(handle, 6) != 0:
        return (i8(texels, at * channels + channel) & 255) / 255.0
    return f32(texels, at * channels + channel)


def _sample(handle: Any, dimensions: int, x: float, y: float, z: float, out: Any) -> None:
    if handle == 0 or i32(handle, 7) != dimensions:
        for channel in range(4):
            put_f32(out, channel, 0.0)
        return
    texels = np.uint64(i64(handle, 0))
    width, height, depth = i32(handle, 2), i32(handle, 3), i32(handle, 4)
    if i32(handle, 6) == 0:
        i = min(int((x - floor(x)) * width), width - 1)
        j = min(int((y - floor(y)) * height), height - 1)
        k = min(int((z - floor(z)) * depth), depth - 1)
        for channel in range(4):
            put_f32(out, channel, _texel(handle, texels, (k * height + j) * width + i, channel))
        return
    u, v = x * width - 0.5, y * height - 0.5
    i, j = floor(u), floor(v)
    a = floor((u - i) * _WEIGHT + 0.5) / _WEIGHT
    b = floor((v - j) * _WEIGHT + 0.5) / _WEIGHT
    left, right = _wrapped(i, width), _wrapped(i + 1, width)
    below, above = _wrapped(j, height) * width, _wrapped(j + 1, height) * width
    for channel in range(4):
        low = _texel(handle, texels, below + left, channel) * (1 - a)
        low += _texel(handle, texels, below + right, channel) * a
        high = _texel(handle, texels, above + left, channel) * (1 - a)
        high += _texel(handle, texels, above + right, channel) * a
        put_f32(out, channel, low * (1 - b) + high * b)


@lru_cache(maxsize=1)
def sampler() -> Any:
    """The compiled sampler; ``address`` is where it stands."""
    at = (types.float32, types.float32, types.float32)
    signature = types.void(types.uint64, types.int32, *at, types.uint64)
    return numba.cfunc(signature, error_model="numpy")(_sample)

"""Textures as CUDA reads them for compiled PTX programs: wrapped, between texels or by point.

*CUDA C++ Programming Guide*, "Texture Fetching": with linear filtering the weights have 8 bits.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from math import floor
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.kernels.core.jit import callback, inner
from nau_py.raytrace.kernels.core.memory import f32, i8, i32, i64, put_f32

TEXTURE = np.dtype(
    [
        ("texels", "u8"),
        ("width", "i4"),
        ("height", "i4"),
        ("depth", "i4"),
        ("channels", "i4"),
        ("bytes", "i4"),
        ("dimensions", "i4"),
        ("linear", "i4"),
        ("clamp", "i4"),
        ("by_texel", "i4"),
        ("exact", "i4"),
    ],
    align=True,
)
"""A texture object: address of the texels, row 0 at the bottom; ``bytes``: they are read as 0 to 1,
else they are float32; ``dimensions``: 2 or 3, dimensions of the fetch, else it returns 0;
``linear``: between texels, else the nearest; ``clamp``: 1 for the first axis, 2 for the second:
the last texel goes on, else the texture repeats; ``by_texel``: coordinates count texels;
``exact``: weights are not rounded to 8 bits."""
_WEIGHT = 256.0


@dataclass(slots=True)
class Image:
    """A texture: uint8 or float32 (h, w, c), or (d, h, w, c) for a volume. By default bytes are
    read between texels and floats by the nearest, as Nau sets it."""

    texels: NDArray[Any]
    linear: bool | None = None
    clamp: tuple[bool, bool] = (False, False)
    by_texel: bool = False
    exact: bool = False
    record: NDArray[np.void] = field(init=False)

    def __post_init__(self) -> None:
        texels: NDArray[Any] = np.ascontiguousarray(self.texels)
        self.texels = texels
        shape = texels.shape if texels.ndim == 4 else (1, *texels.shape)
        self.record = np.zeros(1, TEXTURE)
        self.record["texels"] = texels.ctypes.data
        self.record["depth"], self.record["height"], self.record["width"] = shape[:3]
        of_bytes = texels.dtype == np.uint8
        self.record["channels"], self.record["bytes"] = shape[3], of_bytes
        self.record["dimensions"] = texels.ndim - 1
        self.record["linear"] = of_bytes if self.linear is None else self.linear
        self.record["clamp"] = self.clamp[0] + 2 * self.clamp[1]
        self.record["by_texel"], self.record["exact"] = self.by_texel, self.exact

    @property
    def handle(self) -> int:
        return int(self.record.ctypes.data)


@inner
def _wrapped(index: int, size: int, clamp: int) -> int:
    if size <= 0:
        return 0
    return min(max(index, 0), size - 1) if clamp != 0 else index % size


@inner
def _texel(handle: Any, texels: Any, at: int, channel: int) -> float:
    """Return one channel of a texel; missing ones are 0."""
    channels = i32(handle, 5)
    if channel >= channels:
        return 0.0
    if i32(handle, 6) != 0:
        return (i8(texels, at * channels + channel) & 255) / 255.0
    return f32(texels, at * channels + channel)


@inner
def _scaled(x: float, size: int, by_texel: bool) -> float:
    return x if by_texel else x * size


@inner
def _nearest(x: float, scaled: float, size: int, plain: bool) -> int:
    """Return the texel at a coordinate; one that repeats is reduced before it is scaled."""
    return floor(scaled) if plain else min(int((x - floor(x)) * size), size - 1)


@inner
def _weight(place: float, exact: bool) -> float:
    part = place - floor(place)
    return part if exact else floor(part * _WEIGHT + 0.5) / _WEIGHT


@inner
def _plane(
    handle: Any, texels: Any, row: int, left: int, right: int, low: int, high: int,
    a: float, b: float, channel: int,
) -> float:  # fmt: skip
    """Interpolate between four texels; ``row``: the first texel of the plane."""
    under = _texel(handle, texels, row + low + left, channel) * (1 - a)
    under += _texel(handle, texels, row + low + right, channel) * a
    over = _texel(handle, texels, row + high + left, channel) * (1 - a)
    over += _texel(handle, texels, row + high + right, channel) * a
    return under * (1 - b) + over * b


def _sample(handle: Any, dimensions: int, x: float, y: float, z: float, out: Any) -> None:
    finite = abs(x) < 1e9 and abs(y) < 1e9 and abs(z) < 1e9
    if handle == 0 or i32(handle, 7) != dimensions or not finite:
        for channel in range(4):
            put_f32(out, channel, 0.0)
        return
    texels = np.uint64(i64(handle, 0))
    width, height, depth = i32(handle, 2), i32(handle, 3), i32(handle, 4)
    clamp_x, clamp_y = i32(handle, 9) & 1, i32(handle, 9) & 2
    linear, by_texel = i32(handle, 8) != 0, i32(handle, 10) != 0
    u, v, w = _scaled(x, width, by_texel), _scaled(y, height, by_texel), _scaled(z, depth, by_texel)
    if not linear:
        i = _wrapped(_nearest(x, u, width, by_texel or clamp_x != 0), width, clamp_x)
        j = _wrapped(_nearest(y, v, height, by_texel or clamp_y != 0), height, clamp_y)
        k = _wrapped(_nearest(z, w, depth, by_texel), depth, 0)
        for channel in range(4):
            put_f32(out, channel, _texel(handle, texels, (k * height + j) * width + i, channel))
        return
    u, v, w = u - 0.5, v - 0.5, w - 0.5
    i, j = floor(u), floor(v)
    exact = i32(handle, 11) != 0
    a, b = _weight(u, exact), _weight(v, exact)
    left, right = _wrapped(i, width, clamp_x), _wrapped(i + 1, width, clamp_x)
    low, high = _wrapped(j, height, clamp_y) * width, _wrapped(j + 1, height, clamp_y) * width
    if depth == 1:
        for channel in range(4):
            put_f32(out, channel, _plane(handle, texels, 0, left, right, low, high, a, b, channel))
        return
    c, size = _weight(w, exact), width * height
    near, far = _wrapped(floor(w), depth, 0) * size, _wrapped(floor(w) + 1, depth, 0) * size
    for channel in range(4):
        front = _plane(handle, texels, near, left, right, low, high, a, b, channel)
        back = _plane(handle, texels, far, left, right, low, high, a, b, channel)
        put_f32(out, channel, front * (1 - c) + back * c)


@lru_cache(maxsize=1)
def sampler_address() -> int:
    """Compile the sampler; return the address of its code.

    Its C type is ``void(uint64 handle, int32 dimensions, float x, float y, float z, uint64 out)``.
    """
    return callback(_sample, "void(uint64, int32, float32, float32, float32, uint64)")

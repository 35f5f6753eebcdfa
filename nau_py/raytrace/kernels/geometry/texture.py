"""Texture look-ups: bilinear on level 0, Nau's wrap rules (docs/format.md, 9.7)."""

from __future__ import annotations

from math import floor, isfinite
from typing import Any

from nau_py.raytrace.kernels.core.jit import inner
from nau_py.raytrace.kernels.core.memory import i8, i32
from nau_py.raytrace.kernels.core.tables import border_of

RGBA = tuple[float, float, float, float]
REPEAT, MIRRORED_REPEAT, CLAMP_TO_EDGE, CLAMP_TO_BORDER = 0, 1, 2, 3


@inner
def wrap_index(index: float, size: float, rule: int) -> int:
    """Return the texel index by wrap rule; -1 on the border colour."""
    if 0.0 <= index < size:
        return int(index)
    if rule == REPEAT:
        return int(min(index - floor(index / size) * size, size - 1.0))
    if rule == MIRRORED_REPEAT:
        folded = index - floor(index / (2 * size)) * (2 * size)
        return int(min(folded if folded < size else 2 * size - 1 - folded, size - 1.0))
    if rule == CLAMP_TO_BORDER and (index < 0 or index >= size):
        return -1
    return int(min(max(index, 0.0), size - 1.0))


@inner
def fetch_texel(texture: Any, texels: int, x: float, y: float) -> RGBA:
    """Return one texel, 0 to 255; ``texels``: the address of the bytes, in the order R, G, B, A."""
    column = wrap_index(x, float(texture.width), texture.wrap_s)
    row = wrap_index(y, float(texture.height), texture.wrap_t)
    if column < 0 or row < 0:
        b = border_of(texture)
        return b[0] * 255.0, b[1] * 255.0, b[2] * 255.0, b[3] * 255.0
    return unpack_bytes(i32(texels, (texture.offset >> 2) + row * texture.width + column))


@inner
def unpack_bytes(word: int) -> RGBA:
    """Return the four bytes of a texel."""
    return (
        float(word & 255),
        float((word >> 8) & 255),
        float((word >> 16) & 255),
        float((word >> 24) & 255),
    )


@inner
def scale_to_texels(texture: Any, s: float, t: float) -> tuple[float, float]:
    """Return texture coordinates in texels. Those that repeat are brought into the image first."""
    if not (isfinite(s) and isfinite(t)):
        return 0.0, 0.0
    if texture.wrap_s == REPEAT:
        s -= floor(s)
    if texture.wrap_t == REPEAT:
        t -= floor(t)
    return s * texture.width, t * texture.height


@inner
def is_interior(texture: Any, x0: float, y0: float) -> bool:
    """Test if the four texels from (x0, y0) on are in the image."""
    return bool(x0 >= 0.0 and y0 >= 0.0 and x0 + 1 < texture.width and y0 + 1 < texture.height)


@inner
def filter_texture(texture: Any, texels: int, s: float, t: float) -> RGBA:
    """Return RGBA at texture coordinates; the linear filter of OpenGL 4.5, 8.14.2."""
    x, y = scale_to_texels(texture, s, t)
    if texture.nearest:
        a = fetch_texel(texture, texels, floor(x), floor(y))
        return a[0] / 255.0, a[1] / 255.0, a[2] / 255.0, a[3] / 255.0
    x, y = x - 0.5, y - 0.5
    x0, y0 = floor(x), floor(y)
    fx, fy = x - x0, y - y0
    if is_interior(texture, x0, y0):
        at = (texture.offset >> 2) + int(y0) * texture.width + int(x0)
        a, b = unpack_bytes(i32(texels, at)), unpack_bytes(i32(texels, at + 1))
        at += texture.width
        c, d = unpack_bytes(i32(texels, at)), unpack_bytes(i32(texels, at + 1))
    else:
        a = fetch_texel(texture, texels, x0, y0)
        b = fetch_texel(texture, texels, x0 + 1, y0)
        c = fetch_texel(texture, texels, x0, y0 + 1)
        d = fetch_texel(texture, texels, x0 + 1, y0 + 1)
    high, low = fy / 255.0, (1 - fy) / 255.0
    wa, wb, wc, wd = (1 - fx) * low, fx * low, (1 - fx) * high, fx * high
    return (
        a[0] * wa + b[0] * wb + c[0] * wc + d[0] * wd,
        a[1] * wa + b[1] * wb + c[1] * wc + d[1] * wd,
        a[2] * wa + b[2] * wb + c[2] * wc + d[2] * wd,
        a[3] * wa + b[3] * wb + c[3] * wc + d[3] * wd,
    )


@inner
def filter_alpha(texture: Any, texels: int, s: float, t: float) -> float:
    """Return the last component of ``filter_texture``, in less time."""
    x, y = scale_to_texels(texture, s, t)
    x0, y0 = floor(x - 0.5), floor(y - 0.5)
    if texture.nearest or not is_interior(texture, x0, y0):
        return filter_texture(texture, texels, s, t)[3]
    fx, fy = x - 0.5 - x0, y - 0.5 - y0
    at = texture.offset + 4 * (int(y0) * texture.width + int(x0)) + 3
    below = 4 * texture.width
    a, b = i8(texels, at) & 255, i8(texels, at + 4) & 255
    c, d = i8(texels, at + below) & 255, i8(texels, at + below + 4) & 255
    high, low = fy / 255.0, (1 - fy) / 255.0
    return a * ((1 - fx) * low) + b * (fx * low) + c * ((1 - fx) * high) + d * (fx * high)

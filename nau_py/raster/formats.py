"""Nau's internal formats in OpenGL (docs/format.md, 6.2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nau_py.raster.gl import GL

_LAYOUTS = {1: GL.GL_RED, 2: GL.GL_RG, 4: GL.GL_RGBA}
_INTEGER_LAYOUTS = {1: GL.GL_RED_INTEGER, 2: GL.GL_RG_INTEGER, 4: GL.GL_RGBA_INTEGER}
_KINDS: dict[str, tuple[int, type[np.generic], bool]] = {
    "8": (GL.GL_UNSIGNED_BYTE, np.uint8, False),
    "16": (GL.GL_UNSIGNED_SHORT, np.uint16, False),
    "16F": (GL.GL_HALF_FLOAT, np.float16, False),
    "32F": (GL.GL_FLOAT, np.float32, False),
    "8I": (GL.GL_BYTE, np.int8, True),
    "16I": (GL.GL_SHORT, np.int16, True),
    "32I": (GL.GL_INT, np.int32, True),
    "8UI": (GL.GL_UNSIGNED_BYTE, np.uint8, True),
    "16UI": (GL.GL_UNSIGNED_SHORT, np.uint16, True),
    "32UI": (GL.GL_UNSIGNED_INT, np.uint32, True),
}
_DEPTH_KINDS = {
    "DEPTH_COMPONENT16": GL.GL_DEPTH_COMPONENT16,
    "DEPTH_COMPONENT24": GL.GL_DEPTH_COMPONENT24,
    "DEPTH_COMPONENT32F": GL.GL_DEPTH_COMPONENT32F,
    "DEPTH32F_STENCIL8": GL.GL_DEPTH32F_STENCIL8,
    "DEPTH24_STENCIL8": GL.GL_DEPTH24_STENCIL8,
}


@dataclass(frozen=True, slots=True)
class PixelFormat:
    """One internal format. ``dtype`` and ``channels`` describe read-back arrays."""

    name: str
    internal: int
    layout: int
    kind: int
    dtype: type[np.generic]
    channels: int
    integer: bool = False
    depth: bool = False
    stencil: bool = False


def pixel_format(name: str) -> PixelFormat:
    """Return the format called ``name``; ``RGBA`` is 8-bit normalised, as in Nau."""
    if name in _DEPTH_KINDS:
        stencil = "STENCIL" in name
        return PixelFormat(
            name,
            _DEPTH_KINDS[name],
            GL.GL_DEPTH_COMPONENT,
            GL.GL_FLOAT,
            np.float32,
            1,
            depth=True,
            stencil=stencil,
        )
    family = "RGBA" if name.startswith("RGBA") else "RG" if name.startswith("RG") else "R"
    channels = len(family)
    suffix = name[channels:] or "8"
    kind, dtype, integer = _KINDS[suffix]
    layout = (_INTEGER_LAYOUTS if integer else _LAYOUTS)[channels]
    internal = int(getattr(GL, f"GL_{family}{suffix}"))
    return PixelFormat(name, internal, layout, kind, dtype, channels, integer)

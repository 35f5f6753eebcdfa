"""Texture look-ups at hits: bilinear on level 0, Nau's wrap rules (nau-format.md, 9.7)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.vectors import F32

WHITE = np.ones(4, np.float32)


@dataclass(frozen=True, slots=True)
class RayTexture:
    """Texels uint8 (height, width, 1, 2 or 4), row 0 at the bottom, with its sampler."""

    texels: NDArray[np.uint8]
    wrap_s: str = "REPEAT"
    wrap_t: str = "REPEAT"
    nearest: bool = False
    border: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)

    def sample(self, uv: F32) -> F32:
        """RGBA float32 (n, 4) in 0..1 at texture coordinates (n, 2 or more).

        Missing channels are 0 and alpha 1, as in GL. The filter is the linear one of the OpenGL
        4.5 specification, section 8.14.2.
        """
        height, width = self.texels.shape[:2]
        finite = np.where(np.isfinite(uv[:, :2]), uv[:, :2], np.float32(0)).astype(np.float64)
        x, y = finite[:, 0] * width, finite[:, 1] * height
        if self.nearest:
            return self._fetch(np.floor(x), np.floor(y))
        x, y = x - 0.5, y - 0.5
        x0, y0 = np.floor(x), np.floor(y)
        fx, fy = (x - x0).astype(np.float32)[:, None], (y - y0).astype(np.float32)[:, None]
        low = self._fetch(x0, y0) * (1 - fx) + self._fetch(x0 + 1, y0) * fx
        high = self._fetch(x0, y0 + 1) * (1 - fx) + self._fetch(x0 + 1, y0 + 1) * fx
        return np.asarray(low * (1 - fy) + high * fy, np.float32)

    def _fetch(self, x: NDArray[np.float64], y: NDArray[np.float64]) -> F32:
        height, width, channels = self.texels.shape
        column, outside_s = _wrap(x, width, self.wrap_s)
        row, outside_t = _wrap(y, height, self.wrap_t)
        raw = self.texels[row, column].astype(np.float32) / np.float32(255)
        if channels == 4:
            rgba = raw
        else:
            rgba = np.zeros((len(raw), 4), np.float32)
            rgba[:, :channels] = raw
            rgba[:, 3] = 1
        outside = outside_s | outside_t
        if outside.any():
            rgba = np.where(outside[:, None], np.array(self.border, np.float32), rgba)
        return rgba


def _wrap(
    index: NDArray[np.float64], size: int, rule: str
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Texel indices by wrap rule, and which of them lie on the border colour."""
    inside = np.zeros(len(index), bool)
    if rule == "REPEAT":
        return np.mod(index, size).astype(np.int64), inside
    if rule == "MIRRORED_REPEAT":
        folded = np.mod(index, 2 * size)
        return np.where(folded < size, folded, 2 * size - 1 - folded).astype(np.int64), inside
    if rule == "CLAMP_TO_BORDER":
        inside = (index < 0) | (index >= size)
    return np.clip(index, 0, size - 1).astype(np.int64), inside

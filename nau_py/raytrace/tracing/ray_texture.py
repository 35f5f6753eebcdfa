"""Textures that rays read: mipmap level 0, with a sampler."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.kernels.core.tables import TEXTURE
from nau_py.raytrace.kernels.geometry import texture as kernel
from nau_py.raytrace.kernels.path.hit_arrays import sample_textures
from nau_py.raytrace.tracing.arrays import F32

WHITE = np.ones(4, np.float32)
_RULES = {
    "REPEAT": kernel.REPEAT,
    "MIRRORED_REPEAT": kernel.MIRRORED_REPEAT,
    "CLAMP_TO_BORDER": kernel.CLAMP_TO_BORDER,
}


@dataclass(frozen=True)
class RayTexture:
    """Texels uint8 (height, width, 1, 2 or 4), row 0 at the bottom, with its sampler."""

    texels: NDArray[np.uint8]
    wrap_s: str = "REPEAT"
    wrap_t: str = "REPEAT"
    nearest: bool = False
    border: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)

    @cached_property
    def rgba(self) -> NDArray[np.uint8]:
        """Texels uint8 (height · width · 4,): missing channels are 0 and alpha 1, as in GL."""
        height, width, channels = self.texels.shape
        if channels == 4:
            return np.ascontiguousarray(self.texels).reshape(-1)
        wide = np.zeros((height, width, 4), np.uint8)
        wide[..., :channels] = self.texels
        wide[..., 3] = 255
        return wide.reshape(-1)

    @cached_property
    def least_alpha(self) -> float:
        """Least alpha that a sample can have, 0 to 1."""
        least = float(self.rgba[3::4].min()) / 255
        outside = "CLAMP_TO_BORDER" in (self.wrap_s, self.wrap_t)
        return min(least, float(self.border[3])) if outside else least

    def make_record(self, offset: int) -> NDArray[np.void]:
        """Return the kernels' record of this texture, whose texels begin at ``offset``, (1,)."""
        made = np.zeros(1, TEXTURE)
        made["offset"], made["nearest"] = offset, self.nearest
        made["height"], made["width"] = self.texels.shape[:2]
        made["wrap_s"] = _RULES.get(self.wrap_s, kernel.CLAMP_TO_EDGE)
        made["wrap_t"] = _RULES.get(self.wrap_t, kernel.CLAMP_TO_EDGE)
        made["border"] = self.border
        return made

    def sample(self, uv: F32) -> F32:
        """Return RGBA float32 (n, 4) in 0..1 at texture coordinates (n, 2 or more)."""
        result = np.empty((len(uv), 4), np.float32)
        coordinates = np.ascontiguousarray(uv, np.float32)
        sample_textures(self.make_record(0), self.rgba.ctypes.data, coordinates, result)
        return result

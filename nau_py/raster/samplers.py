"""Sampler objects from Nau's sampler settings (docs/format.md, 9.7)."""

from __future__ import annotations

import numpy as np

from nau_py.model.values import Scalar
from nau_py.raster import gl
from nau_py.raster.gl import GL

Settings = tuple[tuple[str, tuple[Scalar, ...]], ...]

_WRAPS = {
    "WRAP_S": GL.GL_TEXTURE_WRAP_S,
    "WRAP_T": GL.GL_TEXTURE_WRAP_T,
    "WRAP_R": GL.GL_TEXTURE_WRAP_R,
}
_PLAIN = {
    "NEAREST_MIPMAP_NEAREST": "NEAREST",
    "NEAREST_MIPMAP_LINEAR": "NEAREST",
    "LINEAR_MIPMAP_NEAREST": "LINEAR",
    "LINEAR_MIPMAP_LINEAR": "LINEAR",
}
_MIPPED = {"NEAREST": "NEAREST_MIPMAP_NEAREST", "LINEAR": "LINEAR_MIPMAP_LINEAR"}


def choose_filter(name: str | None, mipmap: bool) -> str:
    """Choose the filter: the variant that the texture supports, as Nau does."""
    if name is None:
        return "LINEAR_MIPMAP_LINEAR" if mipmap else "LINEAR"
    return _MIPPED.get(name, name) if mipmap else _PLAIN.get(name, name)


class Samplers:
    """Sampler objects by their settings."""

    def __init__(self) -> None:
        self._made: dict[tuple[Settings, bool], int] = {}

    def get(self, settings: Settings, mipmap: bool) -> int:
        """Return the sampler for ``settings``. ``mipmap``: the texture has mip levels."""
        key = (settings, mipmap)
        if key not in self._made:
            self._made[key] = self._make(dict(settings), mipmap)
        return self._made[key]

    def release(self) -> None:
        """Delete all samplers."""
        gl.delete_samplers(list(self._made.values()))
        self._made.clear()

    def _make(self, settings: dict[str, tuple[Scalar, ...]], mipmap: bool) -> int:
        sampler = gl.create_sampler()

        def enum(name: str, default: str) -> int:
            return int(getattr(GL, f"GL_{settings.get(name, (default,))[0]}"))

        for name, parameter in _WRAPS.items():
            GL.glSamplerParameteri(sampler, parameter, enum(name, "REPEAT"))
        given = settings.get("MIN_FILTER")
        filter_ = choose_filter(str(given[0]) if given else None, mipmap)
        GL.glSamplerParameteri(sampler, GL.GL_TEXTURE_MIN_FILTER, getattr(GL, f"GL_{filter_}"))
        GL.glSamplerParameteri(sampler, GL.GL_TEXTURE_MAG_FILTER, enum("MAG_FILTER", "LINEAR"))
        compare = enum("COMPARE_MODE", "NONE")
        GL.glSamplerParameteri(sampler, GL.GL_TEXTURE_COMPARE_MODE, compare)
        GL.glSamplerParameteri(sampler, GL.GL_TEXTURE_COMPARE_FUNC, enum("COMPARE_FUNC", "LEQUAL"))
        border = [float(v) for v in settings.get("BORDER_COLOR", (0.0,) * 4)]
        border += [0.0] * (4 - len(border))
        GL.glSamplerParameterfv(sampler, GL.GL_TEXTURE_BORDER_COLOR, np.array(border, np.float32))
        return sampler

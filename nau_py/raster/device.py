"""The OpenGL context: headless EGL, hardware or Mesa's software driver."""

from __future__ import annotations

import sys
from functools import lru_cache
from typing import Any

import moderngl

from nau_py.diagnostics.diagnostic import error
from nau_py.diagnostics.errors import DeviceError
from nau_py.diagnostics.location import NOWHERE

REQUIRED_VERSION = 450
HOW_TO_GET = (
    "install Mesa's drivers (Debian: apt-get install libegl1 libgl1 libgl1-mesa-dri), "
    "which draw without a GPU"
)


class Device:
    """A moderngl context that is current in this thread."""

    def __init__(self) -> None:
        options: dict[str, Any] = {"backend": "egl"} if sys.platform.startswith("linux") else {}
        try:
            self.ctx = moderngl.create_context(standalone=True, require=REQUIRED_VERSION, **options)
        except Exception as problem:  # glcontext raises plain Exception
            raise DeviceError(
                error(
                    "D101",
                    NOWHERE,
                    f"no OpenGL {REQUIRED_VERSION / 100:.1f} driver: {problem}; {HOW_TO_GET}",
                )
            ) from None
        self.ctx.gc_mode = "auto"
        info = self.ctx.info
        self.renderer = str(info["GL_RENDERER"])
        self.version = str(info["GL_VERSION"])
        self.max_size = int(info["GL_MAX_TEXTURE_SIZE"])
        """Upper bound for the width and height of a texture, in texels."""
        self.max_samples = int(info["GL_MAX_SAMPLES"])
        """Upper bound for the samples per texel of a multisample texture."""

    @property
    def is_software(self) -> bool:
        return "llvmpipe" in self.renderer or "softpipe" in self.renderer


@lru_cache(maxsize=1)
def get_device() -> Device:
    """Return the process's device, opened at first use. Raises :class:`~nau_py.DeviceError`."""
    return Device()

"""Image files as arrays, by Nau's decoding rules (docs/format.md, 6.3)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError


class ImageError(Exception):
    """An image file cannot be decoded."""


def load_image(path: Path) -> NDArray[np.uint8]:
    """Load the texels, uint8 (height, width, channels), row 0 at the bottom; 1, 2 or 4 channels.

    Greyscale gives one channel, greyscale with alpha two, everything else RGBA. No sRGB
    conversion. Raises :class:`ImageError`.
    """
    try:
        with Image.open(path) as image:
            if image.mode in ("L", "1"):
                decoded = image.convert("L")
            elif image.mode in ("LA", "La"):
                decoded = image.convert("LA")
            elif image.mode.startswith("I;16") or image.mode in ("I", "F"):
                raise ImageError(f"its pixel type '{image.mode}' is not supported")
            else:
                decoded = image.convert("RGBA")
            texels = np.asarray(decoded, np.uint8)
    except (OSError, UnidentifiedImageError, ValueError, SyntaxError) as error:
        raise ImageError(str(error) or "it cannot be decoded") from None
    if texels.ndim == 2:
        texels = texels[:, :, None]
    if 0 in texels.shape:
        raise ImageError("it has no pixels")
    return np.ascontiguousarray(texels[::-1])

"""Pixels for people: 8-bit values, PNG files and tints."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

Array = NDArray[Any]
Bytes = NDArray[np.uint8]
TINT = (1.0, 0.1, 0.6)
"""Colour of traced pixels, RGB from 0 to 1."""
TINT_STRENGTH = 0.6
"""Share of the tint in a pixel of weight 1."""


def quantize(values: Array, nan: float = 0.0) -> Bytes:
    """Round floats from 0 to 1 to 8 bits. Clamp others; ``nan``: value in place of NaN."""
    finite = np.nan_to_num(values, nan=nan, posinf=1.0, neginf=0.0)
    return np.asarray(np.rint(np.clip(finite, 0, 1) * 255), np.uint8)


def to_bytes8(image: Array) -> Bytes:
    """Convert an image to 8 bits: keep 8-bit values, scale integers, clamp floats to 0..1."""
    if image.dtype == np.uint8:
        return image
    values = image.astype(np.float64)
    if image.dtype.kind in "iu":
        values /= float(np.iinfo(image.dtype).max)
    return quantize(values)


def encode_png(image: Array, compression: int = 6) -> bytes:
    """Encode an image (height, width[, channels]), row 0 at the top, as PNG.

    One channel is grey, two are red and green, alpha is dropped. ``compression``: zlib level.
    """
    pixels = to_bytes8(image)
    channels = pixels.shape[2] if pixels.ndim == 3 else 1
    if channels == 2:
        pixels = np.concatenate([pixels, np.zeros_like(pixels[:, :, :1])], axis=2)
    pixels = pixels[:, :, 0] if channels == 1 and pixels.ndim == 3 else pixels[..., :3]
    stream = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(pixels)).save(stream, "PNG", compress_level=compression)
    return stream.getvalue()


def tint(image: Array, weight: NDArray[np.float64]) -> Array:
    """Tint the pixels of an image (h, w, 3 or 4) by their weight from 0 to 1; same dtype.

    Weights of another size are taken from the nearest texel.
    """
    rows = (np.arange(image.shape[0]) * weight.shape[0]) // image.shape[0]
    columns = (np.arange(image.shape[1]) * weight.shape[1]) // image.shape[1]
    share = (weight[rows][:, columns] * TINT_STRENGTH)[..., None]
    scale = 255.0 if image.dtype == np.uint8 else 1.0
    colour = image[..., :3] * (1 - share) + np.array(TINT) * scale * share
    result = image.copy()
    result[..., :3] = np.rint(colour) if image.dtype == np.uint8 else colour
    return result

"""Targets as pictures: channels, exposure, and what is not finite painted."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

Array = NDArray[Any]
Bytes = NDArray[np.uint8]
NAN_COLOUR, INFINITY_COLOUR = (255, 0, 255), (0, 255, 255)
MASK_TINT = np.array([255.0, 64.0, 0.0])
CHANNELS = ("rgb", "r", "g", "b", "a")
_FAST = 1
"""zlib level: a picture a frame, on one machine."""


def encoded(pixels: Bytes) -> bytes:
    """A PNG of RGB pixels, (height, width, 3), row 0 at the top."""
    stream = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(pixels)).save(stream, "PNG", compress_level=_FAST)
    return stream.getvalue()


def unit(values: Array) -> NDArray[np.float32]:
    """Values as floats; normalised integers as parts of their greatest."""
    if values.dtype.kind in "iu":
        return values.astype(np.float32) / float(np.iinfo(values.dtype).max)
    return values.astype(np.float32)


def depth_range(values: Array) -> tuple[float, float]:
    """The least and the greatest finite value below the far plane."""
    known = values[np.isfinite(values) & (values < 1)]
    if known.size == 0:
        return 0.0, 1.0
    low, high = float(known.min()), float(known.max())
    return (low, high) if high > low else (low, low + 1e-6)


def shown(values: Array, channel: str = "rgb", exposure: float = 0.0, depth: bool = False) -> Bytes:
    """A target (height, width, channels) as RGB. ``exposure``: stops, values times 2**exposure.
    ``depth``: stretched over what the target holds, near is bright. NaN is magenta, infinity
    cyan."""
    count = values.shape[2]
    if channel in CHANNELS[1:] and CHANNELS.index(channel) <= count:
        picked = np.repeat(values[:, :, CHANNELS.index(channel) - 1, None], 3, axis=2)
    elif count < 3:
        first = values[:, :, :1]
        picked = np.repeat(first, 3, axis=2) if count == 1 else np.dstack([values, first * 0])
    else:
        picked = values[:, :, :3]
    plain = unit(picked)
    bad = ~np.isfinite(plain).all(axis=2)
    if depth:
        low, high = depth_range(plain)
        plain = 1.0 - (plain - low) / (high - low)
    with np.errstate(over="ignore", invalid="ignore"):
        scaled = np.clip(np.nan_to_num(plain * 2.0**exposure, posinf=1.0, neginf=0.0), 0, 1)
    pixels = np.asarray(np.rint(scaled * 255), np.uint8)
    if bad.any():
        nan = np.isnan(plain).any(axis=2)
        pixels[bad & ~nan], pixels[nan] = INFINITY_COLOUR, NAN_COLOUR
    return pixels


def tinted(pixels: Bytes, mask: NDArray[np.bool_]) -> Bytes:
    """The pixels with those of the mask tinted, where the sizes are the same."""
    if mask.shape != pixels.shape[:2]:
        return pixels
    found = pixels.astype(np.float32)
    found[mask] = found[mask] * 0.5 + MASK_TINT.astype(np.float32) * 0.5
    return np.asarray(np.rint(found), np.uint8)


def thumbnail(pixels: Bytes, width: int = 160) -> bytes:
    """A small PNG."""
    height = max(round(pixels.shape[0] * width / pixels.shape[1]), 1)
    small = Image.fromarray(np.ascontiguousarray(pixels)).resize((width, height))
    return encoded(np.asarray(small))


def difference(one: Array, other: Array) -> Bytes:
    """Ten times the absolute difference of two pictures in [0, 1], RGB."""
    return np.asarray(np.rint(np.clip(np.abs(one - other) * 10, 0, 1) * 255), np.uint8)

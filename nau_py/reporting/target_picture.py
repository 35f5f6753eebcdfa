"""Render targets as pictures: channels, exposure, colours for NaN and infinity."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from nau_py.reporting.pixels import Array, Bytes, encode_png, quantize

NAN_COLOUR, INFINITY_COLOUR = (255, 0, 255), (0, 255, 255)
CHANNELS = ("rgb", "r", "g", "b", "a")
FAST = 1
"""zlib level of pictures that stay on this machine."""


def normalize_values(values: Array) -> NDArray[np.float32]:
    """Convert values to float32; scale integers to 0..1."""
    if values.dtype.kind in "iu":
        return values.astype(np.float32) / float(np.iinfo(values.dtype).max)
    return values.astype(np.float32)


def find_depth_range(values: Array) -> tuple[float, float]:
    """Return the least and the greatest finite value below the far plane."""
    known = values[np.isfinite(values) & (values < 1)]
    if known.size == 0:
        return 0.0, 1.0
    low, high = float(known.min()), float(known.max())
    return (low, high) if high > low else (low, low + 1e-6)


def display_target(
    values: Array, channel: str = "rgb", exposure: float = 0.0, depth: bool = False
) -> Bytes:
    """Convert a target (height, width, channels) to RGB.

    ``channel``: one of :data:`CHANNELS`; ``exposure``: stops, values times 2**exposure; ``depth``:
    stretch over the range of the target, near is bright. NaN is magenta, infinity cyan.
    """
    count = values.shape[2]
    if channel in CHANNELS[1:] and CHANNELS.index(channel) <= count:
        picked = np.repeat(values[:, :, CHANNELS.index(channel) - 1, None], 3, axis=2)
    elif count < 3:
        first = values[:, :, :1]
        picked = np.repeat(first, 3, axis=2) if count == 1 else np.dstack([values, first * 0])
    else:
        picked = values[:, :, :3]
    plain = normalize_values(picked)
    bad = ~np.isfinite(plain).all(axis=2)
    if depth:
        low, high = find_depth_range(plain)
        plain = 1.0 - (plain - low) / (high - low)
    with np.errstate(over="ignore", invalid="ignore"):
        pixels = quantize(plain * 2.0**exposure)
    if bad.any():
        nan = np.isnan(plain).any(axis=2)
        pixels[bad & ~nan], pixels[nan] = INFINITY_COLOUR, NAN_COLOUR
    return pixels


def encode_thumbnail(pixels: Bytes, width: int = 160) -> bytes:
    """Encode a small PNG, ``width`` pixels wide."""
    height = max(round(pixels.shape[0] * width / pixels.shape[1]), 1)
    small = Image.fromarray(np.ascontiguousarray(pixels)).resize((width, height))
    return encode_png(np.asarray(small), FAST)


def display_difference(one: Array, other: Array) -> Bytes:
    """Return ten times the absolute difference of two pictures in [0, 1], RGB."""
    return quantize(np.abs(one - other) * 10)

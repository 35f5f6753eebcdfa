"""How far a picture is from a reference.

Pictures are float64 arrays (height, width, 3) of display values, 0 to 1 where the window shows
them. ``where`` (height, width) bool chooses pixels. What is not finite is left out of every
measure: count it first.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf, log10

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]

RELMSE_EPSILON = 0.01
"""Keeps dark pixels of a relMSE from counting without bound."""
SSIM_SIGMA, SSIM_RADIUS = 1.5, 5
SSIM_K1, SSIM_K2 = 0.01, 0.03


@dataclass(frozen=True, slots=True)
class Errors:
    """Measures over one set of pixels. ``psnr`` in dB for a peak of 1; ``flip`` is None without
    the package of that name."""

    mse: float
    rmse: float
    relmse: float
    psnr: float
    ssim: float
    flip: float | None = None


def finite(image: F64, reference: F64) -> Mask:
    """Pixels that are finite in both pictures."""
    return np.asarray(np.isfinite(image).all(axis=2) & np.isfinite(reference).all(axis=2))


def mse(image: F64, reference: F64, where: Mask) -> float:
    """Mean of the squared difference over the chosen pixels and their channels; nan for none."""
    if not where.any():
        return float("nan")
    return float(np.mean((image[where] - reference[where]) ** 2))


def relmse(image: F64, reference: F64, where: Mask) -> float:
    """Mean of (x - r)² / (r + 0.01)², the relative squared error of the rendering literature
    (Rousselle et al. 2011, equation 7, with the reference's value in the denominator)."""
    if not where.any():
        return float("nan")
    x, r = image[where], reference[where]
    return float(np.mean(((x - r) / (r + RELMSE_EPSILON)) ** 2))


def psnr(mse_: float) -> float:
    """Peak signal-to-noise ratio in dB, for a peak of 1."""
    return inf if mse_ == 0 else -10 * log10(mse_) if mse_ > 0 else float("nan")


def _blurred(values: F64) -> F64:
    """Gaussian window of 11 x 11, sigma 1.5; edges are extended."""
    x = np.arange(-SSIM_RADIUS, SSIM_RADIUS + 1)
    weights = np.exp(-(x**2) / (2 * SSIM_SIGMA**2))
    weights /= weights.sum()
    for axis in (0, 1):
        pad = [(0, 0)] * values.ndim
        pad[axis] = (SSIM_RADIUS, SSIM_RADIUS)
        wide = np.pad(values, pad, mode="symmetric")
        size = values.shape[axis]
        values = np.zeros_like(values)
        for k, weight in enumerate(weights):
            part = wide[k : k + size] if axis == 0 else wide[:, k : k + size]
            values += weight * part
    return values


def ssim_map(image: F64, reference: F64) -> F64:
    """Structural similarity of each value, (h, w, 3), for values of range 1 (Wang et al. 2004:
    11 x 11 Gaussian window of sigma 1.5, K1 = 0.01, K2 = 0.03)."""
    good = finite(image, reference)[..., None]
    x, y = np.where(good, image, 0.0), np.where(good, reference, 0.0)
    mean_x, mean_y = _blurred(x), _blurred(y)
    squares = _blurred(x * x + y * y) - mean_x**2 - mean_y**2
    both = _blurred(x * y) - mean_x * mean_y
    c1, c2 = SSIM_K1**2, SSIM_K2**2
    return ((2 * mean_x * mean_y + c1) * (2 * both + c2)) / (
        (mean_x**2 + mean_y**2 + c1) * (squares + c2)
    )


def flip_map(image: F64, reference: F64) -> F64 | None:
    """FLIP (Andersson et al. 2020) of each pixel, (h, w), pictures taken as sRGB; None where the
    package ``flip-evaluator`` (extra ``metrics``) is not installed."""
    try:
        import flip_evaluator
    except ImportError:
        return None
    good = finite(image, reference)[..., None]
    x, y = (np.where(good, np.clip(v, 0, 1), 0.0).astype(np.float32) for v in (image, reference))
    found, _, _ = flip_evaluator.evaluate(y, x, "LDR", inputsRGB=True, applyMagma=False)
    return np.asarray(found, np.float64).reshape(image.shape[:2])


def measure(image: F64, reference: F64, regions: Mapping[str, Mask]) -> dict[str, Errors]:
    """All measures over each region, of its pixels that are finite in both pictures."""
    good = finite(image, reference)
    similar, seen = ssim_map(image, reference), flip_map(image, reference)
    found = {}
    for name, region in regions.items():
        where = region & good
        error = mse(image, reference, where)
        some = bool(where.any())
        found[name] = Errors(
            error,
            float(np.sqrt(error)),
            relmse(image, reference, where),
            psnr(error),
            float(similar[where].mean()) if some else float("nan"),
            None if seen is None else float(seen[where].mean()) if some else float("nan"),
        )
    return found

"""Measures of the error of a picture against a reference.

Pictures are float64 arrays (height, width, 3) of display values, 0 to 1 for a window. ``where``
(height, width) bool selects pixels. Pixels that are not finite are left out of every measure: count
them first.
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
"""Bounds the weight of dark pixels in relMSE."""
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


def find_finite(image: F64, reference: F64) -> Mask:
    """Select the pixels that are finite in both pictures."""
    return np.asarray(np.isfinite(image).all(axis=2) & np.isfinite(reference).all(axis=2))


def compute_mse(image: F64, reference: F64, where: Mask) -> float:
    """Return the mean squared difference over the selected pixels and channels; nan for none."""
    if not where.any():
        return float("nan")
    return float(np.mean((image[where] - reference[where]) ** 2))


def compute_relmse(image: F64, reference: F64, where: Mask) -> float:
    """Return the mean of (x - r)² / (r + 0.01)²; nan for no pixels.

    It is the relative squared error of Rousselle et al. 2011, equation 7, with the reference's
    value in the denominator.
    """
    if not where.any():
        return float("nan")
    x, r = image[where], reference[where]
    return float(np.mean(((x - r) / (r + RELMSE_EPSILON)) ** 2))


def compute_psnr(mse_: float) -> float:
    """Return the peak signal-to-noise ratio in dB, for a peak of 1."""
    return inf if mse_ == 0 else -10 * log10(mse_) if mse_ > 0 else float("nan")


def _blur(values: F64) -> F64:
    """Blur with a Gaussian window of 11 x 11, sigma 1.5; edges are extended."""
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


def compute_ssim(image: F64, reference: F64) -> F64:
    """Return the structural similarity of each value, (h, w, 3), for values of range 1.

    Wang et al. 2004: 11 x 11 Gaussian window of sigma 1.5, K1 = 0.01, K2 = 0.03.
    """
    good = find_finite(image, reference)[..., None]
    x, y = np.where(good, image, 0.0), np.where(good, reference, 0.0)
    mean_x, mean_y = _blur(x), _blur(y)
    squares = _blur(x * x + y * y) - mean_x**2 - mean_y**2
    both = _blur(x * y) - mean_x * mean_y
    c1, c2 = SSIM_K1**2, SSIM_K2**2
    return ((2 * mean_x * mean_y + c1) * (2 * both + c2)) / (
        (mean_x**2 + mean_y**2 + c1) * (squares + c2)
    )


def compute_flip(image: F64, reference: F64) -> F64 | None:
    """Return FLIP (Andersson et al. 2020) of each pixel, (h, w), of sRGB pictures; None without the
    package ``flip-evaluator`` (extra ``metrics``)."""
    try:
        import flip_evaluator
    except ImportError:
        return None
    good = find_finite(image, reference)[..., None]
    x, y = (np.where(good, np.clip(v, 0, 1), 0.0).astype(np.float32) for v in (image, reference))
    found, _, _ = flip_evaluator.evaluate(y, x, "LDR", inputsRGB=True, applyMagma=False)
    return np.asarray(found, np.float64).reshape(image.shape[:2])


def measure_errors(image: F64, reference: F64, regions: Mapping[str, Mask]) -> dict[str, Errors]:
    """Compute all measures over each region, for pixels that are finite in both pictures."""
    good = find_finite(image, reference)
    similar, seen = compute_ssim(image, reference), compute_flip(image, reference)
    found = {}
    for name, region in regions.items():
        where = region & good
        error = compute_mse(image, reference, where)
        some = bool(where.any())
        found[name] = Errors(
            error,
            float(np.sqrt(error)),
            compute_relmse(image, reference, where),
            compute_psnr(error),
            float(similar[where].mean()) if some else float("nan"),
            None if seen is None else float(seen[where].mean()) if some else float("nan"),
        )
    return found

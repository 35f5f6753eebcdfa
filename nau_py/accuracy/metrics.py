"""How far a picture is from a reference.

Pictures are float64 arrays (height, width, 3) of display values, 0 to 1 where the window shows
them. ``where`` (height, width) bool chooses pixels. What is not finite is left out of every
measure: count it first.
"""

from __future__ import annotations

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
        values = sum(
            w * np.take(wide, np.arange(k, k + size), axis=axis) for k, w in enumerate(weights)
        )
    return values


def ssim(image: F64, reference: F64, where: Mask) -> float:
    """Mean structural similarity of the chosen pixels and channels, for values of range 1
    (Wang et al. 2004: 11 x 11 Gaussian window of sigma 1.5, K1 = 0.01, K2 = 0.03)."""
    if not where.any():
        return float("nan")
    good = finite(image, reference)[..., None]
    x, y = np.where(good, image, 0.0), np.where(good, reference, 0.0)
    mean_x, mean_y = _blurred(x), _blurred(y)
    var_x = _blurred(x * x) - mean_x**2
    var_y = _blurred(y * y) - mean_y**2
    both = _blurred(x * y) - mean_x * mean_y
    c1, c2 = SSIM_K1**2, SSIM_K2**2
    found = ((2 * mean_x * mean_y + c1) * (2 * both + c2)) / (
        (mean_x**2 + mean_y**2 + c1) * (var_x + var_y + c2)
    )
    return float(found[where].mean())


def flip(image: F64, reference: F64, where: Mask) -> float | None:
    """Mean FLIP (Andersson et al. 2020) of the chosen pixels, pictures taken as sRGB; None where
    the package ``flip-evaluator`` (extra ``metrics``) is not installed."""
    try:
        import flip_evaluator
    except ImportError:
        return None
    if not where.any():
        return float("nan")
    good = finite(image, reference)[..., None]
    x, y = (np.where(good, np.clip(v, 0, 1), 0.0).astype(np.float32) for v in (image, reference))
    found, _, _ = flip_evaluator.evaluate(y, x, "LDR", inputsRGB=True, applyMagma=False)
    return float(np.asarray(found).reshape(where.shape)[where].mean())


def measure(image: F64, reference: F64, where: Mask) -> Errors:
    """All measures over the pixels of ``where`` that are finite in both pictures."""
    chosen = where & finite(image, reference)
    found = mse(image, reference, chosen)
    return Errors(
        found,
        float(np.sqrt(found)),
        relmse(image, reference, chosen),
        psnr(found),
        ssim(image, reference, chosen),
        flip(image, reference, chosen),
    )

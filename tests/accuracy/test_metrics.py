"""Metrics against analytic values and other implementations."""

from __future__ import annotations

from math import inf, log10

import numpy as np
import pytest

from nau_py.accuracy import metrics
from nau_py.accuracy.metrics import Errors


def wave(height: int = 48, width: int = 64) -> np.ndarray:
    """A smooth picture, (h, w, 3), values in 0.1 to 0.9."""
    y, x = np.mgrid[:height, :width]
    planes = [0.5 + 0.4 * np.sin(x / (5 + k)) * np.cos(y / (7 - k)) for k in range(3)]
    return np.stack(planes, axis=-1)


def errors(image: np.ndarray, reference: np.ndarray, where: np.ndarray) -> Errors:
    return metrics.measure_errors(image, reference, {"there": where})["there"]


EVERYWHERE = np.ones((48, 64), bool)


def test_a_constant_difference() -> None:
    """Off by 0.1 everywhere: MSE 0.01, PSNR 20 dB, relMSE by its formula."""
    reference = np.full((48, 64, 3), 0.4)
    found = errors(reference + 0.1, reference, EVERYWHERE)
    assert found.mse == pytest.approx(0.01)
    assert found.rmse == pytest.approx(0.1)
    assert found.psnr == pytest.approx(20.0)
    assert found.relmse == pytest.approx((0.1 / 0.41) ** 2)
    # Wang et al. 2004 for constant pictures: only the luminance term is left
    c1 = 0.01**2
    assert found.ssim == pytest.approx((2 * 0.5 * 0.4 + c1) / (0.25 + 0.16 + c1), rel=1e-9)


def test_equal_pictures() -> None:
    image = wave()
    found = errors(image, image, EVERYWHERE)
    assert (found.mse, found.relmse, found.psnr) == (0.0, 0.0, inf)
    assert found.ssim == pytest.approx(1.0)


def test_ssim_is_that_of_scikit_image() -> None:
    """Expected from scikit-image 0.26: structural_similarity(x, y, channel_axis=2, data_range=1,
    gaussian_weights=True, sigma=1.5, use_sample_covariance=False), full map, without the border of
    5 pixels that it leaves out of its mean."""
    reference = wave()
    x = np.linspace(0, 1, 64)[None, :, None]
    image = np.clip(reference + 0.2 * x * np.sin(np.arange(48) * 2.1)[:, None, None], 0, 1)
    inner = np.zeros((48, 64), bool)
    inner[5:-5, 5:-5] = True
    assert errors(image, reference, inner).ssim == pytest.approx(SKIMAGE_SSIM, abs=1e-6)


SKIMAGE_SSIM = 0.664531560


def test_only_chosen_and_finite_pixels_count() -> None:
    reference, image = np.zeros((4, 4, 3)), np.zeros((4, 4, 3))
    image[0, 0] = 0.5
    image[1, 1] = np.nan
    image[2, 2] = np.inf
    first_row = np.zeros((4, 4), bool)
    first_row[0] = True
    assert errors(image, reference, np.ones((4, 4), bool)).mse == pytest.approx(0.25 / 14)
    assert errors(image, reference, first_row).mse == pytest.approx(0.25 / 4)
    assert np.isnan(errors(image, reference, np.zeros((4, 4), bool)).mse)


def test_relmse_bounds_dark_pixels() -> None:
    """Black in the reference divides by 0.01, not by nothing."""
    reference, image = np.zeros((2, 2, 3)), np.full((2, 2, 3), 0.01)
    assert metrics.compute_relmse(image, reference, np.ones((2, 2), bool)) == pytest.approx(1.0)


def test_flip_orders_pictures() -> None:
    """With the package: 0 for equal pictures, more for a larger difference. Without: None."""
    pytest.importorskip("flip_evaluator")
    reference = wave()
    equal = errors(reference, reference, EVERYWHERE).flip
    some = errors(np.clip(reference + 0.02, 0, 1), reference, EVERYWHERE).flip
    more = errors(np.clip(reference + 0.2, 0, 1), reference, EVERYWHERE).flip
    assert equal is not None
    assert some is not None
    assert more is not None
    assert equal == pytest.approx(0.0, abs=1e-6)
    assert 0 < some < more


def test_psnr_of_a_known_error() -> None:
    assert metrics.compute_psnr(0.001) == pytest.approx(-10 * log10(0.001))

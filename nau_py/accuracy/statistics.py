"""Statistics of repeated runs: means with intervals, bias and variance, rates of convergence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import log, sqrt

import numpy as np

from nau_py.accuracy.metrics import F64, Mask

_T95 = (
    12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228,
    2.201, 2.179, 2.160, 2.145, 2.131, 2.120, 2.110, 2.101, 2.093, 2.086,
    2.080, 2.074, 2.069, 2.064, 2.060, 2.056, 2.052, 2.048, 2.045, 2.042,
)  # fmt: skip
"""Two-sided 95 % quantiles of Student's t for 1 to 30 degrees of freedom."""


def find_t95(degrees: int) -> float:
    """Return the two-sided 95 % quantile of Student's t; beyond 30 degrees a little too wide."""
    if degrees < 1:
        return float("inf")
    return _T95[degrees - 1] if degrees <= len(_T95) else _T95[-1]


@dataclass(frozen=True, slots=True)
class Interval:
    """A mean and its 95 % confidence interval."""

    mean: float
    low: float
    high: float


def compute_interval(values: Sequence[float]) -> Interval:
    """Compute the mean of ``values`` with Student's 95 % interval; a single value has none."""
    data = np.asarray(values, np.float64)
    mean = float(data.mean())
    if len(data) < 2 or not np.isfinite(mean):
        return Interval(mean, mean, mean)
    half = find_t95(len(data) - 1) * float(data.std(ddof=1)) / sqrt(len(data))
    return Interval(mean, mean - half, mean + half)


@dataclass(frozen=True, slots=True)
class Spread:
    """Median, least and greatest of several times, milliseconds."""

    median: float
    low: float
    high: float


def compute_spread(values: Sequence[float]) -> Spread:
    data = np.asarray(values, np.float64)
    return Spread(float(np.median(data)), float(data.min()), float(data.max()))


class Moments:
    """Running mean and squared deviations of pictures (Welford 1962)."""

    def __init__(self, shape: tuple[int, ...]) -> None:
        self.number = 0
        self.mean: F64 = np.zeros(shape)
        self._squares: F64 = np.zeros(shape)

    def add(self, image: F64) -> None:
        self.number += 1
        change = image - self.mean
        self.mean += change / self.number
        self._squares += change * (image - self.mean)

    @property
    def variance(self) -> F64:
        """Sample variance of each value; nan for fewer than two pictures."""
        if self.number < 2:
            return np.full_like(self.mean, np.nan)
        return self._squares / (self.number - 1)


def split_error(
    runs: Moments, reference: F64, reference_variance: F64, where: Mask
) -> tuple[float, float]:
    """Split the mean squared error of one run into (bias², variance) over the selected pixels.

    The mean of n runs is off by bias, by variance / n, and by the error of the reference: both are
    subtracted, so that noise does not count as bias. Negative values clamp to 0. Pixels that were
    not finite in some run are left out.
    """
    where = where & np.isfinite(runs.mean).all(axis=-1) & np.isfinite(reference).all(axis=-1)
    if not where.any():
        return float("nan"), float("nan")
    variance = runs.variance[where]
    if runs.number < 2:
        return float("nan"), float("nan")
    squared = (runs.mean[where] - reference[where]) ** 2
    bias = squared - variance / runs.number - reference_variance[where]
    return max(float(bias.mean()), 0.0), float(variance.mean())


def fit_exponent(costs: Sequence[float], errors: Sequence[float]) -> float | None:
    """Fit p of error ~ cost^p by least squares in logarithms; None for fewer than two costs."""
    pairs = [(log(c), log(e)) for c, e in zip(costs, errors) if c > 0 and e > 0]
    if len({x for x, _ in pairs}) < 2:
        return None
    x, y = np.array(pairs).T
    return float(np.polyfit(x, y, 1)[0])

"""Estimates of pixels: means, variances and errors of their samples."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.tracing.counts import RayCounts
from nau_py.scene.mesh import F32, F64

I64 = NDArray[np.int64]
OUTLIER = 0.9
"""Share of a pixel's squared deviations from which one sample counts as an outlier."""
MANY = 64
"""Samples from which outliers are reported: with fewer, a sample at an edge outweighs the rest."""


@dataclass(slots=True)
class PixelEstimates:
    """Running estimates of n pixels, which ``kernels/path/film.py`` updates.

    ``mean`` RGBA float64 (n, 4); ``squares`` float64 (n, 3), sums of squared deviations; ``number``
    int64 (n,) of finite samples, ``taken`` of all; ``largest`` float64 (n,), the most that one
    sample added to the squares; ``batched`` float64 (n, 2), the squared error of the sum by batch
    means, and the number of samples for which it holds.
    """

    mean: F64
    squares: F64
    number: I64
    taken: I64
    largest: F64
    batched: F64

    @classmethod
    def empty(cls, count: int, single: bool = False) -> PixelEstimates:
        """Return estimates of ``count`` pixels without samples. ``single``: they get one sample
        each, so that no variance is kept."""
        spread = 0 if single else count
        return cls(
            np.zeros((count, 4)),
            np.zeros((spread, 3)),
            np.zeros(count, np.int64),
            np.zeros(count, np.int64),
            np.zeros(spread),
            np.zeros((spread, 2)),
        )

    @property
    def unreliable(self) -> NDArray[np.bool_]:
        """Pixels whose variance rests on one sample, so that their error is uncertain, (n,)."""
        if len(self.squares) < len(self.number):
            return np.zeros(len(self.number), bool)
        total = self.squares.sum(axis=1)
        return np.asarray((self.number >= MANY) & (self.largest > OUTLIER * total) & (total > 0))

    @property
    def error(self) -> F64:
        """Estimated standard error of each pixel's colour, root mean square over RGB, float64 (n,).

        Infinite below two samples. It comes from the variance of the samples or, if every launch
        took 16 of them or more, from the variance of the means of batches (8 of 16 samples, 16 of
        32 and more) if that is smaller: a batch of a low-discrepancy sequence is stratified by
        itself, one of a grid that is filled row by row is not.
        """
        if len(self.squares) < len(self.number):
            return np.full(len(self.number), np.inf)
        n = self.number.astype(np.float64)
        with np.errstate(divide="ignore", invalid="ignore"):
            variance = (self.squares[:, 0] + self.squares[:, 1] + self.squares[:, 2]) / 3
            found = np.sqrt(variance / (n - 1) / n)
            means = np.sqrt(self.batched[:, 0]) / n
        known = (self.batched[:, 1] == n) & (n > 0)
        return np.where(known, np.minimum(means, found), np.where(n > 1, found, np.inf))


@dataclass(slots=True)
class LaunchResult:
    """Estimates of the selected pixels, and the cost of the launch."""

    estimates: PixelEstimates
    counts: RayCounts = field(default_factory=RayCounts)
    taken: int = 0
    """Samples that this launch took; earlier launches of an accumulating pass are not counted."""

    @property
    def colours(self) -> F32:
        """RGBA float32 (n, 4)."""
        return self.estimates.mean.astype(np.float32)

    @property
    def est_error(self) -> float | None:
        """Estimated root mean square error of the colours, from the sample variance; None with
        one sample a pixel."""
        error = self.estimates.error
        known = np.isfinite(error)
        if not known.any():
            return None
        return float(np.sqrt(np.sum(error[known] ** 2) / known.sum()))

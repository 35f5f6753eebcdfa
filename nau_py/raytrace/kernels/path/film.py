"""The film: running estimates of the pixels, updated with the samples of a tile."""

from __future__ import annotations

from math import isfinite
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.kernels.core.jit import inner, kernel

BATCHES, LEAST = 16, 16
"""Batches whose means give a pixel's error: at most BATCHES, of two samples or more, and only from
LEAST samples on."""


@inner
def _add_batch_error(
    sums: NDArray[np.float64], sizes: NDArray[np.float64], batched: NDArray[np.float64], i: int
) -> None:
    """Add the squared error of the sum of a pixel's batches, mean over RGB, to row ``i``."""
    used, total = 0, 0.0
    for b in range(BATCHES):
        if sizes[b] > 0.0:
            used += 1
            total += sizes[b]
    if used < 2:
        return
    squared = 0.0
    for k in range(3):
        mean = 0.0
        for b in range(BATCHES):
            if sizes[b] > 0.0:
                mean += sums[b, k] / sizes[b] / used
        for b in range(BATCHES):
            if sizes[b] > 0.0:
                off = sums[b, k] / sizes[b] - mean
                squared += off * off
    batched[i, 0] += squared / 3.0 / (used - 1) / used * total * total
    batched[i, 1] += total


@kernel
def update_film(
    radiance: NDArray[np.float32],
    items: Any,
    mean: NDArray[np.float64],
    squares: NDArray[np.float64],
    number: NDArray[np.int64],
    largest: NDArray[np.float64],
    batched: NDArray[np.float64],
    bad: NDArray[np.int64],
) -> None:
    """Add the samples of each pixel of ``items`` to its running estimate.

    ``radiance`` float32 (samples, 4) holds the samples of the pixels one after the other. Mean and
    ``squares``, the sum of squared deviations: Welford, *Note on a Method for Calculating Corrected
    Sums of Squares and Products*, 1962. ``largest``: the most that one sample added to the squares.
    ``batched`` (n, 2): the squared error of the sum, from the means of BATCHES runs of these
    samples, and the number of samples for which it holds (batch means, Schmeiser 1982). A run of a
    low-discrepancy sequence is stratified; the variance of single samples does not show that.
    Empty ``squares`` keep means only. Samples that are not finite are dropped: ``bad[0]`` counts
    them, ``bad[1]`` is the pixel of the first.
    """
    at = 0
    many = squares.shape[0] > 0
    sums = np.zeros((BATCHES, 3))
    sizes = np.zeros(BATCHES)
    for i in range(items.shape[0]):
        count = items[i].count
        batches = min(BATCHES, count // 2) if count >= LEAST else 0
        sums[:], sizes[:] = 0.0, 0.0
        for index in range(count):
            c = radiance[at]
            at += 1
            if not (isfinite(c[0]) and isfinite(c[1]) and isfinite(c[2]) and isfinite(c[3])):
                if bad[0] == 0:
                    bad[1] = items[i].pixel
                bad[0] += 1
                continue
            number[i] += 1
            square = 0.0
            for k in range(4):
                delta = float(c[k]) - mean[i, k]
                mean[i, k] += delta / number[i]
                if many and k < 3:
                    added = delta * (float(c[k]) - mean[i, k])
                    squares[i, k] += added
                    square += added
            if many:
                largest[i] = max(largest[i], square)
                if batches > 0:
                    batch = index * batches // count
                    sizes[batch] += 1.0
                    for k in range(3):
                        sums[batch, k] += float(c[k])
        if many and batches > 0:
            _add_batch_error(sums, sizes, batched, i)

"""Adaptive sampling: pixels get samples until their estimated error meets a target.

Errors are looked at when the number of samples has doubled, and by whole rounds, so that what is
done does not depend on threads or tiles. A pixel that looks converged goes on as long as one of its
eight neighbours has not: a variance of few samples can be small by chance.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.tracing.dispatch import I64, LaunchResult, Progress, Work, run_launch

FIRST_ROUND = 16
"""Samples before the first look."""


def spread(chosen: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """``chosen`` (h, w) and the eight neighbours of what is chosen."""
    wide = np.pad(chosen, 1)
    height, width = chosen.shape
    found = np.zeros_like(chosen)
    for dy in range(3):
        for dx in range(3):
            found |= wide[dy : dy + height, dx : dx + width]
    return found


def run_adaptive(
    work: Work, pixels: I64, shape: tuple[int, int], target: float, progress: Progress
) -> LaunchResult:
    """Sample ``pixels`` of an image of ``shape`` (height, width) until the estimated standard
    error of each, root mean square over RGB, is at most ``target``, or the settings' number of
    samples is taken."""
    most = work.settings.samples
    number = min(FIRST_ROUND, most)
    result = run_launch(work, pixels, progress, np.full(len(pixels), number))
    while number < most:
        grid = np.zeros(shape[0] * shape[1], bool)
        grid[pixels] = result.estimate.error > target
        active = spread(grid.reshape(shape)).reshape(-1)[pixels]
        if not active.any():
            break
        number = min(2 * number, most)
        counts = np.where(active, number - result.estimate.taken, 0)
        result = run_launch(work, pixels, progress, counts, result)
    return result

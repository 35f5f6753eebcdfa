"""Adaptive sampling: pixels get samples until their estimated error meets a target.

Errors are tested when the number of samples has doubled, and for whole rounds, so that the result
does not depend on threads or tiles. A pixel below the target continues while one of its eight
neighbours is above it: a variance of few samples can be small by chance.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.tracing.dispatch import Progress, run_launch
from nau_py.raytrace.tracing.estimate import I64, LaunchResult
from nau_py.raytrace.tracing.launch import RayLaunch

FIRST_ROUND = 16
"""Samples of a pixel before its error is tested the first time."""


def dilate(chosen: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return ``chosen`` (h, w) with the eight neighbours of each chosen pixel."""
    wide = np.pad(chosen, 1)
    height, width = chosen.shape
    found = np.zeros_like(chosen)
    for dy in range(3):
        for dx in range(3):
            found |= wide[dy : dy + height, dx : dx + width]
    return found


def run_adaptive(
    launch: RayLaunch, pixels: I64, shape: tuple[int, int], target: float, progress: Progress
) -> LaunchResult:
    """Sample ``pixels`` of an image of ``shape`` (height, width) until their error is at most
    ``target``, or the settings' number of samples is taken.

    The error is the estimated standard error of a pixel, root mean square over RGB. Raises
    :class:`~nau_py.ProgramError`.
    """
    most = launch.settings.samples
    number = min(FIRST_ROUND, most)
    result = run_launch(launch, pixels, progress, np.full(len(pixels), number))
    while number < most:
        grid = np.zeros(shape[0] * shape[1], bool)
        grid[pixels] = result.estimates.error > target
        active = dilate(grid.reshape(shape)).reshape(-1)[pixels]
        if not active.any():
            break
        number = min(2 * number, most)
        counts = np.where(active, number - result.estimates.taken, 0)
        result = run_launch(launch, pixels, progress, counts, result)
    return result

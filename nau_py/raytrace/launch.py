"""A launch: the selected pixels in tiles over threads, samples averaged, costs added up."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.camera import CameraRays
from nau_py.raytrace.hits import Launch
from nau_py.raytrace.programs import BoundProgram
from nau_py.raytrace.tracer import RayCounts, Scene, Tracer
from nau_py.raytrace.vectors import F32


@dataclass(slots=True)
class LaunchSettings:
    """``samples`` a pixel, ``threads`` (0: one a core), rays a ``tile``."""

    samples: int
    threads: int = 0
    tile: int = 16384


@dataclass(slots=True)
class LaunchResult:
    """Colours RGBA float32 (n, 4) of the n selected pixels, and the cost.

    ``est_error``: estimated root mean square error of the colours, from the sample variance;
    None with one sample a pixel.
    """

    colours: F32
    counts: RayCounts = field(default_factory=RayCounts)
    est_error: float | None = None


@dataclass(slots=True)
class _Tile:
    colours: F32
    counts: RayCounts
    variance: NDArray[np.float64]


def select(mask: NDArray[Any] | None, width: int, height: int) -> NDArray[np.int64]:
    """Flat indices (row · width + column, row 0 at the bottom) of the pixels to trace.

    ``mask`` (height, width): pixels with a weight above 0; None selects all.
    """
    if mask is None:
        return np.arange(width * height)
    return np.flatnonzero(mask.reshape(-1) > 0)


def _average(samples: F32, valid: NDArray[np.bool_]) -> tuple[F32, NDArray[np.float64]]:
    """Means of (n, s, 4) over s; variance of the colour mean of each, (n,), summed over RGB.

    Accumulates in float64 sample by sample, so that the result does not depend on n.
    """
    count = samples.shape[1]
    total = np.zeros((len(samples), 4))
    squares = np.zeros((len(samples), 3))
    for index in range(count):
        value = np.where(valid[:, index, None], samples[:, index], 0).astype(np.float64)
        total += value
        squares += value[:, :3] ** 2
    kept = np.maximum(valid.sum(axis=1), 1)[:, None]
    mean = total / kept
    spread = np.maximum(squares / kept - mean[:, :3] ** 2, 0)
    many = np.where(kept > 1, spread / np.maximum(kept - 1, 1), 0)
    return mean.astype(np.float32), many[:, 0] + many[:, 1] + many[:, 2]


@dataclass(frozen=True, slots=True)
class Work:
    """What every tile of a launch has in common."""

    scene: Scene
    generate: BoundProgram
    exception: BoundProgram | None
    width: int
    rays: CameraRays
    settings: LaunchSettings

    def tile(self, chosen: NDArray[np.int64]) -> _Tile:
        """Trace all samples of the pixels ``chosen``."""
        samples = self.settings.samples
        flat = np.repeat(chosen, samples)
        tracer = Tracer(self.scene)
        launch = Launch(
            tracer,
            (flat % self.width).astype(np.int32),
            (flat // self.width).astype(np.int32),
            flat.astype(np.uint32),
            np.tile(np.arange(samples, dtype=np.uint32), len(chosen)),
            samples,
            self.rays,
        )
        with np.errstate(all="ignore"):  # what is not finite is counted, not printed
            colours = self.generate.radiance(launch, len(flat))
            valid = np.asarray(np.isfinite(colours).all(axis=1))
            if not valid.all():
                tracer.counts.nonfinite += int((~valid).sum())
                if self.exception is not None:
                    colours[~valid] = self.exception.radiance(launch, len(flat))[~valid]
                    valid[:] = True
        shape = (len(chosen), samples)
        mean, variance = _average(colours.reshape(*shape, 4), valid.reshape(shape))
        return _Tile(mean, tracer.counts, variance)


def run_launch(
    work: Work, pixels: NDArray[np.int64], progress: Callable[[int, int], None]
) -> LaunchResult:
    """Run ray generation for every sample of ``pixels``, in tiles over threads.

    A sample that is not finite is replaced by what the exception program says, or dropped, and
    counted. The colours are the same to the bit for any tile size and number of threads.
    """
    settings = work.settings
    step = max(settings.tile // settings.samples, 1)
    starts = range(0, len(pixels), step)
    result = LaunchResult(np.zeros((len(pixels), 4), np.float32))
    variance = np.zeros(len(pixels))
    threads = settings.threads or os.cpu_count() or 1
    with ThreadPoolExecutor(max_workers=threads) as pool:
        tiles = pool.map(lambda start: work.tile(pixels[start : start + step]), starts)
        for start, tile in zip(starts, tiles):
            result.colours[start : start + step] = tile.colours
            result.counts.merge(tile.counts)
            variance[start : start + step] = tile.variance
            progress(min(start + step, len(pixels)), len(pixels))
    if settings.samples > 1 and len(pixels):
        result.est_error = float(np.sqrt(variance.sum() / (3 * len(pixels))))
    return result

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
    variance: float


def select(mask: NDArray[Any] | None, width: int, height: int) -> NDArray[np.int64]:
    """Flat indices (row · width + column, row 0 at the bottom) of the pixels to trace.

    ``mask`` (height, width): pixels with a weight above 0; None selects all.
    """
    if mask is None:
        return np.arange(width * height)
    return np.flatnonzero(mask.reshape(-1) > 0)


def _average(samples: F32, valid: NDArray[np.bool_]) -> tuple[F32, float]:
    """Means of (n, s, 4) over s, and the summed variance of the colour means.

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
    return mean.astype(np.float32), float(many.sum())


def run_launch(
    scene: Scene,
    generate: BoundProgram,
    exception: BoundProgram | None,
    pixels: NDArray[np.int64],
    width: int,
    rays: CameraRays,
    settings: LaunchSettings,
    progress: Callable[[int, int], None],
) -> LaunchResult:
    """Run ray generation for every sample of ``pixels``.

    A sample that is not finite is replaced by what the exception program says, or dropped, and
    counted. The result is the same to the bit for any tile size and number of threads.
    """
    samples = settings.samples
    step = max(settings.tile // samples, 1)
    starts = range(0, len(pixels), step)

    def work(start: int) -> _Tile:
        chosen = pixels[start : start + step]
        flat = np.repeat(chosen, samples)
        tracer = Tracer(scene)
        launch = Launch(
            tracer,
            (flat % width).astype(np.int32),
            (flat // width).astype(np.int32),
            flat.astype(np.uint32),
            np.tile(np.arange(samples, dtype=np.uint32), len(chosen)),
            samples,
            rays,
        )
        colours = generate.radiance(launch, len(flat))
        valid = np.asarray(np.isfinite(colours).all(axis=1))
        if not valid.all():
            tracer.counts.nonfinite += int((~valid).sum())
            if exception is not None:
                colours[~valid] = exception.radiance(launch, len(flat))[~valid]
                valid[:] = True
        shape = (len(chosen), samples)
        mean, variance = _average(colours.reshape(*shape, 4), valid.reshape(shape))
        return _Tile(mean, tracer.counts, variance)

    result = LaunchResult(np.zeros((len(pixels), 4), np.float32))
    variance, done = 0.0, 0
    threads = settings.threads or os.cpu_count() or 1
    with ThreadPoolExecutor(max_workers=threads) as pool:
        for start, tile in zip(starts, pool.map(work, starts)):
            result.colours[start : start + step] = tile.colours
            result.counts.merge(tile.counts)
            variance += tile.variance
            done = min(start + step, len(pixels))
            progress(done, len(pixels))
    if samples > 1 and len(pixels):
        result.est_error = float(np.sqrt(variance / (3 * len(pixels))))
    return result

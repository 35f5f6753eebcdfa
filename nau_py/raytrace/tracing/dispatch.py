"""A launch: the selected pixels in tiles over threads, samples averaged, costs added up."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.kernels.core import tables as t
from nau_py.raytrace.kernels.core.tables import LANES
from nau_py.raytrace.kernels.path import camera as kernel
from nau_py.raytrace.kernels.path.film import update_film
from nau_py.raytrace.programs.batch import THIN_LENS
from nau_py.raytrace.tracing.arrays import F32
from nau_py.raytrace.tracing.batches import Launch
from nau_py.raytrace.tracing.camera_rays import CameraRays
from nau_py.raytrace.tracing.main_thread import MainThread
from nau_py.raytrace.tracing.program_loader import BoundProgram
from nau_py.raytrace.tracing.scene_tables import Scene
from nau_py.raytrace.tracing.thread_tracer import RayCounts, Tracer, Tracers
from nau_py.scene.mesh import F64

I64 = NDArray[np.int64]
COMPILED_TILE, PYTHON_TILE = 16384, 65536
"""Rays a tile: Python programs cost time per call, so their batches are larger."""
OUTLIER = 0.9
"""Share of a pixel's squared deviations from which one sample counts as an outlier."""
MANY = 64
"""Samples from which that says something: of few, one that meets an edge outweighs the rest."""


@dataclass(frozen=True, slots=True)
class LaunchSettings:
    """``samples`` a pixel, ``threads`` (0: one a core), rays a ``tile`` (0: what suits the
    programs), where samples lie.

    ``progressive``: more samples may follow, so even a single one is jittered.
    """

    samples: int
    threads: int = 0
    tile: int = 0
    sampler: str = "SOBOL"
    progressive: bool = False


@dataclass(slots=True)
class Estimate:
    """Running means of n pixels: ``mean`` RGBA float64 (n, 4), ``squares`` float64 (n, 3) sums of
    squared deviations, ``number`` int64 (n,) of finite samples, ``taken`` of all, ``largest``
    float64 (n,) what one sample added most to the squares; ``batched`` float64 (n, 2) squared error
    of the sum as batch means tell it, and the samples that it holds for."""

    mean: F64
    squares: F64
    number: I64
    taken: I64
    largest: F64
    batched: F64

    @classmethod
    def empty(cls, count: int, single: bool = False) -> Estimate:
        """Of ``count`` pixels without a sample; ``single``: they get one, and no variance."""
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
        """Pixels whose variance rests on one sample: their error estimate says little, (n,)."""
        if len(self.squares) < len(self.number):
            return np.zeros(len(self.number), bool)
        total = self.squares.sum(axis=1)
        return np.asarray((self.number >= MANY) & (self.largest > OUTLIER * total) & (total > 0))

    @property
    def error(self) -> F64:
        """Estimated standard error of each pixel's colour, root mean square over RGB, float64
        (n,); infinite below two samples. From the variance of the samples or, where every
        launch took 16 of them or more, from that of the means of batches (8 of 16 samples, 16 of
        32 and more) if that is less: a batch of a low-discrepancy sequence is stratified by itself,
        one of a grid that is filled row by row is a clump."""
        if len(self.squares) < len(self.number):
            return np.full(len(self.number), np.inf)
        n = self.number.astype(np.float64)
        with np.errstate(divide="ignore", invalid="ignore"):
            variance = (self.squares[:, 0] + self.squares[:, 1] + self.squares[:, 2]) / 3
            found = np.sqrt(variance / (n - 1) / n)
            means = np.sqrt(self.batched[:, 0]) / n
        told = (self.batched[:, 1] == n) & (n > 0)
        return np.where(told, np.minimum(means, found), np.where(n > 1, found, np.inf))


@dataclass(slots=True)
class LaunchResult:
    """The estimates of the selected pixels, and the cost."""

    estimate: Estimate
    counts: RayCounts = field(default_factory=RayCounts)
    taken: int = 0
    """Samples that this result cost."""

    @property
    def colours(self) -> F32:
        """RGBA float32 (n, 4)."""
        return self.estimate.mean.astype(np.float32)

    @property
    def est_error(self) -> float | None:
        """Estimated root mean square error of the colours, from the sample variance; None with
        one sample a pixel."""
        error = self.estimate.error
        known = np.isfinite(error)
        if not known.any():
            return None
        return float(np.sqrt(np.sum(error[known] ** 2) / known.sum()))


def select(mask: NDArray[Any] | None, width: int, height: int) -> I64:
    """Flat indices (row · width + column, row 0 at the bottom) of the pixels to trace.

    ``mask`` (height, width): pixels with a weight above 0; None selects all.
    """
    if mask is None:
        return np.arange(width * height)
    return np.flatnonzero(mask.reshape(-1) > 0)


@dataclass(frozen=True, slots=True)
class Work:
    """What every tile of a launch has in common."""

    scene: Scene
    generate: BoundProgram
    exception: BoundProgram | None
    width: int
    camera: NDArray[Any]
    rays: CameraRays
    settings: LaunchSettings
    label: str = "the pass"
    tracers: Tracers = field(default_factory=Tracers)
    service: MainThread | None = None
    """Serves what tiles ask of the main thread while they run."""

    def tile(self, items: NDArray[Any], estimate: Estimate, part: slice, shift: int) -> RayCounts:
        """Trace the samples ``items``, those of the same pixel >> ``shift`` together, and add them
        to ``part`` of ``estimate``."""
        tracer = self.tracers.mine(self.scene)
        tracer.shift = shift
        total = int(items["count"].sum())
        radiance = tracer.results(total)
        with np.errstate(all="ignore"):  # what is not finite is counted, not printed
            launch = None
            if self.generate.code == t.USER:
                launch = self._launch(tracer, items)
                radiance = self.generate.radiance(launch, total)
            else:
                self._compiled(tracer, items, radiance)
            if self.exception is not None and not np.isfinite(radiance).all():
                bad = ~np.isfinite(radiance).all(axis=1)
                launch = launch or self._launch(tracer, items)
                first = int(launch.pixel[np.argmax(bad)])
                tracer.dropped(self.label, int(bad.sum()), first)
                radiance[bad] = self.exception.radiance(launch, total)[bad]
        bad_samples = np.zeros(2, np.int64)
        update_film(
            radiance,
            items,
            estimate.mean[part],
            estimate.squares[part],
            estimate.number[part],
            estimate.largest[part],
            estimate.batched[part],
            bad_samples,
        )
        tracer.dropped(self.label, int(bad_samples[0]), int(bad_samples[1]))
        return tracer.counts

    def load(self) -> None:
        """Load or compile the kernels of a launch; no program of the project is run."""
        if self.scene.tables.record["asks_python"][0]:
            Tracer(self.scene).load()
        if self.generate.code != t.USER:
            self.tile(np.zeros(0, kernel.ITEM), Estimate.empty(0), slice(0, 0), 0)

    def _rule(self) -> int:
        single = self.settings.samples == 1 and not self.settings.progressive
        if single and self.settings.sampler != "RANDOM":
            return kernel.CENTRE
        if self.settings.sampler == "STRATIFIED":
            side = round(self.settings.samples**0.5)
            return kernel.STRATA if side * side == self.settings.samples else kernel.JITTER
        return kernel.JITTER if self.settings.sampler == "RANDOM" else kernel.SOBOL

    def _compiled(self, tracer: Tracer, items: NDArray[Any], radiance: F32) -> None:
        simulated = self.scene.settings.simulated
        lens = int(self.generate.code == THIN_LENS and simulated.lens)
        rule = self._rule()
        side = max(round(self.settings.samples**0.5), 1)
        if not self.scene.tables.record["asks_python"][0]:
            tracer.march(self.camera, (lens, rule, side), self.width, items, radiance)
            return
        queue = tracer.borrow(len(radiance))[: len(radiance)]
        seed = np.uint32(self.scene.settings.seed & 0xFFFFFFFF)
        kernel.generate_camera_rays(self.camera, lens, rule, side, seed, self.width, items, queue)
        tracer.follow(queue, 0, radiance)
        tracer.give_back(queue)

    def _launch(self, tracer: Tracer, items: NDArray[Any]) -> Launch:
        """The samples as a program of the project sees them."""
        flat = np.repeat(items["pixel"], items["count"])
        starts = np.repeat(np.cumsum(items["count"]) - items["count"], items["count"])
        sample = np.arange(len(flat)) - starts + np.repeat(items["first"], items["count"])
        return Launch(
            tracer,
            (flat % self.width).astype(np.int32),
            (flat // self.width).astype(np.int32),
            flat.astype(np.uint32),
            sample.astype(np.uint32),
            self.settings.samples,
            self.rays,
        )


Progress = Callable[[int, int], None]


def run_launch(
    work: Work,
    pixels: I64,
    progress: Progress,
    samples: NDArray[np.integer[Any]] | None = None,
    result: LaunchResult | None = None,
) -> LaunchResult:
    """Take samples of ``pixels``, in tiles over threads.

    ``samples`` (n,): how many of each, the settings' number by default; ``result``: what earlier
    launches found, to be added to. A sample that is not finite is replaced by what the exception
    program says, or dropped, and counted. The colours are the same to the bit for any tile size
    and number of threads.
    """
    settings = work.settings
    single = settings.samples == 1 and samples is None
    found = result or LaunchResult(Estimate.empty(len(pixels), single))
    items = np.zeros(len(pixels), kernel.ITEM)
    items["pixel"] = pixels
    items["first"] = found.estimate.taken
    items["count"] = settings.samples if samples is None else samples
    found.estimate.taken += items["count"]
    found.taken += int(items["count"].sum())
    suits = PYTHON_TILE if work.scene.tables.record["asks_python"][0] else COMPILED_TILE
    shift = packet_shift(int(items["count"].max(initial=1)))
    threads = settings.threads or os.cpu_count() or 1
    tile = settings.tile or _even(int(items["count"].sum()), suits, threads)
    parts = _parts(items, tile, shift)
    with ThreadPoolExecutor(max_workers=threads) as pool:
        tiles = [pool.submit(work.tile, items[p], found.estimate, p, shift) for p in parts]
        done = work.service.results(tiles) if work.service else (t.result() for t in tiles)
        try:
            for part, counts in zip(parts, done):
                found.counts.merge(counts)
                progress(part.stop, len(pixels))
        except BaseException:  # an error, or Ctrl-C: tiles that have not begun never do
            pool.shutdown(wait=False, cancel_futures=True)
            if work.service:
                work.service.abandon(tiles)
            raise
    return found


def packet_shift(samples: int) -> int:
    """Neighbours whose samples are traced together, as a power of two: a packet should be full."""
    return max((LANES // max(samples, 1)).bit_length() - 1, 0)


def _even(samples: int, tile: int, threads: int) -> int:
    """The size of at most about ``tile`` that gives every thread as many tiles, where there are
    several."""
    if samples <= tile:
        return tile
    rounds = -(-samples // (tile * threads))
    return max(-(-samples // max(rounds * threads, 1)), 1)


def _parts(items: NDArray[Any], tile: int, shift: int) -> list[slice]:
    """Runs of about ``tile`` samples each; pixels that are traced together stay together."""
    if not len(items):
        return []
    starts = np.flatnonzero(np.diff(items["pixel"] >> shift, prepend=-1))
    ends = np.append(starts[1:], len(items))
    done = np.cumsum(items["count"], dtype=np.int64)[ends - 1]
    parts: list[slice] = []
    at, before = 0, 0
    while at < len(starts):
        stop = max(int(np.searchsorted(done, before + tile, side="right")), at + 1)
        parts.append(slice(int(starts[at]), int(ends[stop - 1])))
        at, before = stop, int(done[stop - 1])
    return parts

"""Dispatch of a launch: the selected pixels in tiles, and the tiles over threads."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.kernels.core.tables import LANES
from nau_py.raytrace.kernels.path.camera import ITEM
from nau_py.raytrace.tracing.estimate import I64, LaunchResult, PixelEstimates
from nau_py.raytrace.tracing.launch import RayLaunch

COMPILED_TILE, PYTHON_TILE = 16384, 65536
"""Rays a tile. Calls of Python programs take time, so that their batches are larger."""

Progress = Callable[[int, int], None]
"""``progress(pixels done, pixels)``"""


def run_launch(
    launch: RayLaunch,
    pixels: I64,
    progress: Progress,
    samples: NDArray[np.integer[Any]] | None = None,
    result: LaunchResult | None = None,
) -> LaunchResult:
    """Trace the samples of ``pixels`` in tiles over threads, and return their estimates.

    ``pixels`` int64 (n,): flat indices; ``samples`` (n,): samples of each, the settings' number by
    default; ``result``: result of earlier launches, which is continued. A sample that is not finite
    is replaced by the exception program or dropped, and counted. The estimates are the same to the
    bit for any tile size and number of threads. Raises :class:`~nau_py.ProgramError`.
    """
    settings = launch.settings
    single = settings.samples == 1 and samples is None
    found = result or LaunchResult(PixelEstimates.empty(len(pixels), single))
    items = np.zeros(len(pixels), ITEM)
    items["pixel"] = pixels
    items["first"] = found.estimates.taken
    items["count"] = settings.samples if samples is None else samples
    found.estimates.taken += items["count"]
    found.taken += int(items["count"].sum())
    usual = PYTHON_TILE if launch.asks_python else COMPILED_TILE
    shift = compute_packet_shift(int(items["count"].max(initial=1)))
    threads = settings.threads or os.cpu_count() or 1
    tile = settings.tile or balance_tile(int(items["count"].sum()), usual, threads)
    parts = split_items(items, tile, shift)
    service = launch.main_thread
    with ThreadPoolExecutor(max_workers=threads) as pool:
        tiles = [pool.submit(launch.trace_tile, items[p], found.estimates, p, shift) for p in parts]
        done = service.iterate_results(tiles) if service else (t.result() for t in tiles)
        try:
            for part, counts in zip(parts, done):
                found.counts.merge(counts)
                progress(part.stop, len(pixels))
        except BaseException:  # an error or Ctrl-C: tiles that have not begun are cancelled
            pool.shutdown(wait=False, cancel_futures=True)
            if service:
                service.cancel(tiles)
            raise
    return found


def compute_packet_shift(samples: int) -> int:
    """Return log2 of the number of neighbours that are traced together, to fill a packet."""
    return max((LANES // max(samples, 1)).bit_length() - 1, 0)


def balance_tile(samples: int, tile: int, threads: int) -> int:
    """Return a tile size of at most about ``tile`` that gives every thread as many tiles."""
    if samples <= tile:
        return tile
    rounds = -(-samples // (tile * threads))
    return max(-(-samples // max(rounds * threads, 1)), 1)


def split_items(items: NDArray[Any], tile: int, shift: int) -> list[slice]:
    """Split records of ITEM into tiles of about ``tile`` samples.

    Pixels that are traced together (the same pixel >> ``shift``) stay in one tile.
    """
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

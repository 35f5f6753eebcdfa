"""The integrator: loops that follow paths to their ends, a packet at a time."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.kernels.core.jit import inner, kernel
from nau_py.raytrace.kernels.core.memory import f32, i64, put_f32, put_i64
from nau_py.raytrace.kernels.core.tables import (
    COUNTERS,
    LANES,
    copy_path,
    path_at,
    set_heading,
    set_origin,
)
from nau_py.raytrace.kernels.path.camera import reset_path, start_camera_path
from nau_py.raytrace.kernels.path.packet import trace_packet


@inner
def save_counters(tile: Any, saved: NDArray[Any]) -> None:
    """Save the counters, in case the paths of a packet must be traced again."""
    for k in range(COUNTERS):
        saved[k] = i64(tile.counts, k)


@inner
def restore_counters(tile: Any, first: int, waiting: int, saved: NDArray[Any]) -> None:
    """Restore the counters of ``save_counters``, to trace again from path ``first`` on."""
    for k in range(COUNTERS):
        put_i64(tile.counts, k, saved[k])
    tile.next = first
    tile.waiting = waiting


@kernel
def trace_queue(
    scenes: NDArray[Any],
    ray_type: int,
    queue: NDArray[Any],
    tiles: NDArray[Any],
) -> None:
    """Follow the paths of ``queue`` from ``tile.next`` on and add their radiance to the results.

    ``scenes`` and ``tiles`` hold one record each. Paths of the same pixels are followed together.
    If the queue for Python is full, the results of these paths are undone, ``tile.next`` is set to
    the first of them, and the kernel returns.
    """
    scene, tile = scenes[0], tiles[0]
    size = queue.shape[0]
    before = np.empty((size, 4), np.float32)
    saved = np.empty(COUNTERS, np.int64)
    first = tile.next
    while first < size:
        waiting = tile.waiting
        save_counters(tile, saved)
        key = queue[first].pixel >> tile.shift
        stop = first
        while stop < size and queue[stop].pixel >> tile.shift == key:
            for k in range(4):
                before[stop, k] = f32(tile.radiance, 4 * queue[stop].index + k)
            stop += 1
        for begin in range(first, stop, LANES):
            packet = min(stop - begin, LANES)
            for k in range(packet):
                copy_path(path_at(tile.work, k), queue[begin + k])
            trace_packet(scene, tile, ray_type, packet)
        if tile.waiting > tile.capacity:
            for i in range(first, stop):
                for k in range(4):
                    put_f32(tile.radiance, 4 * queue[i].index + k, before[i, k])
            restore_counters(tile, first, waiting, saved)
            return
        first = stop
    tile.next = size


@kernel
def trace_rays(
    scenes: NDArray[Any],
    ray_type: int,
    origin: NDArray[np.float32],
    direction: NDArray[np.float32],
    tmax: NDArray[np.float32],
    pixel: NDArray[np.uint32],
    sample: NDArray[np.uint32],
    depth: int,
    kind: int,
    initial: float,
    tiles: NDArray[Any],
) -> None:
    """Do ``trace_queue`` for the rays of a Python program: ray i adds to result i.

    ``origin`` and ``direction`` float32 (n, 3); ``tmax`` has one entry, or one a ray.
    """
    scene, tile = scenes[0], tiles[0]
    size = origin.shape[0]
    saved = np.empty(COUNTERS, np.int64)
    first = tile.next
    while first < size:
        waiting = tile.waiting
        save_counters(tile, saved)
        key = pixel[first] >> tile.shift
        stop = first
        while stop < size and pixel[stop] >> tile.shift == key:
            stop += 1
        for begin in range(first, stop, LANES):
            packet = min(stop - begin, LANES)
            for k in range(packet):
                path, i = path_at(tile.work, k), begin + k
                reset_path(path)
                set_origin(path, (origin[i, 0], origin[i, 1], origin[i, 2]))
                set_heading(path, (direction[i, 0], direction[i, 1], direction[i, 2]))
                path.tmax = tmax[i if tmax.shape[0] > 1 else 0]
                path.index = i
                path.pixel = pixel[i]
                path.sample = sample[i]
                path.depth = depth
                path.kind = kind
                path.initial = initial
            trace_packet(scene, tile, ray_type, packet)
        if tile.waiting > tile.capacity:
            for i in range(4 * first, 4 * stop):
                put_f32(tile.radiance, i, 0.0)
            restore_counters(tile, first, waiting, saved)
            return
        first = stop
    tile.next = size


@kernel
def trace_samples(
    scenes: NDArray[Any],
    ray_type: int,
    cameras: NDArray[Any],
    code: int,
    rule: int,
    side: int,
    width: int,
    items: NDArray[Any],
    tiles: NDArray[Any],
) -> None:
    """Generate and follow the camera rays of ``items`` without a queue; no program is Python's.

    ``ray_type`` is an argument, as a constant 0 would compile every function once more.
    """
    scene, tile = scenes[0], tiles[0]
    at, size, i, taken = 0, 0, 0, 0
    count = items.shape[0]
    while i < count:
        flat = int(items[i].pixel)
        if taken < items[i].count:
            path = path_at(tile.work, size)
            number = int(items[i].first) + taken
            start_camera_path(
                cameras[0], code, rule, side, scene.seed, width, flat, number, at, path
            )
            at += 1
            size += 1
            taken += 1
        if taken >= items[i].count:
            i += 1
            taken = 0
        last_of_group = i == count or int(items[i].pixel) >> tile.shift != flat >> tile.shift
        if size == LANES or last_of_group:
            trace_packet(scene, tile, ray_type, size)
            size = 0

"""Memory of one thread that kernels work in: rays, paths, counters, results."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.kernels.core import tables as t
from nau_py.raytrace.kernels.intersect.any_hit import filter_address
from nau_py.raytrace.kernels.intersect.embree import CONTEXT, RAY_FLOATS
from nau_py.raytrace.kernels.intersect.ray_arrays import initialize_tile
from nau_py.raytrace.tracing.scene_tables import TracedScene
from nau_py.scene.mesh import F32

MIN_QUEUE = 1024
ALIGNMENT = 64
"""Alignment of Embree's packets, bytes."""
PACKET_BYTES = 4 * ((RAY_FLOATS + 1) * t.LANES + RAY_FLOATS)
"""Size of a packet of rays, the mask of valid ones, and a single ray."""
_LANES = np.dtype(
    [
        ("query", t.QUERY),
        ("lanes", "i8", t.LANES),
        ("seen", "f4", t.LANES),
        ("work", t.PATH, t.LANES),
        ("stack", t.PATH, t.STACK + t.LANES),
        ("shadows", t.SHADOW_RAY, t.SHADOWS),
    ],
    align=True,
)
"""Memory of a packet of paths, by the fields of TILE that point to it."""


class TileMemory:
    """Memory of the tiles of one thread, kept from tile to tile so that it stays in the cache.

    ``counters`` int64 (COUNTERS,) and ``viewed`` int32 (materials,) are written by kernels.
    """

    def __init__(self, scene: TracedScene) -> None:
        self.counters = np.zeros(t.COUNTERS, np.int64)
        self.viewed = np.zeros(max(len(scene.materials), 1), np.int32)
        self._lanes = np.zeros(1, _LANES)
        self._packet = np.zeros(PACKET_BYTES + ALIGNMENT, np.uint8)
        self._addresses = self._collect_addresses(scene)
        self._queues: list[NDArray[Any]] = []
        self._results = np.zeros((0, 4), np.float32)

    def reset(self, count: int) -> F32:
        """Reset the counters; return zeroed results for ``count`` samples, float32 (count, 4)."""
        self.counters[:] = 0
        self.viewed[:] = 0
        if len(self._results) < count:
            self._results = np.empty((count, 4), np.float32)
        found = self._results[:count]
        found[:] = 0
        return found

    def make_record(self, radiance: F32, shift: int) -> NDArray[Any]:
        """Return the TILE record, shape (1,), for kernels that add to ``radiance``."""
        tile = self._addresses.copy()
        tile["radiance"], tile["shift"] = radiance.ctypes.data, shift
        return tile

    def take_queue(self, size: int) -> NDArray[Any]:
        """Take an unused queue of at least ``size`` paths, uninitialized."""
        for index, queue in enumerate(self._queues):
            if len(queue) >= size:
                return self._queues.pop(index)
        return np.empty(max(size, MIN_QUEUE), t.PATH)

    def return_queue(self, queue: NDArray[Any]) -> None:
        """Return a queue (or a slice of it) for later use."""
        self._queues.append(queue if queue.base is None else queue.base)

    def _collect_addresses(self, scene: TracedScene) -> NDArray[Any]:
        tile, lanes = np.zeros(1, t.TILE), self._lanes.ctypes.data
        packet = -(-self._packet.ctypes.data // ALIGNMENT) * ALIGNMENT
        tile["packet"], tile["valid"] = packet, packet + 4 * RAY_FLOATS * t.LANES
        tile["ray"] = packet + 4 * (RAY_FLOATS + 1) * t.LANES
        for name in _LANES.names or ():
            tile[name] = lanes + _LANES.fields[name][1]  # type: ignore[index]
        query, counts = self._lanes["query"], self.counters.ctypes.data
        query["features"], query["context"] = -1, tile["query"] + np.uint64(CONTEXT)
        query["instance"], query["instance_primitive"] = -1, -1
        query["counts"] = counts
        if (scene.tables.arrays["has_any_hit"] != t.NOTHING).any():
            query["filter"] = filter_address()  # compiled only for scenes with any-hit programs
        query["scene"] = scene.tables.record.ctypes.data
        tile["counts"], tile["viewed"] = counts, self.viewed.ctypes.data
        initialize_tile(tile)
        return tile

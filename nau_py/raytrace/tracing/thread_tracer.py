"""The tracer of a thread: runs kernels over the paths of a tile, and Python programs in between."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.kernels.core import tables as t
from nau_py.raytrace.kernels.core.jit import COUNTS_CYCLES, count_cycles
from nau_py.raytrace.kernels.path.integrator import trace_queue, trace_rays, trace_samples
from nau_py.raytrace.tracing.counts import RayCounts
from nau_py.raytrace.tracing.deferred_programs import RECURSION_LIMIT, run_deferred
from nau_py.raytrace.tracing.ray_batch import Rays
from nau_py.raytrace.tracing.scene_tables import TracedScene
from nau_py.raytrace.tracing.tile_memory import TileMemory
from nau_py.scene.mesh import F32

_CODES = {name: code for code, name in enumerate(t.KINDS)}


class ThreadTracer:
    """Traces the tiles of one thread, one after the other, and counts their cost."""

    def __init__(self, scene: TracedScene) -> None:
        self.scene = scene
        self.shift = 0
        """Samples of the same pixel >> shift are traced together."""
        self.memory = TileMemory(scene)
        self._begun = 0
        self._named: dict[str, int] = {}
        self._rest = RayCounts()

    def begin_tile(self, count: int) -> F32:
        """Reset the counts and return zeroed results for ``count`` samples, float32 (count, 4)."""
        self._begun = count_cycles()
        self._named.clear()
        self._rest = RayCounts()
        return self.memory.reset(count)

    @property
    def counts(self) -> RayCounts:
        """Cost of the tile so far."""
        counters = self.memory.counters
        found = RayCounts(sources=dict(self._rest.sources))
        for name, code in _CODES.items():
            found.add_rays(name, int(counters[code]))
            if skipped := int(counters[t.SKIPPED + code]):
                found.skipped[name] = skipped
        found.viewed = {int(k) for k in np.flatnonzero(self.memory.viewed)}
        for name, count in self._named.items():
            found.add_rays(name, count)
        found.nonfinite = self._rest.nonfinite + int(counters[t.NONFINITE])
        found.cut_layers = int(counters[t.CUT])
        found.traced = int(counters[t.IN_EMBREE])
        found.cycles = count_cycles() - self._begun if COUNTS_CYCLES else 0
        return found

    def compile_kernels(self) -> None:
        """Compile the kernels that follow rays, or load them from the cache."""
        none, record = np.empty(0, t.PATH), self.scene.tables.record
        tile = self.memory.make_record(np.zeros((0, 4), np.float32), self.shift)
        trace_queue(record, 0, none, tile)
        vectors, words = np.zeros((0, 3), np.float32), np.zeros(0, np.uint32)
        limit = np.array([np.inf], np.float32)
        trace_rays(record, 0, vectors, vectors, limit, words, words, 1, t.PRIMARY, 0.0, tile)

    def count_nonfinite(self, source: str, count: int, pixel: int) -> None:
        """Count ``count`` samples of ``source`` that are not finite, the first at ``pixel``."""
        self._rest.nonfinite += count
        self._rest.add_source(source, count, pixel)

    def trace_camera_rays(
        self,
        camera: NDArray[Any],
        rule: tuple[int, int, int],
        width: int,
        items: NDArray[Any],
        radiance: F32,
    ) -> None:
        """Generate and trace the samples of ``items`` where no program is written in Python.

        ``camera``: record of CAMERA; ``rule``: code of the ray generation program, sample
        positions, strata a side (``kernels/path/camera.py``); ``width`` of the image in pixels.
        Adds to ``radiance``.
        """
        record = self.scene.tables.record
        tile = self.memory.make_record(radiance, self.shift)
        trace_samples(record, 0, camera, *rule, width, items, tile)

    def trace_paths(
        self, queue: NDArray[Any], ray_type: int, radiance: F32, name: str = "primary"
    ) -> None:
        """Follow the paths of ``queue`` to their ends and add their radiance to ``radiance``."""

        def run_kernel(tile: NDArray[Any]) -> None:
            trace_queue(self.scene.tables.record, ray_type, queue, tile)

        self._trace(run_kernel, len(queue), ray_type, radiance, name)

    def trace_batch(self, rays: Rays, tmax: F32 | None, kind: str | None, initial: float) -> F32:
        """Trace the rays that a Python program sends; return their radiance, RGBA float32 (n, 4).

        ``tmax`` float32 (n,) or None; ``kind``: kind that they count as; ``initial``: value of a
        miss without a program. Raises ValueError for a ray type that the pass does not have.
        """
        types = self.scene.ray_types
        if rays.ray_type not in types:
            raise ValueError(
                f"ray type '{rays.ray_type}' is not one of the pass: {', '.join(types)}"
            )
        result = np.zeros((len(rays), 4), np.float32)
        if rays.depth > RECURSION_LIMIT:
            return result
        limit = np.array([np.inf] if tmax is None else tmax, np.float32)
        name = kind or rays.ray_type
        code, ray_type = _CODES.get(name, t.OTHER), types.index(rays.ray_type)
        record = self.scene.tables.record
        origin, direction = (
            np.ascontiguousarray(a, np.float32) for a in (rays.origin, rays.direction)
        )
        pixel, sample, depth = rays.pixel, rays.sample, rays.depth

        def run_kernel(tile: NDArray[Any]) -> None:
            trace_rays(
                record, ray_type, origin, direction, limit, pixel, sample, depth, code, initial,
                tile,
            )  # fmt: skip

        counters = self.memory.counters
        before = int(counters[t.OTHER])
        self._trace(run_kernel, len(rays), ray_type, result, name)
        if code == t.OTHER:
            count = int(counters[t.OTHER]) - before
            counters[t.OTHER] = before
            self._named[name] = self._named.get(name, 0) + count
        return result

    def _trace(
        self,
        run_kernel: Callable[[NDArray[Any]], None],
        size: int,
        ray_type: int,
        radiance: F32,
        name: str,
    ) -> None:
        """Repeat a kernel until ``size`` rays are done; run Python programs between the calls."""
        tile = self.memory.make_record(radiance, self.shift)
        asks_python = bool(self.scene.tables.record["asks_python"][0])
        deferred = self.memory.take_queue(size + 1 if asks_python else 1)
        while tile["next"][0] < size:
            tile["waiting"], tile["deferred"] = 0, deferred.ctypes.data
            tile["capacity"] = len(deferred) - 1
            run_kernel(tile)
            waiting = int(tile["waiting"][0])
            if waiting:
                paths = deferred[:waiting]
                again = run_deferred(self, paths, ray_type, radiance, self._rest.add_source)
                if len(again):
                    self.trace_paths(again, ray_type, radiance, name)
            elif tile["next"][0] < size:  # the paths of one pixel need a longer queue
                deferred = np.empty(2 * len(deferred), t.PATH)
        self.memory.return_queue(deferred)


class ThreadTracers:
    """The tracers of a launch, one a thread: memory that is used again stays in the cache."""

    def __init__(self) -> None:
        self._local = threading.local()

    def get(self, scene: TracedScene) -> ThreadTracer:
        """Return the tracer of the calling thread."""
        found: ThreadTracer | None = getattr(self._local, "tracer", None)
        if found is None or found.scene is not scene:
            found = self._local.tracer = ThreadTracer(scene)
        return found

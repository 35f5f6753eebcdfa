"""The wavefront: kernels follow a batch of rays, and Python programs answer what they ask."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.kernels.core import tables as t
from nau_py.raytrace.kernels.core.jit import COUNTS_CYCLES, count_cycles
from nau_py.raytrace.kernels.intersect.any_hit import filter_address
from nau_py.raytrace.kernels.intersect.embree import CONTEXT, RAY_FLOATS
from nau_py.raytrace.kernels.intersect.ray_arrays import initialize_tile
from nau_py.raytrace.kernels.path import deferred as kernel
from nau_py.raytrace.kernels.path.integrator import trace_queue, trace_rays, trace_samples
from nau_py.raytrace.programs.description import ANY_HIT, CLOSEST_HIT, MISS
from nau_py.raytrace.tracing.arrays import F32
from nau_py.raytrace.tracing.batches import Hits, Rays
from nau_py.raytrace.tracing.program_loader import BoundProgram
from nau_py.raytrace.tracing.scene_tables import Scene

RECURSION_LIMIT = 64
MIN_QUEUE = 1024
ALIGNMENT = 64
"""Of Embree's packets, bytes."""
PACKET_BYTES = 4 * ((RAY_FLOATS + 1) * t.LANES + RAY_FLOATS)
"""A packet of rays, the mask of valid ones, a single ray."""
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
"""Memory of a packet."""
_CODES = {name: code for code, name in enumerate(t.KINDS)}


@dataclass(slots=True)
class RayCounts:
    """What one tile of work cost. ``sources``: for each program or pass that gave a value that is
    not finite, how many and the first pixel. ``cycles``: of the processor, and of them ``traced``
    in Embree (0 where they cannot be counted). ``skipped``: rays of effects that are left out, by
    kind. ``viewed``: materials, by index, that primary rays met."""

    rays: dict[str, int] = field(default_factory=dict)
    nonfinite: int = 0
    cut_layers: int = 0
    sources: dict[str, tuple[int, int]] = field(default_factory=dict)
    cycles: int = 0
    traced: int = 0
    skipped: dict[str, int] = field(default_factory=dict)
    viewed: set[int] = field(default_factory=set)

    def add(self, kind: str, count: int) -> None:
        if count:
            self.rays[kind] = self.rays.get(kind, 0) + count

    def blame(self, source: str, count: int, pixel: int) -> None:
        if count:
            before, first = self.sources.get(source, (0, pixel))
            self.sources[source] = (before + count, min(first, pixel))

    def blamed(self, width: int) -> str:
        """Where values that are not finite came from, as the end of a sentence."""
        found = sorted(self.sources.items(), key=lambda item: item[1][1])
        if not found:
            return ""
        source, (_, pixel) = found[0]
        return f"; the first at pixel ({pixel % width}, {pixel // width}) from {source}"

    def merge(self, other: RayCounts) -> None:
        for kind, count in other.rays.items():
            self.add(kind, count)
        for source, (count, pixel) in other.sources.items():
            self.blame(source, count, pixel)
        self.nonfinite += other.nonfinite
        self.cut_layers += other.cut_layers
        self.cycles += other.cycles
        self.traced += other.traced
        for kind, count in other.skipped.items():
            self.skipped[kind] = self.skipped.get(kind, 0) + count
        self.viewed |= other.viewed

    @property
    def traced_share(self) -> float:
        """The part of the time in which rays were traced; the rest is shading. 1 where that
        cannot be told."""
        return min(self.traced / self.cycles, 1.0) if self.cycles > 0 else 1.0


class Tracer:
    """Traces for one tile, and counts what that costs."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.shift = 0
        """Samples of the same pixel >> shift are traced together."""
        self._counters = np.zeros(t.COUNTERS, np.int64)
        self._begun = 0
        self._named: dict[str, int] = {}
        self._rest = RayCounts()
        self._viewed = np.zeros(max(len(scene.materials), 1), np.int32)
        self._lanes = np.zeros(1, _LANES)
        self._packet = np.zeros(PACKET_BYTES + ALIGNMENT, np.uint8)
        self._made = self._addresses()
        self._queues: list[NDArray[Any]] = []
        self._results = np.zeros((0, 4), np.float32)

    def results(self, count: int) -> F32:
        """Room for a tile's results, zero, (count, 4); it and the counts begin anew."""
        self._counters[:] = 0
        self._viewed[:] = 0
        self._begun = count_cycles()
        self._named.clear()
        self._rest = RayCounts()
        if len(self._results) < count:
            self._results = np.empty((count, 4), np.float32)
        found = self._results[:count]
        found[:] = 0
        return found

    @property
    def counts(self) -> RayCounts:
        """The cost so far."""
        found = RayCounts(sources=dict(self._rest.sources))
        for name, code in _CODES.items():
            found.add(name, int(self._counters[code]))
            if skipped := int(self._counters[t.SKIPPED + code]):
                found.skipped[name] = skipped
        found.viewed = {int(k) for k in np.flatnonzero(self._viewed)}
        for name, count in self._named.items():
            found.add(name, count)
        found.nonfinite = self._rest.nonfinite + int(self._counters[t.NONFINITE])
        found.cut_layers = int(self._counters[t.CUT])
        found.traced = int(self._counters[t.IN_EMBREE])
        found.cycles = count_cycles() - self._begun if COUNTS_CYCLES else 0
        return found

    def load(self) -> None:
        """Load the kernels that follow rays, or compile them: no tile shall pay for it."""
        none, record = np.empty(0, t.PATH), self.scene.tables.record
        tile = self._tile(np.zeros((0, 4), np.float32))
        trace_queue(record, 0, none, tile)
        vectors, words = np.zeros((0, 3), np.float32), np.zeros(0, np.uint32)
        limit = np.array([np.inf], np.float32)
        trace_rays(record, 0, vectors, vectors, limit, words, words, 1, t.PRIMARY, 0.0, tile)

    def dropped(self, source: str, count: int, pixel: int) -> None:
        """Note ``count`` samples that are not finite."""
        self._rest.nonfinite += count
        self._rest.blame(source, count, pixel)

    def trace(self, rays: Rays, tmax: F32 | None, kind: str | None, initial: float) -> F32:
        """What a batch of rays brings, RGBA float32 (n, 4)."""
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

        def step(tile: NDArray[Any]) -> None:
            trace_rays(
                record, ray_type, origin, direction, limit, pixel, sample, depth, code, initial,
                tile,
            )  # fmt: skip

        before = int(self._counters[t.OTHER])
        self._drive(step, len(rays), ray_type, result, name)
        if code == t.OTHER:
            count = int(self._counters[t.OTHER]) - before
            self._counters[t.OTHER] = before
            self._named[name] = self._named.get(name, 0) + count
        return result

    def borrow(self, size: int) -> NDArray[Any]:
        for index, queue in enumerate(self._queues):
            if len(queue) >= size:
                return self._queues.pop(index)
        return np.empty(max(size, MIN_QUEUE), t.PATH)

    def give_back(self, queue: NDArray[Any]) -> None:
        self._queues.append(queue if queue.base is None else queue.base)

    def _tile(self, radiance: F32) -> NDArray[Any]:
        """The record of addresses that kernels work with."""
        tile = self._made.copy()
        tile["radiance"], tile["shift"] = radiance.ctypes.data, self.shift
        return tile

    def _addresses(self) -> NDArray[Any]:
        tile, lanes = np.zeros(1, t.TILE), self._lanes.ctypes.data
        packet = -(-self._packet.ctypes.data // ALIGNMENT) * ALIGNMENT
        tile["packet"], tile["valid"] = packet, packet + 4 * RAY_FLOATS * t.LANES
        tile["ray"] = packet + 4 * (RAY_FLOATS + 1) * t.LANES
        for name in _LANES.names or ():
            tile[name] = lanes + _LANES.fields[name][1]  # type: ignore[index]
        query, counts = self._lanes["query"], self._counters.ctypes.data
        query["features"], query["context"] = -1, tile["query"] + np.uint64(CONTEXT)
        query["instance"], query["instance_primitive"] = -1, -1
        query["counts"] = counts
        if (self.scene.tables.arrays["has_any_hit"] != t.NOTHING).any():
            query["filter"] = filter_address()  # compiled only where something is to be asked
        query["scene"] = self.scene.tables.record.ctypes.data
        tile["counts"], tile["viewed"] = counts, self._viewed.ctypes.data
        initialize_tile(tile)
        return tile

    def march(
        self,
        camera: NDArray[Any],
        rule: tuple[int, int, int],
        width: int,
        items: NDArray[Any],
        radiance: F32,
    ) -> None:
        """Samples of ``items`` by compiled programs alone; ``rule``: lens, sampler, strata."""
        trace_samples(self.scene.tables.record, camera, *rule, width, items, self._tile(radiance))

    def follow(
        self, queue: NDArray[Any], ray_type: int, radiance: F32, name: str = "primary"
    ) -> None:
        """Follow the paths of ``queue`` to their ends; add what they bring to ``radiance``."""

        def step(tile: NDArray[Any]) -> None:
            trace_queue(self.scene.tables.record, ray_type, queue, tile)

        self._drive(step, len(queue), ray_type, radiance, name)

    def _drive(
        self,
        step: Callable[[NDArray[Any]], None],
        size: int,
        ray_type: int,
        radiance: F32,
        name: str,
    ) -> None:
        """Repeat a kernel's ``step`` until ``size`` rays are done, and answer for Python."""
        tile = self._tile(radiance)
        asks = bool(self.scene.tables.record["asks_python"][0])
        deferred = self.borrow(size + 1 if asks else 1)
        while tile["next"][0] < size:
            tile["waiting"], tile["deferred"] = 0, deferred.ctypes.data
            tile["capacity"] = len(deferred) - 1
            step(tile)
            waiting = int(tile["waiting"][0])
            if waiting:
                again = self._answer(deferred[:waiting], ray_type, radiance, name)
                if len(again):
                    self.follow(again, ray_type, radiance, name)
            elif tile["next"][0] < size:  # one pixel's paths ask more than the queue holds
                deferred = np.empty(2 * len(deferred), t.PATH)
        self.give_back(deferred)

    def _answer(self, paths: NDArray[Any], ray_type: int, radiance: F32, name: str) -> NDArray[Any]:
        """Run the programs that ``paths`` wait for, by material; the paths that go on, in the order
        of their results."""
        materials = max(len(self.scene.materials), 1)
        depths = RECURSION_LIMIT + 2
        keys = np.empty(len(paths), np.int32)
        tables = self.scene.tables
        kernel.compute_group_keys(paths, tables.arrays["owner"], materials, depths, keys)
        order = np.empty(len(paths), np.int64)
        starts = np.empty((t.OCCLUSION + 1) * depths * materials + 1, np.int64)
        kernel.sort_keys(keys, len(starts) - 1, order, starts)
        going: list[NDArray[Any]] = []
        for key in np.flatnonzero(np.diff(starts)):
            group = order[starts[key] : starts[key + 1]]
            status, material = int(key) // (depths * materials), int(key) % materials
            if status == t.CANDIDATE:
                found = self._candidates(_rows(paths, group), ray_type, material)
                going += [part for part in found if len(part)]
                continue
            program = None
            if status == t.HIT:
                program = self.scene.program(self._type(ray_type), CLOSEST_HIT, material)
                values = self._radiance(program, self._hits(paths, group, ray_type, material))
            elif status == t.MISSED:
                program = self.scene.program(self._type(ray_type), MISS, 0)
                values = self._radiance(program, self._rays(paths, group, ray_type))
            else:
                values = self._visibility(paths, group, ray_type)
            bad = np.zeros(2, np.int64)
            kernel.add_results(radiance, paths, group, values, status == t.OCCLUSION, bad)
            if program is not None:
                self._rest.blame(program.label, int(bad[0]), int(bad[1]))
        if not going:
            return paths[:0]
        again = np.concatenate(going)
        return _rows(again, np.argsort(again["index"], kind="stable"))

    def _type(self, ray_type: int) -> str:
        return self.scene.ray_types[ray_type]

    def _hits(
        self, paths: NDArray[Any], group: NDArray[np.int64], ray_type: int, material: int
    ) -> Hits:
        n = len(group)
        vectors, numbers = np.empty((2, n, 3), np.float32), np.empty((3, n), np.float32)
        keys, triangle = np.empty((2, n), np.uint32), np.empty(n, np.int32)
        kernel.unpack_paths(paths, group, vectors, numbers, keys, triangle)
        depth = int(paths["depth"][group[0]])
        (origin, direction), (u, v, distance), (pixel, sample) = vectors, numbers, keys
        rays = Rays(self, origin, direction, pixel, sample, depth, self._type(ray_type))
        return Hits(rays, triangle, u, v, distance, self.scene.materials[material])

    def _rays(self, paths: NDArray[Any], group: NDArray[np.int64], ray_type: int) -> Rays:
        return self._hits(paths, group, ray_type, 0).rays

    def _radiance(self, program: BoundProgram | None, argument: Hits | Rays) -> F32:
        assert program is not None
        return program.radiance(argument, len(argument))

    def _candidates(self, paths: NDArray[Any], ray_type: int, material: int) -> list[NDArray[Any]]:
        """Ask the any-hit program; accepted hits are shaded, ignored ones passed through."""
        program = self.scene.program(self._type(ray_type), ANY_HIT, material)
        assert program is not None
        everyone = np.arange(len(paths))
        accepted = program.accepts(self._hits(paths, everyone, ray_type, material), len(paths))
        kept = _rows(paths, np.flatnonzero(accepted))
        ignored = _rows(paths, np.flatnonzero(~accepted))
        kept["status"] = t.SHADE
        kernel.continue_paths(self.scene.tables.record, ignored)
        closest = self.scene.tables.arrays["closest"][ray_type, material] != 0
        return [kept, ignored] if closest else [ignored]

    def _visibility(self, paths: NDArray[Any], group: NDArray[np.int64], ray_type: int) -> F32:
        """What a light's shadow rays bring: red is the visibility."""
        shadow = int(self.scene.tables.record["shadow_type"][0])
        rays = self._rays(paths, group, shadow if shadow >= 0 else ray_type)
        rays.depth += 1
        return self.trace(rays, np.ascontiguousarray(paths["tmax"][group]), "shadow", 0.0)


class Tracers:
    """A tracer for each thread, kept from tile to tile: memory that is touched stays warm."""

    def __init__(self) -> None:
        self._local = threading.local()

    def mine(self, scene: Scene) -> Tracer:
        """The tracer of the calling thread."""
        found: Tracer | None = getattr(self._local, "tracer", None)
        if found is None or found.scene is not scene:
            found = self._local.tracer = Tracer(scene)
        return found


def _rows(paths: NDArray[Any], index: NDArray[np.int64]) -> NDArray[Any]:
    """``paths[index]``; whole words are copied much faster than records."""
    words = paths.view(np.uint64).reshape(len(paths), -1)
    return np.take(words, index, axis=0).view(t.PATH).reshape(-1)

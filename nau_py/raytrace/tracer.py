"""The wavefront: a batch of rays is traced, its hits are grouped by material, programs run."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.model.builtins import ANY_HIT, CLOSEST_HIT, MISS
from nau_py.raytrace.accel import NO_HIT, Accelerator, Intersections
from nau_py.raytrace.geometry import RayGeometry
from nau_py.raytrace.hits import Hits, RayLight, RayMaterial, Rays
from nau_py.raytrace.programs import BoundProgram
from nau_py.raytrace.spawn import spawn
from nau_py.raytrace.vectors import F32

MAX_LAYERS = 256
"""Ignored hits that one ray may pass through; reaching it is reported, never silent."""
RECURSION_LIMIT = 64


@dataclass(slots=True)
class RayCounts:
    """What one tile of work cost."""

    rays: dict[str, int] = field(default_factory=dict)
    nonfinite: int = 0
    cut_layers: int = 0

    def add(self, kind: str, count: int) -> None:
        if count:
            self.rays[kind] = self.rays.get(kind, 0) + count

    def merge(self, other: RayCounts) -> None:
        for kind, count in other.rays.items():
            self.add(kind, count)
        self.nonfinite += other.nonfinite
        self.cut_layers += other.cut_layers


ProgramTable = dict[tuple[str, str], list[BoundProgram | None]]
"""(ray type, kind) to a program for each material; a MISS has one entry."""


@dataclass(slots=True)
class Scene:
    """What does not change between the tiles of a launch."""

    geometry: RayGeometry
    accelerator: Accelerator
    materials: list[RayMaterial]
    programs: ProgramTable
    lights: list[RayLight]
    variables: dict[str, NDArray[Any]]
    inputs: dict[str, NDArray[Any]]
    ray_types: list[str]
    max_depth: int
    seed: int
    clear_color: F32

    def is_visibility(self, ray_type: str) -> bool:
        """Whether no material has a closest-hit program: such rays ask only what is in the way."""
        return not any(self.programs.get((ray_type, CLOSEST_HIT), []))


class Tracer:
    """Traces for one tile, and counts what that costs."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.counts = RayCounts()
        self.geometry = scene.geometry
        self.lights = scene.lights
        self.variables = scene.variables
        self.inputs = scene.inputs
        self.ray_types = scene.ray_types
        self.seed = scene.seed
        self.clear_color = scene.clear_color

    def trace(self, rays: Rays, tmax: F32 | None, kind: str | None, initial: float) -> F32:
        """What a batch of rays brings, RGBA float32 (n, 4)."""
        if rays.ray_type not in self.ray_types:
            known = ", ".join(self.ray_types)
            raise ValueError(f"ray type '{rays.ray_type}' is not one of the pass: {known}")
        result = np.zeros((len(rays), 4), np.float32)
        visibility = self.scene.is_visibility(rays.ray_type)
        if rays.depth > RECURSION_LIMIT or (rays.depth > self.scene.max_depth and not visibility):
            return result
        finite = np.isfinite(rays.origin).all(axis=1) & np.isfinite(rays.direction).all(axis=1)
        finite &= (rays.direction != 0).any(axis=1)
        if not finite.all():
            self.counts.nonfinite += int((~finite).sum())
        chosen = np.flatnonzero(finite)
        self.counts.add(kind or rays.ray_type, len(chosen))
        part = _take(rays, chosen)
        limit = None if tmax is None else np.asarray(tmax, np.float32)[chosen]
        any_hit = self._any_hit(rays.ray_type)
        miss = self.scene.programs.get((rays.ray_type, MISS), [None])[0]
        if visibility and not any(any_hit):
            blocked = self.scene.accelerator.occluded(part.origin, part.direction, limit)
        else:
            found = self._nearest(part, limit, any_hit)
            blocked = found.triangle != NO_HIT
            if not visibility:
                self._shade(part, found, chosen, result)
        missed = np.flatnonzero(~blocked)
        if miss is not None and len(missed):
            result[chosen[missed]] = miss.radiance(_take(part, missed), len(missed))
        elif initial:
            result[chosen[missed]] = np.float32(initial)
        return result

    def _any_hit(self, ray_type: str) -> list[BoundProgram | None]:
        return self.scene.programs.get((ray_type, ANY_HIT), [])

    def _nearest(
        self, rays: Rays, tmax: F32 | None, any_hit: list[BoundProgram | None]
    ) -> Intersections:
        """Nearest accepted hits: ignored ones are passed through, layer by layer."""
        found = self.scene.accelerator.intersect(rays.origin, rays.direction, tmax)
        if not any(any_hit):
            return found
        travelled = np.zeros(len(rays), np.float32)
        pending = np.flatnonzero(found.triangle != NO_HIT)
        tests = np.array([program is not None for program in any_hit])
        for _ in range(MAX_LAYERS):
            pending = pending[tests[self.geometry.material[found.triangle[pending]]]]
            ignored = self._ignored(rays, found, pending, any_hit)
            if not len(ignored):
                return found
            hits = self._hits(_take(rays, ignored), found, ignored, 0)
            position, normal, bound = hits._surface
            origin = spawn(position, normal, bound, rays.direction[ignored])
            travelled[ignored] += found.t[ignored]
            limit = None if tmax is None else np.maximum(tmax[ignored] - travelled[ignored], 0)
            again = self.scene.accelerator.intersect(origin, rays.direction[ignored], limit)
            self.counts.add("continuation", len(ignored))
            found.triangle[ignored], found.t[ignored] = again.triangle, again.t
            found.u[ignored], found.v[ignored] = again.u, again.v
            pending = ignored[again.triangle != NO_HIT]
        self.counts.cut_layers += len(pending)
        return found

    def _ignored(
        self,
        rays: Rays,
        found: Intersections,
        pending: NDArray[np.int64],
        any_hit: list[BoundProgram | None],
    ) -> NDArray[np.int64]:
        """Which of the ``pending`` hits their any-hit programs ignore."""
        ignored = []
        for index, chosen in self._by_material(found, pending):
            program = any_hit[index]
            if program is not None:
                hits = self._hits(_take(rays, chosen), found, chosen, index)
                ignored.append(chosen[~program.accepts(hits, len(chosen))])
        return np.sort(np.concatenate(ignored)) if ignored else np.zeros(0, np.int64)

    def _by_material(
        self, found: Intersections, chosen: NDArray[np.int64]
    ) -> list[tuple[int, NDArray[np.int64]]]:
        material = self.geometry.material[found.triangle[chosen]]
        order = np.argsort(material, kind="stable")
        indices, starts = np.unique(material[order], return_index=True)
        parts = np.split(chosen[order], starts[1:])
        return [(int(index), part) for index, part in zip(indices, parts)]

    def _hits(
        self, rays: Rays, found: Intersections, chosen: NDArray[np.int64], material: int
    ) -> Hits:
        return Hits(
            rays,
            found.triangle[chosen],
            found.u[chosen],
            found.v[chosen],
            found.t[chosen],
            self.scene.materials[material],
        )

    def _shade(
        self, rays: Rays, found: Intersections, chosen: NDArray[np.int64], result: F32
    ) -> None:
        programs = self.scene.programs.get((rays.ray_type, CLOSEST_HIT), [])
        hit = np.flatnonzero(found.triangle != NO_HIT)
        for index, part in self._by_material(found, hit):
            program = programs[index]
            if program is not None:
                hits = self._hits(_take(rays, part), found, part, index)
                result[chosen[part]] = program.radiance(hits, len(part))


def _take(rays: Rays, chosen: NDArray[np.int64]) -> Rays:
    """The rays at ``chosen``."""
    if len(chosen) == len(rays):
        return rays
    return Rays(
        rays.tracer,
        rays.origin[chosen],
        rays.direction[chosen],
        rays.pixel[chosen],
        rays.sample[chosen],
        rays.depth,
        rays.ray_type,
    )

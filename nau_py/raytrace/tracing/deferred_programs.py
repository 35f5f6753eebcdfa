"""Programs written in Python, run for the paths that kernels deferred to them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.kernels.core import tables as t
from nau_py.raytrace.kernels.path import deferred as kernel
from nau_py.raytrace.programs.description import ANY_HIT, CLOSEST_HIT, MISS
from nau_py.raytrace.tracing.hit_batch import Hits
from nau_py.raytrace.tracing.program_loader import BoundProgram
from nau_py.raytrace.tracing.ray_batch import Rays, RaySender
from nau_py.scene.mesh import F32

RECURSION_LIMIT = 64
"""Deepest ray that a Python program may send."""
AddSource = Callable[[str, int, int], None]
"""``add_source(program, count, first pixel)`` for values that are not finite."""


def run_deferred(
    tracer: RaySender,
    paths: NDArray[Any],
    ray_type: int,
    radiance: F32,
    add_source: AddSource,
) -> NDArray[Any]:
    """Run the programs that ``paths`` wait for, grouped by program and material.

    Adds their results to ``radiance`` float32 (samples, 4). Returns the paths that continue, in the
    order of their results. Raises :class:`~nau_py.ProgramError` for a program that fails.
    """
    scene = tracer.scene
    materials = max(len(scene.materials), 1)
    depths = RECURSION_LIMIT + 2
    keys = np.empty(len(paths), np.int32)
    kernel.compute_group_keys(paths, scene.tables.arrays["owner"], materials, depths, keys)
    order = np.empty(len(paths), np.int64)
    starts = np.empty((t.OCCLUSION + 1) * depths * materials + 1, np.int64)
    kernel.sort_keys(keys, len(starts) - 1, order, starts)
    alive: list[NDArray[Any]] = []
    for key in np.flatnonzero(np.diff(starts)):
        group = order[starts[key] : starts[key + 1]]
        status, material = int(key) // (depths * materials), int(key) % materials
        if status == t.CANDIDATE:
            found = _run_any_hit(tracer, take_rows(paths, group), ray_type, material)
            alive += [part for part in found if len(part)]
            continue
        program = None
        if status == t.HIT:
            program = scene.program(scene.ray_types[ray_type], CLOSEST_HIT, material)
            values = _run(program, _make_hits(tracer, paths, group, ray_type, material))
        elif status == t.MISSED:
            program = scene.program(scene.ray_types[ray_type], MISS, 0)
            values = _run(program, _make_hits(tracer, paths, group, ray_type, 0).rays)
        else:
            values = _trace_visibility(tracer, paths, group, ray_type)
        bad = np.zeros(2, np.int64)
        kernel.add_results(radiance, paths, group, values, status == t.OCCLUSION, bad)
        if program is not None:
            add_source(program.label, int(bad[0]), int(bad[1]))
    if not alive:
        return paths[:0]
    again = np.concatenate(alive)
    return take_rows(again, np.argsort(again["index"], kind="stable"))


def take_rows(paths: NDArray[Any], index: NDArray[np.int64]) -> NDArray[Any]:
    """Return ``paths[index]``. Copying whole words is much faster than copying records."""
    words = paths.view(np.uint64).reshape(len(paths), -1)
    return np.take(words, index, axis=0).view(t.PATH).reshape(-1)


def _make_hits(
    tracer: RaySender, paths: NDArray[Any], group: NDArray[np.int64], ray_type: int, material: int
) -> Hits:
    """Return the paths of a group as a batch of hits on one material."""
    n = len(group)
    vectors, numbers = np.empty((2, n, 3), np.float32), np.empty((3, n), np.float32)
    keys, triangle = np.empty((2, n), np.uint32), np.empty(n, np.int32)
    kernel.unpack_paths(paths, group, vectors, numbers, keys, triangle)
    depth = int(paths["depth"][group[0]])
    (origin, direction), (u, v, distance), (pixel, sample) = vectors, numbers, keys
    scene = tracer.scene
    rays = Rays(tracer, origin, direction, pixel, sample, depth, scene.ray_types[ray_type])
    return Hits(rays, triangle, u, v, distance, scene.materials[material])


def _run(program: BoundProgram | None, argument: Hits | Rays) -> F32:
    assert program is not None
    return program.compute_radiance(argument, len(argument))


def _run_any_hit(
    tracer: RaySender, paths: NDArray[Any], ray_type: int, material: int
) -> list[NDArray[Any]]:
    """Run an any-hit program; accepted hits are to be shaded, ignored ones continue behind."""
    scene = tracer.scene
    program = scene.program(scene.ray_types[ray_type], ANY_HIT, material)
    assert program is not None
    everyone = np.arange(len(paths))
    hits = _make_hits(tracer, paths, everyone, ray_type, material)
    accepted = program.decide_hits(hits, len(paths))
    kept = take_rows(paths, np.flatnonzero(accepted))
    ignored = take_rows(paths, np.flatnonzero(~accepted))
    kept["status"] = t.SHADE
    kernel.continue_paths(scene.tables.record, ignored)
    closest = scene.tables.arrays["closest"][ray_type, material] != 0
    return [kept, ignored] if closest else [ignored]


def _trace_visibility(
    tracer: RaySender, paths: NDArray[Any], group: NDArray[np.int64], ray_type: int
) -> F32:
    """Trace the shadow rays of deferred lights; the red of the result is the visibility."""
    shadow = int(tracer.scene.tables.record["shadow_type"][0])
    rays = _make_hits(tracer, paths, group, shadow if shadow >= 0 else ray_type, 0).rays
    rays.depth += 1
    return tracer.trace_batch(rays, np.ascontiguousarray(paths["tmax"][group]), "shadow", 0.0)

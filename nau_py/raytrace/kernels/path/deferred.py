"""Paths that wait for programs written in Python: grouped, handed over as arrays, and continued."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.kernels.core.jit import kernel
from nau_py.raytrace.kernels.core.tables import CANDIDATE, heading_of, origin_of, weight_of
from nau_py.raytrace.kernels.shading.scatter import pass_hit

F32 = NDArray[np.float32]
I32 = NDArray[np.int32]


@kernel
def compute_group_keys(
    paths: NDArray[Any], owner: I32, materials: int, depths: int, keys: I32
) -> None:
    """Compute the group of each path: status, depth and material as one number."""
    for i in range(paths.shape[0]):
        path = paths[i]
        material = owner[path.triangle] if path.status <= CANDIDATE else 0
        depth = min(int(path.depth), depths - 1)
        keys[i] = (path.status * depths + depth) * materials + material


@kernel
def sort_keys(keys: I32, count: int, order: NDArray[np.int64], starts: NDArray[np.int64]) -> None:
    """Sort ``keys`` stably by counting: ``order`` lists indices by key, ``starts`` (count + 1,)
    gets the first entry of each key."""
    starts[:] = 0
    for i in range(keys.shape[0]):
        starts[keys[i] + 1] += 1
    for k in range(count):
        starts[k + 1] += starts[k]
    at = starts[:-1].copy()
    for i in range(keys.shape[0]):
        order[at[keys[i]]] = i
        at[keys[i]] += 1


@kernel
def unpack_paths(
    paths: NDArray[Any],
    order: NDArray[np.int64],
    vectors: F32,
    numbers: F32,
    keys: NDArray[np.uint32],
    triangle: I32,
) -> None:
    """Write the paths that ``order`` lists to arrays: ``vectors`` (2, n, 3) origin and direction,
    ``numbers`` (3, n) u, v and t, ``keys`` (2, n) pixel and sample, ``triangle`` (n,)."""
    for i in range(order.shape[0]):
        path = paths[order[i]]
        o, d = origin_of(path), heading_of(path)
        for k in range(3):
            vectors[0, i, k] = o[k]
            vectors[1, i, k] = d[k]
        numbers[0, i] = path.u
        numbers[1, i] = path.v
        numbers[2, i] = path.t
        keys[0, i] = path.pixel
        keys[1, i] = path.sample
        triangle[i] = path.triangle


@kernel
def continue_paths(scenes: Any, paths: NDArray[Any]) -> None:
    """Continue paths behind the hits that a program ignored."""
    for i in range(paths.shape[0]):
        pass_hit(scenes[0], paths[i])


@kernel
def add_results(
    radiance: F32,
    paths: NDArray[Any],
    order: NDArray[np.int64],
    values: F32,
    visible: bool,
    bad: NDArray[np.int64],
) -> None:
    """Add a program's results for the paths of ``order`` to the radiance, weighted.

    ``visible``: the red of ``values`` (n, 4) is visibility. ``bad[0]`` counts results that are not
    finite, ``bad[1]`` is the pixel of the first.
    """
    for i in range(order.shape[0]):
        path = paths[order[i]]
        weight = weight_of(path)
        sound = True
        for k in range(4):
            factor = values[i, k]
            if visible:
                factor = values[i, 0]
            elif path.band >= 0 and k < 3:
                factor = values[i, path.band]
            sound = sound and bool(np.isfinite(factor))
            radiance[path.index, k] += weight[k] * factor
        if not sound:
            if bad[0] == 0:
                bad[1] = path.pixel
            bad[0] += 1

"""What Python programs read of a batch of hits, computed for all at once."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.kernels.core.jit import V3, inner, kernel
from nau_py.raytrace.kernels.core.sampling import sample_1d
from nau_py.raytrace.kernels.core.tables import CANDIDATE, LANES, heading_of, origin_of, weight_of
from nau_py.raytrace.kernels.core.vec import normalize
from nau_py.raytrace.kernels.geometry.surface import (
    face_forward,
    interpolate_attribute,
    interpolate_normal,
    locate_point,
    offset_origin,
)
from nau_py.raytrace.kernels.geometry.texture import filter_texture
from nau_py.raytrace.kernels.intersect.embree import RAY_FLOATS, blank, blocked, hit, nearest
from nau_py.raytrace.kernels.intersect.visibility import finite
from nau_py.raytrace.kernels.shading.sample_bsdf import pass_hit

F32 = NDArray[np.float32]
I32 = NDArray[np.int32]


@inner
def vector(values: Any, i: int) -> V3:
    """Row ``i`` as a tuple."""
    return float(values[i, 0]), float(values[i, 1]), float(values[i, 2])


@kernel
def surface_points(
    scenes: Any, triangle: I32, u: F32, v: F32, position: F32, face: F32, bound: F32
) -> None:
    """Positions, face normals and error bounds."""
    for i in range(triangle.shape[0]):
        p, n, b = locate_point(scenes[0], int(triangle[i]), float(u[i]), float(v[i]))
        bound[i] = b
        for k in range(3):
            position[i, k] = p[k]
            face[i, k] = n[k]


@kernel
def shading_normals(scenes: Any, triangle: I32, u: F32, v: F32, face: F32, out: F32) -> None:
    for i in range(triangle.shape[0]):
        n = interpolate_normal(
            scenes[0], int(triangle[i]), float(u[i]), float(v[i]), vector(face, i)
        )
        for k in range(3):
            out[i, k] = n[k]


@kernel
def faced(normal: F32, direction: F32, out: F32) -> None:
    """Normals turned towards where rays come from."""
    for i in range(normal.shape[0]):
        n = face_forward(vector(normal, i), vector(direction, i))
        for k in range(3):
            out[i, k] = n[k]


@kernel
def attributes(scenes: Any, address: int, triangle: I32, u: F32, v: F32, out: F32) -> None:
    """The vertex attribute at ``address``, interpolated; as many components as ``out`` has."""
    for i in range(triangle.shape[0]):
        a = interpolate_attribute(address, scenes[0], int(triangle[i]), float(u[i]), float(v[i]))
        for k in range(out.shape[1]):
            out[i, k] = a[k]


@kernel
def texture_values(textures: Any, texels: int, uv: F32, out: F32) -> None:
    for i in range(uv.shape[0]):
        c = filter_texture(textures[0], texels, float(uv[i, 0]), float(uv[i, 1]))
        for k in range(4):
            out[i, k] = c[k]


@kernel
def departures(
    position: F32, face: F32, bound: F32, direction: F32, origin: F32, unit_direction: F32
) -> None:
    """Spawn points and unit directions of rays that leave surfaces."""
    for i in range(position.shape[0]):
        d = normalize(vector(direction, i))
        o = offset_origin(vector(position, i), vector(face, i), float(bound[i]), d)
        for k in range(3):
            origin[i, k] = o[k]
            unit_direction[i, k] = d[k]


@kernel
def departures_of(
    chosen: NDArray[np.int64],
    position: F32,
    face: F32,
    bound: F32,
    direction: F32,
    origin: F32,
    unit_direction: F32,
) -> None:
    """``departures`` of the surfaces that ``chosen`` lists. ``direction`` has one row, or one a
    surface."""
    for k in range(chosen.shape[0]):
        i = chosen[k]
        d = normalize(vector(direction, i if direction.shape[0] > 1 else 0))
        o = offset_origin(vector(position, i), vector(face, i), float(bound[i]), d)
        for m in range(3):
            origin[k, m] = o[m]
            unit_direction[k, m] = d[m]


@kernel
def prepare(tiles: Any) -> None:
    """Make the rays of a tile's record ready to be filled in."""
    blank(tiles[0].ray, 1)
    blank(tiles[0].packet, LANES)


@kernel
def uniforms(
    seed: int,
    pixel: NDArray[np.uint32],
    sample: NDArray[np.uint32],
    dimension: int,
    out: F32,
) -> None:
    """Numbers in [0, 1) by pixel, sample and dimension."""
    for i in range(pixel.shape[0]):
        out[i] = sample_1d(np.uint32(seed), pixel[i], sample[i], np.uint32(dimension))


@kernel
def group_keys(paths: NDArray[Any], owner: I32, materials: int, depths: int, keys: I32) -> None:
    """What Python answers together: status, depth and material as one number."""
    for i in range(paths.shape[0]):
        path = paths[i]
        material = owner[path.triangle] if path.status <= CANDIDATE else 0
        depth = min(int(path.depth), depths - 1)
        keys[i] = (path.status * depths + depth) * materials + material


@kernel
def unpack(
    paths: NDArray[Any],
    order: NDArray[np.int64],
    vectors: F32,
    numbers: F32,
    keys: NDArray[np.uint32],
    triangle: I32,
) -> None:
    """The paths that ``order`` lists, as arrays: ``vectors`` (2, n, 3) origin and direction,
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
def pass_all(scenes: Any, paths: NDArray[Any]) -> None:
    """Send paths on behind their ignored hits."""
    for i in range(paths.shape[0]):
        pass_hit(scenes[0], paths[i])


@kernel
def scatter(
    radiance: F32,
    paths: NDArray[Any],
    order: NDArray[np.int64],
    values: F32,
    visible: bool,
    bad: NDArray[np.int64],
) -> None:
    """Add what a program returned for the paths of ``order``, weighted; ``visible``: its red is
    visibility.

    ``bad`` counts results that are not finite, and holds the first one's pixel.
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


@kernel
def sort_by(keys: I32, count: int, order: NDArray[np.int64], starts: NDArray[np.int64]) -> None:
    """A stable counting sort: ``order`` lists indices by key, ``starts`` (count + 1) where each
    key begins."""
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
def intersect(
    scenes: Any,
    origin: F32,
    direction: F32,
    tmax: F32,
    triangle: I32,
    u: F32,
    v: F32,
    t: F32,
) -> None:
    """Nearest hits; ``tmax`` has one entry, or one a ray."""
    ray = np.empty(RAY_FLOATS, np.float32)
    blank(ray.ctypes.data, 1)
    for i in range(origin.shape[0]):
        limit = float(tmax[i if tmax.shape[0] > 1 else 0])
        o, d = vector(origin, i), vector(direction, i)
        triangle[i] = -1
        if finite(o) and finite(d):
            triangle[i] = nearest(scenes[0], ray.ctypes.data, np.uint64(0), o, d, limit)
        if triangle[i] >= 0:
            t[i], u[i], v[i] = hit(ray.ctypes.data)


@kernel
def occluded(scenes: Any, origin: F32, direction: F32, tmax: F32, found: NDArray[np.bool_]) -> None:
    """Whether anything is hit."""
    ray = np.empty(RAY_FLOATS, np.float32)
    blank(ray.ctypes.data, 1)
    for i in range(origin.shape[0]):
        limit = float(tmax[i if tmax.shape[0] > 1 else 0])
        o, d = vector(origin, i), vector(direction, i)
        if finite(o) and finite(d):
            found[i] = blocked(scenes[0], ray.ctypes.data, np.uint64(0), o, d, limit)

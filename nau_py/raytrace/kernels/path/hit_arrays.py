"""Values of a batch of hits, computed for all hits at once, for programs written with NumPy."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.kernels.core.jit import kernel
from nau_py.raytrace.kernels.core.sampling import sample_1d
from nau_py.raytrace.kernels.core.vec import normalize
from nau_py.raytrace.kernels.geometry.surface import (
    face_forward,
    interpolate_attribute,
    interpolate_normal,
    locate_point,
    offset_origin,
)
from nau_py.raytrace.kernels.geometry.texture import filter_texture
from nau_py.raytrace.kernels.intersect.ray_arrays import read_vector

F32 = NDArray[np.float32]
I32 = NDArray[np.int32]


@kernel
def compute_surface_points(
    scenes: Any, triangle: I32, u: F32, v: F32, position: F32, face: F32, bound: F32
) -> None:
    """Compute positions, face normals and position error bounds of hits (n,)."""
    for i in range(triangle.shape[0]):
        p, n, b = locate_point(scenes[0], int(triangle[i]), float(u[i]), float(v[i]))
        bound[i] = b
        for k in range(3):
            position[i, k] = p[k]
            face[i, k] = n[k]


@kernel
def compute_shading_normals(
    scenes: Any, triangle: I32, u: F32, v: F32, face: F32, out: F32
) -> None:
    """Compute unit shading normals (n, 3): ``face`` where a vertex has no normal."""
    for i in range(triangle.shape[0]):
        n = interpolate_normal(
            scenes[0], int(triangle[i]), float(u[i]), float(v[i]), read_vector(face, i)
        )
        for k in range(3):
            out[i, k] = n[k]


@kernel
def orient_normals(normal: F32, direction: F32, out: F32) -> None:
    """Turn normals to the side from which the rays come."""
    for i in range(normal.shape[0]):
        n = face_forward(read_vector(normal, i), read_vector(direction, i))
        for k in range(3):
            out[i, k] = n[k]


@kernel
def interpolate_attributes(
    scenes: Any, address: int, triangle: I32, u: F32, v: F32, out: F32
) -> None:
    """Interpolate the vertex attribute at ``address``; ``out`` (n, k) takes k components."""
    for i in range(triangle.shape[0]):
        a = interpolate_attribute(address, scenes[0], int(triangle[i]), float(u[i]), float(v[i]))
        for k in range(out.shape[1]):
            out[i, k] = a[k]


@kernel
def sample_textures(textures: Any, texels: int, uv: F32, out: F32) -> None:
    """Sample a texture at coordinates (n, 2); ``out`` (n, 4) gets RGBA."""
    for i in range(uv.shape[0]):
        c = filter_texture(textures[0], texels, float(uv[i, 0]), float(uv[i, 1]))
        for k in range(4):
            out[i, k] = c[k]


@kernel
def spawn_rays(
    position: F32, face: F32, bound: F32, direction: F32, origin: F32, unit_direction: F32
) -> None:
    """Compute origins and unit directions of rays that leave surfaces."""
    for i in range(position.shape[0]):
        d = normalize(read_vector(direction, i))
        o = offset_origin(read_vector(position, i), read_vector(face, i), float(bound[i]), d)
        for k in range(3):
            origin[i, k] = o[k]
            unit_direction[i, k] = d[k]


@kernel
def spawn_chosen_rays(
    chosen: NDArray[np.int64],
    position: F32,
    face: F32,
    bound: F32,
    direction: F32,
    origin: F32,
    unit_direction: F32,
) -> None:
    """Do ``spawn_rays`` for the surfaces that ``chosen`` lists. ``direction`` has one row, or one a
    surface."""
    for k in range(chosen.shape[0]):
        i = chosen[k]
        d = normalize(read_vector(direction, i if direction.shape[0] > 1 else 0))
        o = offset_origin(read_vector(position, i), read_vector(face, i), float(bound[i]), d)
        for m in range(3):
            origin[k, m] = o[m]
            unit_direction[k, m] = d[m]


@kernel
def fill_uniforms(
    seed: int,
    pixel: NDArray[np.uint32],
    sample: NDArray[np.uint32],
    dimension: int,
    out: F32,
) -> None:
    """Fill ``out`` with random numbers in [0, 1), keyed by seed, pixel, sample and dimension."""
    for i in range(pixel.shape[0]):
        out[i] = sample_1d(np.uint32(seed), pixel[i], sample[i], np.uint32(dimension))

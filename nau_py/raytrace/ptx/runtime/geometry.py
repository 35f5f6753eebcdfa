"""Geometry that intersection and bounding box programs describe (OptiX 3 to 6).

Projects of Nau have one pair of programs, for triangles. If the pair describes exactly the
triangles of its index buffer, Embree's triangles find the candidates, and the program computes hit
and attributes of each. Otherwise the primitives are user geometry of Embree, with the boxes that
the bounding box program computes.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.ptx.runtime.launch import (
    TYPES,
    PtxLaunch,
    bind_host,
    make_frame,
    make_launch_block,
)
from nau_py.raytrace.ptx.runtime.native import NativeModule
from nau_py.raytrace.tracing.accelerator import CustomGeometry, TriangleGeometry, build_groups

TRIANGLES, CUSTOM = "triangles", "custom"
_PROBED = 64
"""Primitives of a group that are tested with rays."""
_INSIDE = ((1 / 3, 1 / 3), (0.1, 0.8), (0.6, 0.15))
_OUTSIDE = ((0.7, 0.7), (-0.2, 0.5), (0.5, -0.2))
"""Barycentric coordinates of the tested points in a triangle's plane."""
_CLOSE = 1e-3
"""Tolerance of a hit's distance, relative to the triangle's size."""
F64 = NDArray[np.float64]


@dataclass(slots=True)
class _GeometryProbe:
    """Programs of a group with a frame to run them in: arguments of the runtime's functions."""

    frame: NDArray[np.uint8]
    boxes: NDArray[np.uint64]
    intersect: NDArray[np.uint64]


def build_scene(
    native: NativeModule,
    launch: PtxLaunch,
    shapes: list[tuple[Any, Any]],
    records: list[NDArray[np.uint8]],
    intersect: int,
    bounds: int,
) -> tuple[int, list[str], object]:
    """Build Embree's structure over groups of primitives.

    ``shapes``: positions float32 (n, 4) and indices uint32 (3 m, 1) of each group; ``records``:
    their records with geometry written; ``intersect``, ``bounds``: addresses of the programs.
    Returns the handle, the kind of each group, and an object to keep with the handle.
    """
    rays = np.zeros(TYPES, np.uint64)
    mark = np.zeros(1, np.int64)
    block = make_launch_block(launch, rays, mark.ctypes.data)
    host = bind_host([native], [])
    working = launch.marks if launch.marks is not None else np.zeros(1, np.int64)
    working[0] = 0  # programs run from here on
    parts: list[TriangleGeometry | CustomGeometry] = []
    kinds: list[str] = []
    kept: list[object] = [host, block, rays, mark]
    for (positions, indices), record in zip(shapes, records):
        triangles = indices.reshape(-1, 3)
        probe = _make_probe(block, record, intersect, bounds)
        kept.append(probe)
        if not intersect or _describe_triangles(native, probe, positions, triangles, bounds):
            parts.append(TriangleGeometry(positions, triangles))
            kinds.append(TRIANGLES)
        else:
            user = probe.boxes.ctypes.data
            places = (native.address("nau.bounds"), native.address("nau.user"))
            parts.append(CustomGeometry(len(triangles), *places, user))
            kinds.append(CUSTOM)
    handle, structure = build_groups(parts) if parts else (0, None)
    working[0] = -1
    return handle, kinds, [structure, *kept]


def _make_probe(
    block: NDArray[np.uint8], record: NDArray[np.uint8], intersect: int, bounds: int
) -> _GeometryProbe:
    frame = make_frame(block, record)
    place = frame.ctypes.data
    return _GeometryProbe(
        frame, np.array([bounds, place], np.uint64), np.array([intersect, place], np.uint64)
    )


def _describe_triangles(
    native: NativeModule,
    probe: _GeometryProbe,
    positions: NDArray[np.float32],
    triangles: NDArray[np.uint32],
    bounds: int,
) -> bool:
    """Return True if each primitive is the triangle of its three indices.

    The boxes of all primitives and rays to some of them decide. A candidate too much costs time
    only, so a wrong True could lose hits outside of triangles, but no others.
    """
    corners = positions[triangles, :3]
    if bounds:
        boxes = np.zeros((len(triangles), 8), np.float32)
        run = ctypes.CFUNCTYPE(None, ctypes.c_uint64, ctypes.c_uint64, ctypes.c_uint64)(
            native.address("nau.boxes")
        )
        run(probe.boxes.ctypes.data, len(triangles), boxes.ctypes.data)
        low, high = boxes[:, 0:3], boxes[:, 4:7]
        empty = (low > high).any(axis=1)
        flat = np.linalg.norm(_compute_normals(corners.astype(np.float64)), axis=1) == 0
        same = (low == corners.min(axis=1)).all(axis=1) & (high == corners.max(axis=1)).all(axis=1)
        if not (same | (empty & flat)).all():
            return False
    step = max(len(triangles) // _PROBED, 1)
    return all(
        _probe_triangle(native, probe, index, corners[index])
        for index in range(0, len(triangles), step)
    )


def _compute_normals(corners: F64) -> F64:
    edges = corners[:, 1:] - corners[:, :1]
    return np.cross(edges[:, 0], edges[:, 1])


def _probe_triangle(
    native: NativeModule, probe: _GeometryProbe, primitive: int, corners: NDArray[np.float32]
) -> bool:
    """Return True if rays to a triangle's plane hit inside the triangle, and only there."""
    wide = corners.astype(np.float64)
    normal = _compute_normals(wide[None])[0]
    length = np.linalg.norm(normal)
    edges = wide[1:] - wide[0]
    size = float(np.abs(edges).max())
    if length < 1e-6 * size * size or size == 0:
        return True  # too thin: rounding decides
    run = ctypes.CFUNCTYPE(ctypes.c_float, ctypes.c_uint64, ctypes.c_uint32, ctypes.c_uint64)(
        native.address("nau.probe")
    )
    for inside, points in ((True, _INSIDE), (False, _OUTSIDE)):
        for a, b in points:
            point = wide[0] + a * edges[0] + b * edges[1]
            towards = -normal / length + 0.3 * edges[0] / size
            ray = np.zeros(8, np.float32)
            ray[0:3], ray[3] = point - size * towards, 1e-6 * size
            ray[4:7], ray[7] = towards, 1e27
            t = run(probe.intersect.ctypes.data, primitive, ray.ctypes.data)
            if inside != (t >= 0) or (inside and abs(t - size) > _CLOSE * size):
                return False
    return True

"""Geometry that intersection and bounding box programs describe (OptiX 3 to 6).

Nau's projects have one pair of programs, for triangles. Where such a pair says what Embree's own
triangles say, these find the candidates, and the program is asked at each for its hit and its
attributes; else its primitives are Embree's user geometry, with the boxes that the program gives.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.ptx.runtime.launch import TYPES, PtxLaunch, bind_host, block_of, frame_of
from nau_py.raytrace.ptx.runtime.native import NativeModule
from nau_py.raytrace.tracing.accelerator import CustomGeometry, TriangleGeometry, build_groups

TRIANGLES, CUSTOM = "triangles", "custom"
_PROBED = 64
"""Primitives of a group that are asked with rays."""
_INSIDE = ((1 / 3, 1 / 3), (0.1, 0.8), (0.6, 0.15))
_OUTSIDE = ((0.7, 0.7), (-0.2, 0.5), (0.5, -0.2))
"""Barycentrics of points in a triangle's plane."""
_CLOSE = 1e-3
F64 = NDArray[np.float64]


@dataclass(slots=True)
class _GeometryProbe:
    """A group's programs with a frame to run them in; ``user`` is what the runtime takes."""

    frame: NDArray[np.uint8]
    boxes: NDArray[np.uint64]
    probe: NDArray[np.uint64]


def build_scene(
    native: NativeModule,
    launch: PtxLaunch,
    shapes: list[tuple[Any, Any]],
    records: list[NDArray[np.uint8]],
    intersect: int,
    bounds: int,
) -> tuple[int, list[str], object]:
    """Embree's structure over groups: ``shapes`` are positions float32 (n, 4) and indices uint32
    (3 m, 1), ``records`` their records with geometry written, ``intersect`` and ``bounds`` the
    programs' addresses. Returns the handle, the kind of each group, and what must be kept."""
    rays = np.zeros(TYPES, np.uint64)
    mark = np.zeros(1, np.int64)
    block = block_of(launch, rays, mark.ctypes.data)
    host = bind_host([native], [])
    working = launch.marks if launch.marks is not None else np.zeros(1, np.int64)
    working[0] = 0  # they run from here on
    parts: list[TriangleGeometry | CustomGeometry] = []
    kinds: list[str] = []
    kept: list[object] = [host, block, rays, mark]
    for (positions, indices), record in zip(shapes, records):
        triangles = indices.reshape(-1, 3)
        asked = _asked(block, record, intersect, bounds)
        kept.append(asked)
        if not intersect or _standard(native, asked, positions, triangles, bounds):
            parts.append(TriangleGeometry(positions, triangles))
            kinds.append(TRIANGLES)
        else:
            user = asked.boxes.ctypes.data
            places = (native.address("nau.bounds"), native.address("nau.user"))
            parts.append(CustomGeometry(len(triangles), *places, user))
            kinds.append(CUSTOM)
    handle, structure = build_groups(parts) if parts else (0, None)
    working[0] = -1
    return handle, kinds, [structure, *kept]


def _asked(
    block: NDArray[np.uint8], record: NDArray[np.uint8], intersect: int, bounds: int
) -> _GeometryProbe:
    frame = frame_of(block, record)
    place = frame.ctypes.data
    return _GeometryProbe(
        frame, np.array([bounds, place], np.uint64), np.array([intersect, place], np.uint64)
    )


def _standard(
    native: NativeModule,
    asked: _GeometryProbe,
    positions: NDArray[np.float32],
    triangles: NDArray[np.uint32],
    bounds: int,
) -> bool:
    """Whether the programs say of every primitive that it is the triangle of its three indices:
    by their boxes, and by rays to some of them. Asking at a place that Embree finds too much costs
    time only; so nothing but hits outside of triangles could be lost."""
    corners = positions[triangles, :3]
    if bounds:
        boxes = np.zeros((len(triangles), 8), np.float32)
        run = ctypes.CFUNCTYPE(None, ctypes.c_uint64, ctypes.c_uint64, ctypes.c_uint64)(
            native.address("nau.boxes")
        )
        run(asked.boxes.ctypes.data, len(triangles), boxes.ctypes.data)
        low, high = boxes[:, 0:3], boxes[:, 4:7]
        empty = (low > high).any(axis=1)
        flat = np.linalg.norm(_normals(corners.astype(np.float64)), axis=1) == 0
        same = (low == corners.min(axis=1)).all(axis=1) & (high == corners.max(axis=1)).all(axis=1)
        if not (same | (empty & flat)).all():
            return False
    step = max(len(triangles) // _PROBED, 1)
    return all(
        _probed(native, asked, index, corners[index]) for index in range(0, len(triangles), step)
    )


def _normals(corners: F64) -> F64:
    edges = corners[:, 1:] - corners[:, :1]
    return np.cross(edges[:, 0], edges[:, 1])


def _probed(
    native: NativeModule, asked: _GeometryProbe, primitive: int, corners: NDArray[np.float32]
) -> bool:
    """Whether rays to a triangle's plane hit where they must, and only there."""
    wide = corners.astype(np.float64)
    normal = _normals(wide[None])[0]
    length = np.linalg.norm(normal)
    edges = wide[1:] - wide[0]
    size = float(np.abs(edges).max())
    if length < 1e-6 * size * size or size == 0:
        return True  # thin: rounding decides
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
            t = run(asked.probe.ctypes.data, primitive, ray.ctypes.data)
            if inside != (t >= 0) or (inside and abs(t - size) > _CLOSE * size):
                return False
    return True

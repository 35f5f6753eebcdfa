"""Embree behind one class; no other module imports embreex.

The library inside embreex's wheel is called through its C interface: compiled kernels trace rays
(``kernels/intersect/embree.py``) without a Python object in between, each with its own ``tmax``.
Scenes are always built as robust; in an empty scene every ray misses; Embree gets finite rays only.
"""

from __future__ import annotations

import ctypes
import os
import weakref
from collections.abc import Sequence
from ctypes import c_char_p, c_int, c_size_t, c_ssize_t, c_uint, c_void_p
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import embreex
import llvmlite.binding
import numpy as np
from numpy.typing import NDArray

from nau_py.diagnostics.diagnostic import error
from nau_py.diagnostics.errors import DeviceError
from nau_py.diagnostics.location import NOWHERE
from nau_py.diagnostics.suggest import suggest_name
from nau_py.raytrace.kernels.core.tables import SCENE
from nau_py.raytrace.kernels.intersect.ray_arrays import find_occluded_rays, intersect_rays
from nau_py.raytrace.tracing.arrays import F32, Mask
from nau_py.raytrace.tracing.geometry import RayGeometry

NO_HIT = -1
_VERSION_PROPERTY = 0  # RTC_DEVICE_PROPERTY_VERSION of rtcore_device.h
_RAY8_PROPERTY, _RAY16_PROPERTY = 33, 34  # RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED, …RAY16…
ISA_VARIABLE = "NAU_EMBREE_ISA"
"""Environment variable that holds Embree to an instruction set (docs/performance.md)."""
ISA_NAMES = ("sse4.2", "avx", "avx2", "avx512")
_TRIANGLES, _USER = 0, 120  # rtcore_geometry.h
_INDEX, _VERTEX = 0, 1  # rtcore_buffer.h
_UINT3, _FLOAT3 = 0x5003, 0x9003  # rtcore_common.h
_ROBUST, _FILTER = 1 << 2, 1 << 3  # RTC_SCENE_FLAG_ROBUST, …_FILTER_FUNCTION_IN_ARGUMENTS
_FUNCTIONS: dict[str, tuple[Any, list[Any]]] = {
    "rtcNewDevice": (c_void_p, [c_char_p]),
    "rtcGetDeviceProperty": (c_ssize_t, [c_void_p, c_int]),
    "rtcGetDeviceError": (c_int, [c_void_p]),
    "rtcNewScene": (c_void_p, [c_void_p]),
    "rtcReleaseScene": (None, [c_void_p]),
    "rtcSetSceneFlags": (None, [c_void_p, c_int]),
    "rtcNewGeometry": (c_void_p, [c_void_p, c_int]),
    "rtcReleaseGeometry": (None, [c_void_p]),
    "rtcSetSharedGeometryBuffer": (
        None,
        [c_void_p, c_int, c_uint, c_int, c_void_p, c_size_t, c_size_t, c_size_t],
    ),
    "rtcSetGeometryUserPrimitiveCount": (None, [c_void_p, c_uint]),
    "rtcSetGeometryUserData": (None, [c_void_p, c_void_p]),
    "rtcSetGeometryBoundsFunction": (None, [c_void_p, c_void_p, c_void_p]),
    "rtcSetGeometryIntersectFunction": (None, [c_void_p, c_void_p]),
    "rtcCommitGeometry": (None, [c_void_p]),
    "rtcAttachGeometry": (c_uint, [c_void_p, c_void_p]),
    "rtcCommitScene": (None, [c_void_p]),
}


@lru_cache(maxsize=1)
def _load_library() -> ctypes.CDLL:
    """Load Embree and make its symbols known to compiled kernels."""
    package = Path(embreex.__file__).parent
    found = [*sorted((package.parent / "embreex.libs").glob("libembree*"))]
    found += [p for p in sorted(package.rglob("*embree4*")) if p.suffix in (".dll", ".dylib")]
    if not found:
        raise ImportError(f"the Embree library is not inside embreex at {package}")
    llvmlite.binding.load_library_permanently(str(found[0]))
    library = ctypes.CDLL(str(found[0]))
    for name, (result, arguments) in _FUNCTIONS.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    return library


def load_embree() -> None:
    """Make Embree's symbols known to compiled code."""
    _load_library()


def read_isa_limit() -> str:
    """Return the instruction set that ``NAU_EMBREE_ISA`` holds Embree to; empty for the best one.

    Raises :class:`~nau_py.DeviceError` for a name that Embree does not have.
    """
    name = os.environ.get(ISA_VARIABLE, "").strip().lower()
    if name and name not in ISA_NAMES:
        message = f"{ISA_VARIABLE} is '{name}'; one of {', '.join(ISA_NAMES)} is expected"
        raise DeviceError(error("D102", NOWHERE, message + suggest_name(name, list(ISA_NAMES))))
    return name


@lru_cache(maxsize=1)
def _open_device() -> int:
    """Return the handle of the process's Embree device.

    Raises :class:`~nau_py.DeviceError` where the processor lacks the instruction set asked for.
    """
    limit = read_isa_limit()
    found = _load_library().rtcNewDevice(f"isa={limit}".encode() if limit else None)
    if not found:
        message = f"this processor cannot run Embree with the instruction set '{limit or 'best'}'"
        raise DeviceError(error("D102", NOWHERE, message))
    return int(found)


def embree_isa() -> str:
    """Return the instruction set that Embree uses: ``avx512``, ``avx`` (or AVX2), or ``sse``."""
    properties = _load_library().rtcGetDeviceProperty
    if properties(_open_device(), _RAY16_PROPERTY):
        return "avx512"
    return "avx" if properties(_open_device(), _RAY8_PROPERTY) else "sse"


def embree_version() -> str:
    """Return the version of the Embree library inside embreex's wheel."""
    number = int(_load_library().rtcGetDeviceProperty(_open_device(), _VERSION_PROPERTY))
    return f"{number // 10000}.{number // 100 % 100}.{number % 100}"


@dataclass(slots=True)
class TriangleGeometry:
    """Positions float32 (n, 3) or (n, 4) and triangles uint32 (m, 3); Embree shares both arrays."""

    positions: F32
    triangles: NDArray[np.uint32]

    @property
    def count(self) -> int:
        """Number of triangles."""
        return len(self.triangles)

    def create(self, rtc: ctypes.CDLL, device: int) -> int:
        """Return a new RTCGeometry."""
        mesh = int(rtc.rtcNewGeometry(device, _TRIANGLES))
        for slot, kind, data in (
            (_VERTEX, _FLOAT3, self.positions),
            (_INDEX, _UINT3, self.triangles),
        ):
            place, stride, count = data.ctypes.data, data.strides[0], len(data)
            rtc.rtcSetSharedGeometryBuffer(mesh, slot, 0, kind, place, 0, stride, count)
        return mesh


@dataclass(slots=True)
class CustomGeometry:
    """Primitives described by functions: addresses of an ``RTCBoundsFunction``, of an
    ``RTCIntersectFunctionN``, and of their user data."""

    count: int
    bounds: int
    intersect: int
    user: int

    def create(self, rtc: ctypes.CDLL, device: int) -> int:
        """Return a new RTCGeometry."""
        made = int(rtc.rtcNewGeometry(device, _USER))
        rtc.rtcSetGeometryUserPrimitiveCount(made, self.count)
        rtc.rtcSetGeometryUserData(made, self.user)  # the bounds function gets nothing else
        rtc.rtcSetGeometryBoundsFunction(made, self.bounds, None)
        rtc.rtcSetGeometryIntersectFunction(made, self.intersect)
        return made


Parts = Sequence[TriangleGeometry | CustomGeometry]


@dataclass(eq=False)
class _SharedArrays:
    """Arrays that an Embree scene shares; they live as long as the scene."""

    parts: Parts


def _build_scene(parts: Parts, flags: int) -> tuple[int, _SharedArrays]:
    rtc, device = _load_library(), _open_device()
    scene = rtc.rtcNewScene(device)
    rtc.rtcSetSceneFlags(scene, flags)
    for part in parts:
        made = part.create(rtc, device)
        rtc.rtcCommitGeometry(made)
        rtc.rtcAttachGeometry(scene, made)
        rtc.rtcReleaseGeometry(made)
    rtc.rtcCommitScene(scene)
    if problem := rtc.rtcGetDeviceError(device):
        count = sum(part.count for part in parts)
        raise MemoryError(f"Embree could not build {count} primitives: error {problem}")
    kept = _SharedArrays(parts)
    weakref.finalize(kept, rtc.rtcReleaseScene, scene)
    return int(scene), kept


def build_groups(parts: Parts) -> tuple[int, object]:
    """Build an Embree scene with one geometry for each part. Return its handle, and the object to
    keep while the handle is used. Raises MemoryError if Embree fails."""
    return _build_scene(parts, _ROBUST | _FILTER)


@dataclass(slots=True)
class Intersections:
    """Closest hits of n rays: ``triangle`` int32 (n,), -1 for a miss; barycentrics ``u`` ``v`` of
    vertices 1 and 2; distance ``t`` in ray-direction lengths. float32 (n,)."""

    triangle: NDArray[np.int32]
    u: F32
    v: F32
    t: F32


class Accelerator:
    """Acceleration structures over the triangles of a :class:`RayGeometry`.

    Static and moving triangles form two Embree scenes, ``scene`` and ``moving``: handles for
    kernels, 0 for a scene without triangles. Positions are world space less the centre.
    """

    def __init__(self, geometry: RayGeometry) -> None:
        self.first_moving = geometry.first_moving
        self._kept: dict[str, _SharedArrays] = {}
        self.scene = self._build("scene", geometry, slice(0, geometry.first_moving))
        self.moving = 0
        self.rebuild_moving(geometry)

    def rebuild_moving(self, geometry: RayGeometry) -> None:
        """Rebuild the scene of moving triangles; ``geometry`` has the same triangles, moved."""
        self.moving = self._build("moving", geometry, slice(geometry.first_moving, None))

    def _build(self, name: str, geometry: RayGeometry, part: slice) -> int:
        triangles = np.ascontiguousarray(geometry.triangles[part], np.uint32)
        if not len(triangles):
            return 0
        vertices = np.zeros((len(geometry.vertices) + 1, 3), np.float32)  # Embree reads 16 bytes
        vertices[:-1] = geometry.vertices
        scene, self._kept[name] = _build_scene(
            [TriangleGeometry(vertices[:-1], triangles)], _ROBUST
        )
        return scene

    def _make_record(self) -> NDArray[Any]:
        record = np.zeros(1, SCENE.dtype)
        record["standing"], record["moving"] = self.scene, self.moving
        record["first_moving"] = self.first_moving
        return record

    def intersect(self, origin: F32, direction: F32, tmax: F32 | None = None) -> Intersections:
        """Return the closest hits of float32 (n, 3) rays; ``tmax`` float32 (n,). Rays that are not
        finite hit nothing."""
        n = len(origin)
        found = Intersections(np.empty(n, np.int32), *np.zeros((3, n), np.float32))
        limit = np.array([np.inf] if tmax is None else tmax, np.float32)
        o, d = np.ascontiguousarray(origin, "f4"), np.ascontiguousarray(direction, "f4")
        intersect_rays(self._make_record(), o, d, limit, found.triangle, found.u, found.v, found.t)
        return found

    def find_occluded(self, origin: F32, direction: F32, tmax: F32 | None = None) -> Mask:
        """Test if rays hit anything before ``tmax``, bool (n,)."""
        limit = np.array([np.inf] if tmax is None else tmax, np.float32)
        o, d = np.ascontiguousarray(origin, "f4"), np.ascontiguousarray(direction, "f4")
        found = np.zeros(len(o), bool)
        find_occluded_rays(self._make_record(), o, d, limit, found)
        return found

"""Embree behind one class; nobody else imports embreex.

embreex's edges are covered here: always robust, never a ray that is not finite, occlusion without
its broken ``output``, and an empty scene that answers with misses.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import embreex
import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from numpy.typing import NDArray

from nau_py.raytrace.geometry import RayGeometry
from nau_py.raytrace.vectors import F32, Mask

NO_HIT = -1
_VERSION_PROPERTY = 0  # RTC_DEVICE_PROPERTY_VERSION of rtcore_device.h


def embree_version() -> str:
    """The version of the Embree library inside embreex's wheel; ``4`` where it does not say."""
    folder = Path(embreex.__file__).parent.parent / "embreex.libs"
    for file in sorted(folder.glob("libembree*")):
        library = ctypes.CDLL(str(file))
        library.rtcNewDevice.restype = ctypes.c_void_p
        library.rtcGetDeviceProperty.restype = ctypes.c_ssize_t
        library.rtcGetDeviceProperty.argtypes = [ctypes.c_void_p, ctypes.c_int]
        library.rtcReleaseDevice.argtypes = [ctypes.c_void_p]
        device = library.rtcNewDevice(None)
        number = int(library.rtcGetDeviceProperty(device, _VERSION_PROPERTY))
        library.rtcReleaseDevice(device)
        return f"{number // 10000}.{number // 100 % 100}.{number % 100}"
    return "4"


@dataclass(slots=True)
class Intersections:
    """Nearest hits of n rays: ``triangle`` int32 (n,), -1 for a miss; barycentrics ``u`` ``v`` of
    vertices 1 and 2; distance ``t`` in ray-direction lengths. float32 (n,)."""

    triangle: NDArray[np.int32]
    u: F32
    v: F32
    t: F32


class Accelerator:
    """An acceleration structure over the triangles of a :class:`RayGeometry`."""

    def __init__(self, geometry: RayGeometry) -> None:
        self._scene: Any = None
        if len(geometry.triangles):
            self._scene = EmbreeScene(robust=True)
            TriangleMesh(self._scene, geometry.vertices, geometry.triangles)
            probe = np.zeros((1, 3), np.float32)
            self._scene.run(probe, np.ones((1, 3), np.float32))  # builds before threads come

    def intersect(self, origin: F32, direction: F32, tmax: F32 | None = None) -> Intersections:
        """Nearest hits of float32 (n, 3) rays, finite ones only; ``tmax`` float32 (n,)."""
        count = len(origin)
        if self._scene is None or not count:
            zero = np.zeros(count, np.float32)
            return Intersections(np.full(count, NO_HIT, np.int32), zero, zero, zero)
        found = self._scene.run(
            np.ascontiguousarray(origin, np.float32),
            np.ascontiguousarray(direction, np.float32),
            dists=None if tmax is None else np.array(tmax, np.float32),
            output=True,
        )
        return Intersections(found["primID"], found["u"], found["v"], found["tfar"])

    def occluded(self, origin: F32, direction: F32, tmax: F32 | None = None) -> Mask:
        """Whether anything is hit, bool (n,)."""
        if self._scene is None or not len(origin):
            return np.zeros(len(origin), bool)
        found = self._scene.run(
            np.ascontiguousarray(origin, np.float32),
            np.ascontiguousarray(direction, np.float32),
            dists=None if tmax is None else np.array(tmax, np.float32),
            query="OCCLUDED",
        )
        return np.asarray(found != NO_HIT)

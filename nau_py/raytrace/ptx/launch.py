"""Launches of compiled programs: records to the byte, and launch indices over threads.

Records, order and parameters are those of Nau's class ``rt`` (nau-format.md, 7.1).
"""

from __future__ import annotations

import ctypes
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.accel import build_groups
from nau_py.raytrace.kernels.sampler import TEXTURE, sampler
from nau_py.raytrace.ptx.compile import PARAMETERS
from nau_py.raytrace.ptx.native import Native
from nau_py.raytrace.ptx.optix7 import LAUNCH, LAUNCH_BYTES

F32 = NDArray[np.float32]
TRACE_DEPTH = 20
"""The most that rays may start rays, as Nau sets it."""
RECORD = np.dtype(
    [
        ("closest", "u8"),
        ("any", "u8"),
        ("indices", "u8"),
        ("position", "u8"),
        ("normal", "u8"),
        ("texCoord0", "u8"),
        ("tangent", "u8"),
        ("bitangent", "u8"),
        ("has_texture", "i4"),
        ("pad", "i4"),
        ("texture", "u8"),
        ("diffuse", "f4", 3),
        ("specular", "f4", 3),
        ("emission", "f4", 3),
        ("shininess", "f4"),
        ("end", "u8"),
    ]
)
"""A record: the programs, then the data that Nau's programs see, 112 bytes."""
assert RECORD.itemsize == 128
_TYPES = 16
"""Ray types that are counted by themselves."""
_TILE = 4096
"""Launch indices that a thread takes at a time."""


@dataclass(slots=True)
class Image:
    """A texture: uint8 (h, w, c), read between texels; or float32 (d, h, w, c), by the nearest."""

    texels: NDArray[np.uint8] | F32
    record: NDArray[np.void] = field(init=False)

    def __post_init__(self) -> None:
        texels: NDArray[Any] = np.ascontiguousarray(self.texels)
        self.texels = texels
        shape = texels.shape if texels.ndim == 4 else (1, *texels.shape)
        self.record = np.zeros(1, TEXTURE)
        self.record["texels"] = texels.ctypes.data
        self.record["depth"], self.record["height"], self.record["width"] = shape[:3]
        self.record["channels"], self.record["linear"] = shape[3], texels.dtype == np.uint8
        self.record["dimensions"] = texels.ndim - 1

    @property
    def handle(self) -> int:
        return int(self.record.ctypes.data)


@dataclass(slots=True)
class Group:
    """The triangles of one material of one object: ``attributes`` float32 (n, 4), by Nau's names;
    ``triangles`` uint32 (m, 3)."""

    material: str
    attributes: dict[str, F32]
    triangles: NDArray[np.uint32]


@dataclass(slots=True)
class Surface:
    """What a material gives to its records."""

    diffuse: tuple[float, ...] = (0.0, 0.0, 0.0)
    specular: tuple[float, ...] = (0.0, 0.0, 0.0)
    emission: tuple[float, ...] = (0.0, 0.0, 0.0)
    shininess: float = 0.0
    image: Image | None = None


class Scene:
    """Groups in the order of their records, with Embree's structure over them."""

    def __init__(self, groups: list[Group]) -> None:
        self.groups = groups
        self.handle = 0
        self._kept: object = None
        if groups:
            parts = [(g.attributes["position"], g.triangles) for g in groups]
            self.handle, kept = build_groups(parts)
            self._kept = kept

    def records(
        self, programs: list[list[tuple[int, int]]], surfaces: list[Surface], used: list[str]
    ) -> NDArray[np.void]:
        """The hit records: ``programs`` (closest hit, any hit) by group and ray type, addresses.
        ``used``: the vertex attributes that the pass asks for."""
        count = sum(len(p) for p in programs)
        found = np.zeros(max(count, 1), RECORD)
        at = 0
        for group, addresses, surface in zip(self.groups, programs, surfaces):
            for closest, any_ in addresses:
                record = found[at]
                record["closest"], record["any"] = closest, any_
                record["indices"] = group.triangles.ctypes.data
                for name in used:
                    if name in group.attributes and name in (RECORD.names or ()):
                        record[name] = group.attributes[name].ctypes.data
                record["diffuse"] = surface.diffuse[:3]
                record["specular"] = surface.specular[:3]
                record["emission"] = surface.emission[:3]
                record["shininess"] = surface.shininess
                if surface.image is not None:
                    record["has_texture"], record["texture"] = 1, surface.image.handle
                at += 1
        return found


def fill(native: Native, parameters: bytes) -> None:
    """Write the launch parameters of a module, where it has any, and its sampler."""
    place = native.variable("nau.sampler")
    ctypes.c_uint64.from_address(place).value = sampler().address
    place = native.variable(PARAMETERS)
    if place:
        ctypes.memmove(place, parameters, len(parameters))


def launch(
    generate: tuple[Native, int],
    scene: Scene,
    hits: NDArray[np.void],
    misses: NDArray[np.void],
    size: tuple[int, int],
    threads: int = 0,
    told: Callable[[int, int], None] = lambda done, total: None,
    flush: bool = True,
    marks: NDArray[np.int64] | None = None,
) -> NDArray[np.uint64]:
    """Run the ray generation program for every index of ``size`` (width, height); the numbers of
    rays that were traced, by ray type. ``flush``: denormals are zero. ``marks``: takes
    the launch indices in work, -1 for none. Results do not depend on the number of threads."""
    width, height = size
    total = width * height
    marks = np.full(1, -1, np.int64) if marks is None else marks
    workers = threads or os.cpu_count() or 1
    record = np.zeros(16, np.uint8)
    record[:4] = np.frombuffer(np.int32(255).tobytes(), np.uint8)
    native, program = generate
    run = ctypes.CFUNCTYPE(
        None, ctypes.c_uint64, ctypes.c_uint64, ctypes.c_uint64, ctypes.c_uint64
    )(native.address("nau.launch"))

    def part(begin: int) -> NDArray[np.uint64]:
        rays = np.zeros(_TYPES, np.uint64)
        slot = begin // _TILE % len(marks)
        block = np.zeros(LAUNCH_BYTES, np.uint8)
        values = {
            "scene": scene.handle,
            "hit_records": hits.ctypes.data,
            "miss_records": misses.ctypes.data,
            "width": width,
            "height": height,
            "layers": 1,
            "max_depth": TRACE_DEPTH,
            "hit_count": len(hits),
            "miss_count": len(misses),
            "rays": rays.ctypes.data,
            "raygen_record": record.ctypes.data,
            "flush": flush,
            "mark": marks.ctypes.data + 8 * slot,
        }
        for name, value in values.items():
            offset, type_ = LAUNCH[name]
            kind = np.uint64 if type_ == "u64" else np.uint32
            data = np.frombuffer(kind(value).tobytes(), np.uint8)
            block[offset : offset + len(data)] = data
        run(program, block.ctypes.data, begin, min(begin + _TILE, total))
        marks[slot] = -1
        return rays

    traced, done = np.zeros(_TYPES, np.uint64), 0
    with ThreadPoolExecutor(workers) as pool:
        jobs = [pool.submit(part, begin) for begin in range(0, total, _TILE)]
        try:
            for job in jobs:
                traced += job.result()
                done = min(done + _TILE, total)
                told(done, total)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return traced

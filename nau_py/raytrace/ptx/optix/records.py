"""Scenes and records of Nau's class ``rt``, to the byte (docs/format.md, 7.1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.kernels.geometry.cuda_texture import Image
from nau_py.raytrace.ptx.runtime.launch import record_table, set_program
from nau_py.raytrace.ptx.runtime.layout import RECORD_HEADER
from nau_py.raytrace.tracing.accelerator import TriangleGeometry, build_groups

F32 = NDArray[np.float32]
DATA = np.dtype(
    [
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
"""Data of a hit record, 112 bytes behind the header."""
assert DATA.itemsize == 112


@dataclass(slots=True)
class TriangleGroup:
    """Triangles of one material of one object.

    ``attributes``: float32 (n, 4) by Nau's names; ``triangles``: uint32 (m, 3).
    """

    material: str
    attributes: dict[str, F32]
    triangles: NDArray[np.uint32]


@dataclass(slots=True)
class RecordMaterial:
    """Colours and texture of a material in its records."""

    diffuse: tuple[float, ...] = (0.0, 0.0, 0.0)
    specular: tuple[float, ...] = (0.0, 0.0, 0.0)
    emission: tuple[float, ...] = (0.0, 0.0, 0.0)
    shininess: float = 0.0
    image: Image | None = None


class RtScene:
    """Triangle groups in the order of their records, with Embree's structure over them."""

    def __init__(self, groups: list[TriangleGroup]) -> None:
        self.groups = groups
        self.handle = 0
        self._kept: object = None
        if groups:
            parts = [TriangleGeometry(g.attributes["position"], g.triangles) for g in groups]
            self.handle, self._kept = build_groups(parts)

    def make_records(
        self, programs: list[list[tuple[int, int]]], surfaces: list[RecordMaterial], used: list[str]
    ) -> NDArray[np.uint8]:
        """Return the hit records, by group and ray type.

        ``programs``: addresses (closest hit, any hit) by group and ray type; ``surfaces``: material
        of each group; ``used``: vertex attributes that the pass requests.
        """
        table = record_table(sum(len(p) for p in programs), DATA.itemsize)
        at = 0
        for group, addresses, surface in zip(self.groups, programs, surfaces):
            data = np.zeros(1, DATA)
            record = data[0]
            record["indices"] = group.triangles.ctypes.data
            for name in used:
                if name in group.attributes and name in (DATA.names or ()):
                    record[name] = group.attributes[name].ctypes.data
            record["diffuse"] = surface.diffuse[:3]
            record["specular"] = surface.specular[:3]
            record["emission"] = surface.emission[:3]
            record["shininess"] = surface.shininess
            if surface.image is not None:
                record["has_texture"], record["texture"] = 1, surface.image.handle
            for closest, any_ in addresses:
                set_program(table[at], "closest", closest)
                set_program(table[at], "any", any_)
                table[at, RECORD_HEADER:] = data.view(np.uint8)
                at += 1
        return table

"""The triangles of a pass as one array, in world space, with what programs read at a hit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.vectors import F32
from nau_py.scene.mesh import SceneObject, transform_mesh

I32 = NDArray[np.int32]


@dataclass(slots=True)
class RayGeometry:
    """All triangles: ``vertices`` float32 (n, 3) and ``triangles`` int32 (m, 3), world space.

    ``material``: int32 (m,) index into ``materials``, the material group names. Attribute arrays
    are float32 (n, 4); a missing one is None.
    """

    vertices: F32
    triangles: I32
    material: I32
    materials: list[str]
    normal: F32 | None
    uv: F32 | None
    tangent: F32 | None


def _joined(parts: list[dict[str, Any]], counts: list[int], name: str) -> F32 | None:
    if not any(name in part for part in parts):
        return None
    return np.concatenate(
        [part.get(name, np.zeros((n, 4), np.float32)) for part, n in zip(parts, counts)]
    )


def gather(objects: list[SceneObject]) -> RayGeometry:
    """The triangles of ``objects`` with their transforms applied; other primitives are left out."""
    parts: list[dict[str, Any]] = []
    counts: list[int] = []
    triangles: list[I32] = []
    owners: list[I32] = []
    names: dict[str, int] = {}
    offset = 0
    for item in objects:
        if item.mesh.primitive != "TRIANGLES":
            continue
        mesh = item.mesh
        if not np.array_equal(item.matrix, np.eye(4)):
            mesh = transform_mesh(mesh, item.matrix)
        parts.append(mesh.attributes)
        counts.append(mesh.vertex_count)
        for group in mesh.groups:
            index = names.setdefault(group.material, len(names))
            triangles.append(group.indices.astype(np.int32) + np.int32(offset))
            owners.append(np.full(len(group.indices), index, np.int32))
        offset += mesh.vertex_count
    if not triangles:
        empty = np.zeros((0, 3), np.float32)
        none = np.zeros((0, 3), np.int32)
        return RayGeometry(empty, none, np.zeros(0, np.int32), [], None, None, None)
    vertices = np.concatenate([p["position"][:, :3] for p in parts])
    return RayGeometry(
        np.ascontiguousarray(vertices, np.float32),
        np.ascontiguousarray(np.concatenate(triangles)),
        np.concatenate(owners),
        list(names),
        _joined(parts, counts, "normal"),
        _joined(parts, counts, "texCoord0"),
        _joined(parts, counts, "tangent"),
    )

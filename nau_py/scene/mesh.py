"""Triangle meshes with named vertex attributes and material groups."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import product

import numpy as np
from numpy.typing import NDArray

from nau_py.scene.poses import PoseTrack

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
U32 = NDArray[np.uint32]


@dataclass(slots=True)
class Group:
    """The primitives of one material: ``indices`` has shape (m, 3) for triangles, (m, 2) lines."""

    material: str
    indices: U32


@dataclass(slots=True)
class Mesh:
    """``attributes`` maps names (docs/format.md, 8.4) to float32 arrays of shape (n, 4).

    Object space. Row i of every attribute belongs to vertex i.
    """

    attributes: dict[str, F32]
    groups: list[Group]
    primitive: str = "TRIANGLES"
    buffers: dict[str, str] = field(default_factory=dict)
    """Attributes (and ``index``) that live in GPU buffers, by qualified name; such a mesh has no
    vertices of its own."""
    adjacency: bool = False
    """Whether geometry shaders see each triangle's neighbours."""
    version: int = 0
    """Grows when positions change: animated meshes only."""
    poses: PoseTrack | None = None
    """Pose animation, which a copy of the mesh does not have."""

    @property
    def positions(self) -> F32:
        return self.attributes["position"]

    @property
    def vertex_count(self) -> int:
        return len(self.positions)

    @property
    def triangle_count(self) -> int:
        if self.primitive != "TRIANGLES":
            return 0
        return sum(len(group.indices) for group in self.groups)


@dataclass(slots=True)
class SceneObject:
    """A mesh with its object-to-world matrix, float64 (4, 4), column vectors."""

    name: str
    mesh: Mesh
    matrix: F64 = field(default_factory=lambda: np.eye(4))


def bounding_box(objects: Sequence[SceneObject]) -> tuple[F64, F64]:
    """The lowest and highest x, y, z, world space, of the boxes about the objects' meshes.

    Of no vertices at all it is the origin.
    """
    corners = []
    for item in objects:
        points = (
            item.mesh.positions[:, :3] if "position" in item.mesh.attributes else np.empty((0, 3))
        )
        if len(points):
            ends = np.stack([points.min(axis=0), points.max(axis=0)]).astype(np.float64)
            box = np.array([[*c, 1.0] for c in product(*ends.T)])
            corners.append((box @ item.matrix.T)[:, :3])
    if not corners:
        return np.zeros(3), np.zeros(3)
    found = np.concatenate(corners)
    return found.min(axis=0), found.max(axis=0)


def pad4(values: NDArray[np.floating], w: float) -> F32:
    """(n, 2 or 3) to float32 (n, 4): missing middle components 0, the last one ``w``."""
    result = np.zeros((len(values), 4), np.float32)
    result[:, : values.shape[1]] = values
    result[:, 3] = w
    return result


def transform_mesh(mesh: Mesh, matrix: F64) -> Mesh:
    """Bake ``matrix`` into a copy: positions, and normals by the inverse transpose.

    Tangents are left alone, as Nau does (docs/format.md, 13.4 #83).
    """
    attributes = dict(mesh.attributes)
    points = mesh.positions.astype(np.float64) @ matrix.T
    attributes["position"] = points.astype(np.float32)
    if "normal" in attributes:
        linear = matrix[:3, :3]
        inverse = np.linalg.inv(linear) if abs(np.linalg.det(linear)) > 1e-30 else linear
        normals = mesh.attributes["normal"][:, :3].astype(np.float64) @ inverse
        attributes["normal"] = pad4(normalized(normals), 0.0)
    return Mesh(attributes, mesh.groups, mesh.primitive, adjacency=mesh.adjacency)


def normalized(vectors: NDArray[np.floating]) -> F64:
    """Unit vectors, float64 (n, 3); zero vectors stay zero."""
    wide = vectors.astype(np.float64)
    length = np.linalg.norm(wide, axis=-1, keepdims=True)
    return wide / np.where(length > 0, length, 1.0)


def merge(meshes: list[Mesh]) -> Mesh:
    """One mesh of all: groups of equal material are joined, missing attributes filled with 0."""
    if len(meshes) == 1:
        return meshes[0]
    names = list(dict.fromkeys(name for mesh in meshes for name in mesh.attributes))
    attributes = {
        name: np.concatenate(
            [
                mesh.attributes.get(name, np.zeros((mesh.vertex_count, 4), np.float32))
                for mesh in meshes
            ]
        )
        for name in names
    }
    parts: dict[str, list[U32]] = {}
    offset = 0
    for mesh in meshes:
        if mesh.primitive == meshes[0].primitive:
            for group in mesh.groups:
                shifted = group.indices + np.uint32(offset)
                parts.setdefault(group.material, []).append(shifted)
        offset += mesh.vertex_count
    groups = [Group(name, np.concatenate(listed)) for name, listed in parts.items()]
    return Mesh(attributes, groups, meshes[0].primitive, adjacency=meshes[0].adjacency)


def triangle_tangents(positions: F32, uv: F32, triangles: U32) -> F32:
    """Per-vertex tangents along u, float32 (n, 4), w = 0; zero where uv is degenerate."""
    p = positions[:, :3].astype(np.float64)[triangles]
    t = uv[:, :2].astype(np.float64)[triangles]
    e1, e2 = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
    d1, d2 = t[:, 1] - t[:, 0], t[:, 2] - t[:, 0]
    det = d1[:, 0] * d2[:, 1] - d2[:, 0] * d1[:, 1]
    safe = np.where(np.abs(det) > 1e-20, det, np.inf)
    tangent = (e1 * d2[:, 1:2] - e2 * d1[:, 1:2]) / safe[:, None]
    total = np.zeros((len(positions), 3))
    for corner in range(3):
        for axis in range(3):
            total[:, axis] += np.bincount(
                triangles[:, corner], tangent[:, axis], minlength=len(positions)
            )
    return pad4(normalized(total), 0.0)

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
    """A mesh in object space.

    ``attributes`` maps names (docs/format.md, 8.4) to float32 arrays of shape (n, 4). Row i of each
    belongs to vertex i.
    """

    attributes: dict[str, F32]
    groups: list[Group]
    primitive: str = "TRIANGLES"
    buffers: dict[str, str] = field(default_factory=dict)
    """Qualified names of GPU buffers by attribute, and of ``index``. A mesh with buffers has no
    vertices of its own."""
    adjacency: bool = False
    """True if geometry shaders see the neighbours of each triangle."""
    version: int = 0
    """Number of changes of the positions, for animated meshes."""
    poses: PoseTrack | None = None
    """Pose animation. Copies of the mesh do not have it."""

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


def compute_bounding_box(objects: Sequence[SceneObject]) -> tuple[F64, F64]:
    """Compute the lowest and highest x, y, z, world space, of the boxes around the meshes.

    Without vertices both are the origin.
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
    """Pad (n, 2 or 3) to float32 (n, 4): missing middle components are 0, the last is ``w``."""
    result = np.zeros((len(values), 4), np.float32)
    result[:, : values.shape[1]] = values
    result[:, 3] = w
    return result


def transform_mesh(mesh: Mesh, matrix: F64) -> Mesh:
    """Bake ``matrix`` into a copy: positions, and normals by the inverse transpose.

    Tangents are not changed, as in Nau (docs/format.md, 13.4 #83).
    """
    attributes = dict(mesh.attributes)
    points = mesh.positions.astype(np.float64) @ matrix.T
    attributes["position"] = points.astype(np.float32)
    if "normal" in attributes:
        linear = matrix[:3, :3]
        inverse = np.linalg.inv(linear) if abs(np.linalg.det(linear)) > 1e-30 else linear
        normals = mesh.attributes["normal"][:, :3].astype(np.float64) @ inverse
        attributes["normal"] = pad4(normalize(normals), 0.0)
    return Mesh(attributes, mesh.groups, mesh.primitive, adjacency=mesh.adjacency)


def normalize(vectors: NDArray[np.floating]) -> F64:
    """Scale vectors to length 1, float64 (n, 3); zero vectors stay zero."""
    wide = vectors.astype(np.float64)
    length = np.linalg.norm(wide, axis=-1, keepdims=True)
    return wide / np.where(length > 0, length, 1.0)


def merge_meshes(meshes: list[Mesh]) -> Mesh:
    """Merge meshes: join groups of equal material, and fill missing attributes with 0."""
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


def compute_tangents(positions: F32, uv: F32, triangles: U32) -> F32:
    """Compute the tangents of vertices along u, float32 (n, 4), w = 0; zero for degenerate uv."""
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
    return pad4(normalize(total), 0.0)

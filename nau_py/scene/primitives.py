"""Nau's built-in primitives (docs/format.md, 10.7)."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from nau_py.scene.mesh import F32, F64, Group, Mesh, pad4
from nau_py.scene.readers.model_material import QUAD_MATERIAL

_AXIS_MATERIALS = ("__Emission Red", "__Emission Green", "__Emission Blue")


def _make_mesh(
    position: F32, normal: F32, uv: F32, tangent: F32, indices: object, material: str
) -> Mesh:
    attributes = {
        "position": pad4(position, 1.0),
        "normal": pad4(normal, 0.0),
        "texCoord0": pad4(uv, 0.0),
        "tangent": pad4(tangent, 1.0),
    }
    return Mesh(attributes, [Group(material, np.asarray(indices, np.uint32).reshape(-1, 3))])


def make_box(material: str) -> Mesh:
    """Make the cube -1..1 with 24 vertices, per-face normals and texture coordinates."""
    positions: list[F64] = []
    normals: list[F64] = []
    tangents: list[F64] = []
    uvs: list[tuple[int, int]] = []
    indices: list[int] = []
    for axis in range(3):
        for sign in (1.0, -1.0):
            normal = np.zeros(3)
            normal[axis] = sign
            up = np.eye(3)[1 if axis != 1 else 2] * (1.0 if axis != 1 else -sign)
            right = np.cross(up, normal)
            base = len(positions)
            for u, v in ((0, 0), (1, 0), (1, 1), (0, 1)):
                positions.append(normal + right * (2 * u - 1) + up * (2 * v - 1))
                normals.append(normal)
                uvs.append((u, v))
                tangents.append(right)
            indices += [base, base + 1, base + 2, base, base + 2, base + 3]
    arrays = [np.array(a, np.float32) for a in (positions, normals, uvs, tangents)]
    return _make_mesh(arrays[0], arrays[1], arrays[2], arrays[3], indices, material)


def make_square(material: str) -> Mesh:
    """Make the plane y = 0, x and z in -1..1, normal +y."""
    corners = np.array([(-1, -1), (-1, 1), (1, 1), (1, -1)], np.float32)
    position = np.stack([corners[:, 0], np.zeros(4), corners[:, 1]], axis=1).astype(np.float32)
    normal = np.tile(np.array([0, 1, 0], np.float32), (4, 1))
    tangent = np.tile(np.array([0, 0, -1], np.float32), (4, 1))
    return _make_mesh(
        position,
        normal,
        ((corners + 1) / 2).astype(np.float32),
        tangent,
        [0, 1, 2, 0, 2, 3],
        material,
    )


def make_sphere(slices: int, stacks: int, material: str) -> Mesh:
    """Make the unit sphere with (slices + 1)(stacks + 1) vertices."""
    i, j = np.meshgrid(np.arange(stacks + 1), np.arange(slices + 1), indexing="ij")
    b = (i / stacks - 0.5) * np.pi
    a = j / slices * 2 * np.pi
    position = np.stack([np.sin(a) * np.cos(b), np.sin(b), np.cos(a) * np.cos(b)], axis=-1)
    uv = np.stack([j / slices, i / stacks], axis=-1)
    tangent = np.stack([np.cos(a), np.zeros_like(a), -np.sin(a)], axis=-1)
    width = slices + 1
    corner = (np.arange(stacks)[:, None] * width + np.arange(slices)).reshape(-1)
    indices = np.stack(
        [corner, corner + 1, corner + width + 1, corner, corner + width + 1, corner + width], axis=1
    )
    flat = [x.reshape(-1, x.shape[-1]).astype(np.float32) for x in (position, uv, tangent)]
    return _make_mesh(flat[0], flat[0], flat[1], flat[2], indices, material)


def make_grid(divisions: int, length: float, material: str) -> Mesh:
    """Make a grid of (divisions + 1)² vertices in the xz plane, centred, of side ``length``."""
    rows, columns = np.meshgrid(np.arange(divisions + 1), np.arange(divisions + 1), indexing="ij")
    i, j = rows.reshape(-1), columns.reshape(-1)
    half = length / 2
    x, z = -half + i * length / divisions, half - j * length / divisions
    position = np.stack([x, np.zeros_like(x), z], axis=1).astype(np.float32)
    normal = np.tile(np.array([0, 1, 0], np.float32), (len(x), 1))
    tangent = np.tile(np.array([1, 0, 0], np.float32), (len(x), 1))
    uv = np.stack([i / divisions, j / divisions], axis=1).astype(np.float32)
    width = divisions + 1
    corner = (np.arange(divisions)[:, None] * width + np.arange(divisions)).reshape(-1)
    indices = np.stack(
        [corner, corner + width, corner + width + 1, corner, corner + width + 1, corner + 1], axis=1
    )
    return _make_mesh(position, normal, uv, tangent, indices, material)


def make_axis(material: str | None) -> Mesh:
    """Make three lines -1..1 along x, y and z; ``material`` replaces that of the first only."""
    names = (material or _AXIS_MATERIALS[0], *_AXIS_MATERIALS[1:])
    ends = np.array([sign * np.eye(3)[k] for k in range(3) for sign in (-1, 1)])
    groups = [
        Group(name, np.array([[2 * k, 2 * k + 1]], np.uint32)) for k, name in enumerate(names)
    ]
    return Mesh({"position": pad4(ends, 1.0)}, groups, "LINES")


@lru_cache(maxsize=1)
def make_quad() -> Mesh:
    """Make the quad of a quad pass: clip space, z = -1, uv 0..1 from the lower left, normals 0."""
    corners = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], np.float32)
    position = np.column_stack([corners * 2 - 1, np.full(4, -1.0)])
    attributes = {
        "position": pad4(position, 1.0),
        "normal": np.zeros((4, 4), np.float32),
        "texCoord0": pad4(corners, 0.0),
    }
    indices = np.array([[0, 1, 3], [1, 2, 3]], np.uint32)
    return Mesh(attributes, [Group(QUAD_MATERIAL, indices)])

"""The triangles of a pass in one array, relative to their centre, with vertex attributes."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.tracing.arrays import F32
from nau_py.scene.mesh import F64, SceneObject, transform_mesh

I32 = NDArray[np.int32]
PRECISION = 1e-4
"""Rounding of coordinates, relative to the smallest triangle, above which a warning is reported."""
FAR_FACTOR = 4.0
"""A scene is moved to the origin if its centre is farther away than this many half sizes."""


@dataclass(slots=True)
class DroppedFaces:
    """Faces left out, by reason, and the first of each: (object, face index)."""

    counts: dict[str, int] = field(default_factory=dict)
    first: dict[str, tuple[str, int]] = field(default_factory=dict)

    def add(self, reason: str, owner: str, faces: NDArray[np.bool_]) -> None:
        """Add the faces of object ``owner`` that are set in ``faces`` (n,)."""
        if faces.any():
            self.counts[reason] = self.counts.get(reason, 0) + int(faces.sum())
            self.first.setdefault(reason, (owner, int(np.argmax(faces))))


@dataclass
class RayGeometry:
    """All triangles: ``vertices`` float32 (n, 3) and ``triangles`` int32 (m, 3).

    World space less ``centre``, float64 (3,): zero unless the scene is far from the origin.
    ``material``: int32 (m,) index into ``materials``, the material group names; ``item``: int32
    (m,) index of the object among those with triangles. Attribute arrays are float32 (n, 4); a
    missing one is None. The last ``moving`` triangles belong to objects that move.
    """

    vertices: F32
    triangles: I32
    material: I32
    materials: list[str]
    normal: F32 | None = None
    uv: F32 | None = None
    tangent: F32 | None = None
    item: I32 = field(default_factory=lambda: np.zeros(0, np.int32))
    centre: F64 = field(default_factory=lambda: np.zeros(3))
    moving: int = 0
    dropped: DroppedFaces = field(default_factory=DroppedFaces)

    @property
    def first_moving(self) -> int:
        """Index of the first triangle that moves."""
        return len(self.triangles) - self.moving

    @cached_property
    def smooth(self) -> NDArray[np.bool_]:
        """Triangles whose vertex normals differ, bool (m,)."""
        if self.normal is None:
            return np.zeros(len(self.triangles), bool)
        a, b, c = (self.normal[self.triangles[:, k]] for k in range(3))
        return np.asarray(((a != b) | (a != c)).any(axis=1))


def _concatenate(parts: list[dict[str, Any]], counts: list[int], name: str) -> F32 | None:
    """Concatenate attribute ``name`` of all meshes, zero where a mesh has none; None without it."""
    if not any(name in part for part in parts):
        return None
    return np.concatenate(
        [part.get(name, np.zeros((n, 4), np.float32)) for part, n in zip(parts, counts)]
    )


def _find_valid(points: F64, faces: I32, owner: str, dropped: DroppedFaces) -> NDArray[np.bool_]:
    """Find the faces with an area and with coordinates that Embree accepts; drop the others."""
    a, b, c = (points[faces[:, k]] for k in range(3))
    with np.errstate(all="ignore"):
        finite = np.asarray(np.isfinite(a + b + c).all(axis=1))
        huge = finite & (np.abs(np.stack([a, b, c])).max(axis=(0, 2)) > HUGE)
        none = np.asarray((np.cross(b - a, c - a) == 0).all(axis=1) & finite)
    dropped.add("not finite", owner, ~finite)
    dropped.add("too large", owner, huge)
    dropped.add("without area", owner, none)
    return np.asarray(finite & ~huge & ~none)


HUGE = 1.844e18
"""Largest coordinate that Embree accepts (its FLT_LARGE)."""


def _find_duplicates(vertices: F32, triangles: I32) -> NDArray[np.bool_]:
    """Find faces with the same three corners as a later face, in any order."""
    _, same = np.unique(vertices, axis=0, return_inverse=True)
    keys = np.sort(same.reshape(-1)[triangles], axis=1)[::-1]  # the last of equals is kept
    _, first = np.unique(keys, axis=0, return_index=True)
    repeated = np.ones(len(triangles), bool)
    repeated[len(triangles) - 1 - first] = False
    return repeated


def gather_triangles(
    objects: list[SceneObject], moving: Collection[str] = (), centre: F64 | None = None
) -> RayGeometry:
    """Gather the triangles of ``objects`` in world space; other primitives are left out.

    ``moving``: names of objects that move; ``centre``: origin of the result, chosen if None. Faces
    that no ray can hit well are left out and listed in ``dropped``: without area, not finite, too
    large, or the same as a later one.
    """
    objects = [o for o in objects if o.mesh.primitive == "TRIANGLES"]
    order = sorted(range(len(objects)), key=lambda k: objects[k].name in moving)
    parts: list[dict[str, Any]] = []
    counts: list[int] = []
    points: list[F64] = []
    triangles: list[I32] = []
    owners: list[I32] = []
    items: list[I32] = []
    names: dict[str, int] = {}
    dropped = DroppedFaces()
    offset, first_moving = 0, 0
    for number in order:
        item = objects[number]
        mesh = item.mesh
        wide = mesh.positions.astype(np.float64) @ item.matrix.T
        if not np.array_equal(item.matrix, np.eye(4)):
            mesh = transform_mesh(mesh, item.matrix)
        parts.append(mesh.attributes)
        counts.append(mesh.vertex_count)
        points.append(wide[:, :3])
        for group in mesh.groups:
            faces = group.indices.astype(np.int32).reshape(-1, 3)
            faces = faces[_find_valid(wide[:, :3], faces, item.name, dropped)]
            index = names.setdefault(group.material, len(names))
            triangles.append(faces + np.int32(offset))
            owners.append(np.full(len(faces), index, np.int32))
            items.append(np.full(len(faces), number, np.int32))
            if item.name not in moving:
                first_moving += len(faces)
        offset += mesh.vertex_count
    if not triangles:
        empty = np.zeros((0, 3), np.float32)
        none = np.zeros((0, 3), np.int32)
        zero = np.zeros(0, np.int32)
        return RayGeometry(empty, none, zero, [], dropped=dropped)
    everywhere = np.concatenate(points)
    faces = np.concatenate(triangles)
    centre = _choose_centre(everywhere, faces) if centre is None else centre
    with np.errstate(over="ignore"):
        vertices = (everywhere - centre).astype(np.float32)
    owner, item_of = np.concatenate(owners), np.concatenate(items)
    repeated = _find_duplicates(vertices, faces) if len(faces) else np.zeros(0, bool)
    if repeated.any():
        at = int(np.argmax(repeated))
        dropped.counts["the same as another"] = int(repeated.sum())
        dropped.first["the same as another"] = (objects[item_of[at]].name, at)
        first_moving -= int(repeated[:first_moving].sum())
        faces, owner, item_of = faces[~repeated], owner[~repeated], item_of[~repeated]
    return RayGeometry(
        vertices,
        np.ascontiguousarray(faces),
        owner,
        list(names),
        _concatenate(parts, counts, "normal"),
        _concatenate(parts, counts, "texCoord0"),
        _concatenate(parts, counts, "tangent"),
        item_of,
        centre,
        len(faces) - first_moving,
        dropped,
    )


def measure_precision(item: SceneObject) -> tuple[float, float]:
    """Return the float32 rounding of an object's largest coordinate, and the longest side of its
    smallest triangle with an area, object space."""
    if item.mesh.triangle_count == 0:
        return 0.0, 1.0
    points = item.mesh.positions[:, :3].astype(np.float64)
    faces = [g.indices.reshape(-1, 3) for g in item.mesh.groups if len(g.indices)]
    corners = points[np.concatenate(faces)]
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    sides = sides[np.isfinite(sides) & (sides > 0)]
    largest = np.abs(corners[np.isfinite(corners)]).max(initial=0.0)
    if not len(sides):
        return 0.0, 1.0
    return float(np.spacing(np.float32(largest))), float(sides.min())


def _choose_centre(points: F64, faces: I32) -> F64:
    """Return the origin for the scene: zero unless the scene is far from the world's origin."""
    if not len(faces):
        return np.zeros(3)
    used = points[np.unique(faces)]
    low, high = used.min(axis=0), used.max(axis=0)
    middle = low + (high - low) / 2
    half = float(np.max(high - low)) / 2
    far = float(np.abs(middle).max()) > FAR_FACTOR * half
    return middle if far else np.zeros(3)

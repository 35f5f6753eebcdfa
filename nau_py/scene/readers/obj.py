"""Wavefront OBJ by Nau's rules (docs/format.md, 10.2)."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from nau_py.scene.mesh import F32, U32, Group, Mesh, SceneObject, compute_tangents, pad4
from nau_py.scene.readers.model_error import ModelError
from nau_py.scene.readers.model_material import OBJ_MATERIAL, ModelMaterial
from nau_py.scene.readers.mtl import load_mtl, read_lines
from nau_py.scene.readers.obj_faces import I64, Counts, Triangles, read_faces
from nau_py.scene.readers.registry import Model
from nau_py.scene.smooth import compute_smooth_normals


@dataclass(slots=True)
class _Source:
    """Lines of an OBJ file by keyword, and the group and material of each face."""

    rows: dict[bytes, list[bytes]] = field(default_factory=lambda: {b"v": [], b"vn": [], b"vt": []})
    faces: list[bytes] = field(default_factory=list)
    numbers: list[int] = field(default_factory=list)
    counts: list[Counts] = field(default_factory=list)
    keys: list[tuple[str, str]] = field(default_factory=list)
    """(group, material) keys in order of use."""
    starts: list[int] = field(default_factory=list)
    """Index of the first face of each key."""
    libraries: list[str] = field(default_factory=list)

    def count(self) -> Counts:
        return len(self.rows[b"v"]), len(self.rows[b"vt"]), len(self.rows[b"vn"])

    def begin(self, group: str, material: str) -> None:
        self.keys.append((group, material))
        self.starts.append(len(self.faces))


def _parse_numbers(rows: list[bytes], width: int, what: str) -> NDArray[np.float64]:
    """Parse the first ``width`` numbers of each row, float64 (n, width); fill short rows with 0."""
    if not rows:
        return np.zeros((0, width))
    split = [row.split()[1:] for row in rows]
    if any(len(s) < width for s in split):
        split = [s + [b"0"] * (width - len(s)) for s in split]
    try:
        return np.array([s[:width] for s in split], dtype="S32").astype(np.float64)
    except ValueError as error:
        raise ModelError(f"a '{what}' line holds something that is not a number: {error}") from None


def _sort_lines(lines: list[bytes]) -> _Source:
    """Sort lines by their first letter, as Nau does."""
    source = _Source()
    group, material = "default", OBJ_MATERIAL
    source.begin(group, material)
    for number, line in enumerate(lines):
        stripped = line.lstrip()
        first = stripped[:1]
        if first == b"v":
            keyword = stripped.split(None, 1)[0]
            if keyword in source.rows:
                source.rows[keyword].append(stripped)
        elif first == b"f":
            source.counts.append(source.count())
            source.faces.append(stripped)
            source.numbers.append(number)
        elif first in (b"g", b"u", b"m"):
            words = stripped.decode("utf-8", "replace").split(None, 1)
            value = words[1].strip() if len(words) > 1 else ""
            if first == b"m":
                source.libraries.append(value)
                continue
            if first == b"g":
                group = value
            else:
                material = value
            source.begin(group, material)
    return source


def read_obj(path: Path) -> Model:
    """Read an OBJ file and its material libraries: one object, named after the file.

    Raises :class:`~nau_py.scene.readers.model_error.ModelError`.
    """
    mesh, materials = load_obj(path)
    return [SceneObject(str(path), mesh)], materials


def load_obj(path: Path) -> tuple[Mesh, list[ModelMaterial]]:
    """Load the mesh of an OBJ file and the materials of its MTL files.

    Groups are ordered by Nau's ``<group>-<material>`` keys in byte order and joined by material.
    Raises :class:`~nau_py.scene.readers.model_error.ModelError`.
    """
    source = _sort_lines(read_lines(path))
    materials = [m for name in source.libraries for m in load_mtl(path, name)]
    if not source.libraries:
        source.keys = [(group, OBJ_MATERIAL) for group, _ in source.keys]
    triangles = read_faces(source.faces, source.numbers, source.counts, source.count())
    if not len(triangles.corners):
        raise ModelError("holds no face")
    return _build_mesh(source, triangles), materials


def _build_mesh(source: _Source, faces: Triangles) -> Mesh:
    rows = source.rows
    v = _parse_numbers(rows[b"v"], 3, "v")
    vt = _parse_numbers(rows[b"vt"], 2, "vt")
    vn = _parse_numbers(rows[b"vn"], 3, "vn")
    flat = faces.corners.reshape(-1, 3)
    unique, inverse = _find_unique_corners(flat, (len(v), len(vt), len(vn)))
    triangles: U32 = inverse.reshape(-1, 3).astype(np.uint32)
    attributes: dict[str, F32] = {"position": pad4(v[unique[:, 0]], 1.0)}
    if len(vn):
        normals = np.vstack([vn, np.zeros((1, 3))])[unique[:, 2]]
        attributes["normal"] = pad4(normals, 0.0)
    else:
        corner_normals = compute_smooth_normals(v, faces.corners[:, :, 0])
        keyed = np.column_stack(
            [unique[inverse], (np.round(corner_normals, 5) + 0.0).view(np.int64)]
        )
        _, first, again = np.unique(keyed, axis=0, return_index=True, return_inverse=True)
        unique = unique[inverse][first]
        triangles = again.reshape(-1, 3).astype(np.uint32)
        attributes = {
            "position": pad4(v[unique[:, 0]], 1.0),
            "normal": pad4(corner_normals[first], 0.0),
        }
    if len(vt):
        uv = np.vstack([vt, np.zeros((1, 2))])[unique[:, 1]]
        attributes["texCoord0"] = pad4(uv, 0.0)
        attributes["tangent"] = compute_tangents(
            attributes["position"], attributes["texCoord0"], triangles
        )
    return Mesh(attributes, _group_triangles(source, faces, triangles))


def _find_unique_corners(flat: I64, counts: tuple[int, int, int]) -> tuple[I64, I64]:
    """Find the distinct (v, vt, vn) triples, in order of first use, and that of each corner."""
    key = (flat[:, 0] * (counts[1] + 1) + flat[:, 1] + 1) * (counts[2] + 1) + flat[:, 2] + 1
    _, first, inverse = np.unique(key, return_index=True, return_inverse=True)
    order = np.argsort(first, kind="stable")
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    return flat[first[order]], rank[inverse]


def _group_triangles(source: _Source, faces: Triangles, triangles: U32) -> list[Group]:
    """Group triangles by material: keys in byte order, groups of one material joined."""
    key_of = np.searchsorted(np.array(source.starts), faces.face, side="right") - 1
    by_key: dict[tuple[str, str], list[int]] = {}
    for index in np.unique(key_of):
        by_key.setdefault(source.keys[index], []).append(int(index))
    parts: dict[str, list[U32]] = {}
    for key in sorted(by_key, key=lambda k: f"{k[0]}-{k[1]}".encode()):
        parts.setdefault(key[1], []).append(triangles[np.isin(key_of, by_key[key])])
    return [Group(name, np.concatenate(listed)) for name, listed in parts.items()]

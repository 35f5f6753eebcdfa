"""A mesh reader: ``.tri``, nine numbers a line, the corners of a triangle."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from nau_py.plugin import Group, Mesh, ModelError, ModelMaterial, SceneObject, pad4

MATERIAL = "Tri"


def read(path: Path) -> tuple[list[SceneObject], list[ModelMaterial]]:
    """One object, flat shaded, of one material."""
    corners = []
    for number, line in enumerate(path.read_text().splitlines(), 1):
        words = line.split()
        if not words or line.startswith("#"):
            continue
        try:
            corners.append(np.array([float(w) for w in words]).reshape(3, 3))
        except ValueError:
            raise ModelError(f"line {number}: nine numbers are expected: '{line}'") from None
    if not corners:
        raise ModelError("it has no triangles")
    points = np.array(corners)
    normals = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    mesh = Mesh(
        {
            "position": pad4(points.reshape(-1, 3), 1.0),
            "normal": pad4(np.repeat(normals, 3, axis=0), 0.0),
        },
        [Group(MATERIAL, np.arange(3 * len(points), dtype=np.uint32).reshape(-1, 3))],
    )
    material = ModelMaterial(MATERIAL, {"DIFFUSE": (0.9, 0.5, 0.2, 1.0)})
    return [SceneObject(path.stem, mesh)], [material]

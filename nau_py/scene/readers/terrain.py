"""Terrain: a vertex for each pixel of a height map (docs/format.md, 10.7)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from nau_py.scene.images import ImageError, load_image
from nau_py.scene.mesh import Group, Mesh, normalize, pad4
from nau_py.scene.readers.model_error import ModelError

LUMINANCE = np.array([0.212671, 0.715160, 0.072169])
"""Weights of red, green and blue in DevIL, which Nau loads images with."""


def load_terrain(path: Path, material: str) -> Mesh:
    """Load a grid in the xz plane, one unit per pixel, as high as the luminance, 0..1.

    Raises :class:`~nau_py.scene.readers.model_error.ModelError`.
    """
    try:
        texels = load_image(path).astype(np.float64) / 255
    except ImageError as problem:
        raise ModelError(str(problem)) from None
    height = texels[..., :3] @ LUMINANCE if texels.shape[2] >= 3 else texels[..., 0]
    rows, columns = height.shape
    h, w = np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij")
    position = np.stack([w - columns / 2, height, h - rows / 2], axis=-1).reshape(-1, 3)
    uv = np.stack([h / columns, w / rows], axis=-1).reshape(-1, 2)
    across, along = np.zeros_like(height), np.zeros_like(height)
    across[:, 1:-1] = height[:, 2:] - height[:, :-2]
    along[1:-1] = height[2:] - height[:-2]
    normal = np.stack([-2 * across, np.full_like(height, 4.0), -2 * along], axis=-1)
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).reshape(-1)
    below = corner + columns
    faces = np.stack([corner, below, below + 1, corner, below + 1, corner + 1], axis=1)
    return Mesh(
        {
            "position": pad4(position, 1.0),
            "normal": pad4(normalize(normal.reshape(-1, 3)), 0.0),
            "texCoord0": pad4(uv, 0.0),
        },
        [Group(material, faces.reshape(-1, 3).astype(np.uint32))],
    )

"""Bézier patches as text (docs/format.md, 10.6), for programs with tessellation stages."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from nau_py.scene.mesh import Group, Mesh, SceneObject, pad4
from nau_py.scene.readers.model_error import ModelError
from nau_py.scene.readers.registry import Model

PATCH_MATERIAL = "__nauDefault"


def read_patch(path: Path) -> Model:
    """Read a patch file: one object, named after the file, without materials.

    Raises :class:`~nau_py.scene.readers.model_error.ModelError`.
    """
    return [SceneObject(str(path), load_patch(path))], []


def load_patch(path: Path) -> Mesh:
    """Load the control points; groups have (patches, points a patch) indices.

    Raises :class:`~nau_py.scene.readers.model_error.ModelError`.
    """
    try:
        words = [w for w in re.split(r"[\s,]+", path.read_text()) if w]
    except (OSError, UnicodeDecodeError) as problem:
        raise ModelError(str(problem)) from None
    try:
        size, patches, indexed = int(words[0]), int(words[1]), words[2] == "y"
        at = 3 + (size * patches if indexed else 0)
        indices = np.array(words[3:at] if indexed else [], np.int64)
        count = int(words[at])
        points = np.array(words[at + 1 : at + 1 + 3 * count], np.float64).reshape(-1, 3)
    except (ValueError, IndexError):
        raise ModelError("it holds something else than numbers, or ends early") from None
    if not indexed:
        indices = np.arange(size * patches)
    elif len(indices) and indices.min() == 1 and indices.max() == count:
        indices = indices - 1
    if len(points) != count or len(indices) != size * patches:
        raise ModelError(f"it ends early: {len(points)} of {count} points")
    if len(indices) and not 0 <= indices.min() <= indices.max() < count:
        raise ModelError(f"index {int(indices.max())} of {count} points")
    group = Group(PATCH_MATERIAL, indices.reshape(patches, size).astype(np.uint32))
    return Mesh({"position": pad4(points, 1.0)}, [group], "PATCHES")

"""Lines of a camera's frustum, the hidden scene of each camera (docs/format.md, 3.7)."""

from __future__ import annotations

import numpy as np

from nau_py.scene.camera import CameraState
from nau_py.scene.mesh import F32, Group, Mesh, pad4

FAR_MATERIAL, NEAR_MATERIAL = "__Emission Green", "__Emission Red"
_RIM = np.array([[0, 1], [1, 2], [2, 3], [3, 0]], np.uint32)
_SIDES = np.array([[0, 4], [1, 5], [2, 6], [3, 7]], np.uint32)


def compute_frustum_corners(camera: CameraState, aspect: float) -> F32:
    """Compute the corners of the near plane, then of the far plane, float32 (8, 4), camera space.

    Each plane begins with the upper left corner and goes clockwise.
    """
    v = camera.values
    corners = []
    for distance in (v["NEAR"], v["FAR"]):
        left, right, bottom, top = v["LEFT"], v["RIGHT"], v["BOTTOM"], v["TOP"]
        if not camera.ortho:
            width, height = camera.half_extent(aspect)
            left, right = -width * distance, width * distance
            bottom, top = -height * distance, height * distance
        corners += [(left, top, -distance), (right, top, -distance)]
        corners += [(right, bottom, -distance), (left, bottom, -distance)]
    return pad4(np.array(corners), 1.0)


def make_frustum_mesh(camera: CameraState, aspect: float) -> Mesh:
    """Make the lines: the near plane in one material, the rest in another."""
    far = Group(FAR_MATERIAL, np.concatenate([_SIDES, _RIM + 4]).astype(np.uint32))
    near = Group(NEAR_MATERIAL, _RIM)
    return Mesh({"position": compute_frustum_corners(camera, aspect)}, [far, near], "LINES")

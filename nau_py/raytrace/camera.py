"""Primary rays through the points that the rasteriser samples."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from nau_py.raytrace.vectors import F32
from nau_py.scene.camera import CameraState
from nau_py.scene.viewport import Rect

CameraRays = Callable[[F32, F32], tuple[F32, F32]]


def camera_rays(camera: CameraState, rect: Rect) -> CameraRays:
    """A function from image points, pixels from the lower left corner of the target, to rays.

    Pixel (i, j) is rasterised at (i + 0.5, j + 0.5). Origins lie on the near plane, so that rays
    see what the rasteriser does not clip; directions are unit vectors. Computed in float64,
    returned as float32 (n, 3), world space.
    """
    near = camera.values["NEAR"]
    forward, right, up = camera.forward, camera.right, camera.true_up
    half_width, half_height = camera.half_extent(rect.aspect)

    def perspective(x: F32, y: F32) -> tuple[F32, F32]:
        sx = ((x.astype(np.float64) - rect.x) / rect.width * 2 - 1) * half_width
        sy = ((y.astype(np.float64) - rect.y) / rect.height * 2 - 1) * half_height
        plane = forward + sx[:, None] * right + sy[:, None] * up
        length = np.sqrt(plane[:, 0] ** 2 + plane[:, 1] ** 2 + plane[:, 2] ** 2)
        origin = camera.position + plane * near
        return origin.astype(np.float32), (plane / length[:, None]).astype(np.float32)

    def orthographic(x: F32, y: F32) -> tuple[F32, F32]:
        v = camera.values
        u = (x.astype(np.float64) - rect.x) / rect.width
        w = (y.astype(np.float64) - rect.y) / rect.height
        across = v["LEFT"] + u * (v["RIGHT"] - v["LEFT"])
        along = v["BOTTOM"] + w * (v["TOP"] - v["BOTTOM"])
        origin = camera.position + forward * near + across[:, None] * right + along[:, None] * up
        direction = np.broadcast_to(forward, origin.shape)
        return origin.astype(np.float32), direction.astype(np.float32)

    return orthographic if camera.ortho else perspective

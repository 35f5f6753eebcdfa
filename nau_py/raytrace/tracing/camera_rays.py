"""The camera as kernels read it, and camera rays for programs written in Python."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.kernels.path import camera as kernel
from nau_py.raytrace.tracing.arrays import F32
from nau_py.scene.camera import CameraState
from nau_py.scene.mesh import F64
from nau_py.scene.viewport import Rect

CameraRays = Callable[[F32, F32], tuple[F32, F32]]
"""Image points (n,) in pixels to origins and unit directions, float32 (n, 3)."""


def encode_camera(camera: CameraState, rect: Rect, centre: F64 | None = None) -> NDArray[Any]:
    """Return the record of ``camera`` for the viewport ``rect``, relative to ``centre``, (1,)."""
    made = np.zeros(1, kernel.CAMERA)
    v = camera.values
    made["position"] = camera.position - (0.0 if centre is None else centre)
    made["forward"], made["right"], made["up"] = camera.forward, camera.right, camera.true_up
    if camera.ortho:
        low, high = np.array([v["LEFT"], v["BOTTOM"]]), np.array([v["RIGHT"], v["TOP"]])
    else:
        high = np.array(camera.half_extent(rect.aspect))
        low = -high
    step = (high - low) / [rect.width, rect.height]
    made["base"], made["step"] = low - np.array([rect.x, rect.y]) * step, step
    made["near"], made["ortho"] = v["NEAR"], camera.ortho
    made["aperture"] = v["APERTURE"]
    made["focus"] = v["FOCUS_DISTANCE"]
    return made


def make_camera_rays(camera: CameraState, rect: Rect, centre: F64 | None = None) -> CameraRays:
    """Return a function from image points, pixels from the target's lower left corner, to rays.

    Pixel (i, j) is rasterised at (i + 0.5, j + 0.5). Origins are on the near plane, so that rays
    meet what the rasteriser does not clip; directions are unit vectors. Computed in float64,
    returned as float32 (n, 3), world space less ``centre``.
    """
    record = encode_camera(camera, rect, centre)

    def rays(x: F32, y: F32) -> tuple[F32, F32]:
        origin = np.empty((len(x), 3), np.float32)
        direction = np.empty((len(x), 3), np.float32)
        kernel.compute_camera_rays(
            record, np.asarray(x, np.float64), np.asarray(y, np.float64), origin, direction
        )
        return origin, direction

    return rays

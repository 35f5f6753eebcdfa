"""Camera of a light that draws a depth map (docs/format.md, 4.4)."""

from __future__ import annotations

import numpy as np

from nau_py.scene.camera import CameraState
from nau_py.scene.lights import LightState
from nau_py.scene.mesh import F64


def compute_frustum_corners(camera: CameraState, aspect: float, near: float, far: float) -> F64:
    """Return the eight corners of a frustum between two distances, world space, (8, 3)."""
    corners = []
    for distance in (near, far):
        if camera.ortho:
            v = camera.values
            xs, ys = (v["LEFT"], v["RIGHT"]), (v["BOTTOM"], v["TOP"])
        else:
            half_width, half_height = camera.half_extent(aspect)
            xs = (-half_width * distance, half_width * distance)
            ys = (-half_height * distance, half_height * distance)
        centre = camera.position + camera.forward * distance
        corners += [centre + camera.right * x + camera.true_up * y for x in xs for y in ys]
    return np.array(corners)


def light_camera(name: str, light: LightState, corners: F64) -> CameraState:
    """Return the orthographic camera of ``light``, fitted to ``corners`` (world space, (8, 3))."""
    state = CameraState(name, light.vector("POSITION"), light.vector("DIRECTION"), ortho=True)
    seen = corners @ state.view_matrix()[:3, :3].T + state.view_matrix()[:3, 3]
    low, high = seen.min(axis=0), seen.max(axis=0)
    state.values = {
        "FOV": 60.0,
        "LEFT": low[0],
        "RIGHT": high[0],
        "BOTTOM": low[1],
        "TOP": high[1],
        "NEAR": -high[2],
        "FAR": -low[2],
    }
    return state

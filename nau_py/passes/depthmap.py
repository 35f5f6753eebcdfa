"""Class ``depthmap``: depth as the first light sees it (nau-format.md, 4.4)."""

from __future__ import annotations

import numpy as np

from nau_py.model.passes import Pass
from nau_py.passes.default import DefaultClass
from nau_py.passes.drawing import begin, draw_scenes
from nau_py.passes.frame import FrameContext, PassRecord
from nau_py.scene.camera import CameraState
from nau_py.scene.lights import LightState
from nau_py.scene.mesh import F64


def frustum_corners(camera: CameraState, aspect: float, near: float, far: float) -> F64:
    """The eight corners of a camera's frustum between two distances, world space (8, 3)."""
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
    """The orthographic camera of ``light``, fitted exactly to ``corners`` (world space)."""
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


class DepthmapClass(DefaultClass):
    """Rasterises scenes from the first light of the pass."""

    def execute(self, pass_: Pass, frame: FrameContext, record: PassRecord) -> None:
        from nau_py.raster.gl import GL

        eye = frame.world.camera(pass_.camera_name)
        aspect = (
            frame.session.camera_rects.get(eye.name) or frame.world.viewport(eye.viewport)
        ).aspect
        registry = frame.project.registry["PASS"]
        distances = [eye.values["NEAR"], eye.values["FAR"]]
        for index, attribute in enumerate(("FROM", "TO")):
            if attribute in registry:
                distances[index] = float(frame.project.value(pass_, "PASS", attribute)[0])
        name = f"{frame.session.pipeline}#{pass_.name}-LightCam"
        corners = frustum_corners(eye, aspect, *distances)
        lights = frame.lights(pass_) or [frame.world.light("__nauDefault")]
        camera = light_camera(name, lights[0], corners)
        frame.world.add_camera(camera)
        frame.camera = camera
        target = begin(pass_, frame, uses_camera=True)
        GL.glEnable(GL.GL_DEPTH_CLAMP)
        draw_scenes(pass_, frame, target, record)
        GL.glDisable(GL.GL_DEPTH_CLAMP)

"""Class ``depthmap``: depth as the first light sees it (docs/format.md, 4.4)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nau_py.model.passes import Pass
from nau_py.passes.default import DefaultClass

if TYPE_CHECKING:
    from nau_py.passes.frame import FrameContext, PassRecord


class DepthmapClass(DefaultClass):
    """Rasterises scenes from the first light of the pass."""

    def execute(self, pass_: Pass, frame: FrameContext, record: PassRecord) -> None:
        from nau_py.passes.drawing import begin, draw_scenes
        from nau_py.passes.light_camera import frustum_corners, light_camera
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

"""Class ``depthmap``: depth as the first light sees it (docs/format.md, 4.4)."""

from __future__ import annotations

from nau_py.model.passes import Pass
from nau_py.passes.default import DefaultClass
from nau_py.passes.drawing import begin_drawing, draw_scenes
from nau_py.passes.frame import FrameContext
from nau_py.passes.light_camera import frustum_corners, light_camera
from nau_py.passes.report import PassReport


class DepthmapClass(DefaultClass):
    """Rasterises scenes from the first light of the pass."""

    def execute(self, pass_: Pass, frame: FrameContext) -> PassReport:
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
        view = begin_drawing(pass_, frame, camera)
        draw_scenes(pass_, frame, view, depth_clamp=True)
        return PassReport(pixels=view.pixels)

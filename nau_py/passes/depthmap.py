"""Class ``depthmap``: draw depth from the first light (docs/format.md, 4.4)."""

from __future__ import annotations

from collections.abc import Iterator

from nau_py.diagnostics.diagnostic import Diagnostic, error
from nau_py.model.linked import Project
from nau_py.model.passes import Pass
from nau_py.passes.default import DefaultClass
from nau_py.passes.drawing import begin_drawing, draw_scenes
from nau_py.passes.frame import FrameContext
from nau_py.passes.light_camera import compute_frustum_corners, light_camera
from nau_py.passes.registry import register_pass
from nau_py.passes.report import PassReport


@register_pass("depthmap", "depthmap2")
class DepthmapClass(DefaultClass):
    """Draws depth as the first light sees it."""

    def faults(self, project: Project, pass_: Pass) -> Iterator[Diagnostic]:
        """Yield the light and the target that class ``depthmap`` lacks."""
        if pass_.pass_class != "depthmap":
            return
        for tag, given in (("light", pass_.lights), ("renderTarget", pass_.renderTarget)):
            if not given:
                message = f"depthmap pass '{pass_.name}' needs a <{tag}>"
                yield error("P003", pass_.location, message)

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
        corners = compute_frustum_corners(eye, aspect, *distances)
        lights = frame.lights(pass_) or [frame.world.light("__nauDefault")]
        camera = light_camera(name, lights[0], corners)
        frame.world.add_camera(camera)
        view = begin_drawing(pass_, frame, camera)
        draw_scenes(pass_, frame, view, depth_clamp=True)
        return PassReport(pixels=view.pixels)

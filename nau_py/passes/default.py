"""Class ``default``: draw scenes with the mapped materials (docs/format.md, 4.4)."""

from __future__ import annotations

from nau_py.graph.contract import Access
from nau_py.model.linked import Project
from nau_py.model.passes import Pass
from nau_py.passes.access import add_commands, add_maps, add_process, add_target
from nau_py.passes.drawing import begin_drawing, draw_scenes
from nau_py.passes.frame import FrameContext
from nau_py.passes.registry import PassClass, register_pass
from nau_py.passes.report import PassReport


@register_pass("default")
class DefaultClass(PassClass):
    """Draws its scenes with the mapped materials."""

    def access(self, project: Project, pass_: Pass) -> Access:
        access = Access()
        add_maps(access, project, pass_)
        add_commands(access, pass_)
        add_process(access, pass_)
        add_target(access, project, pass_, clears=True)
        return access

    def execute(self, pass_: Pass, frame: FrameContext) -> PassReport:
        view = begin_drawing(pass_, frame, frame.world.camera(pass_.camera_name))
        draw_scenes(pass_, frame, view)
        return PassReport(pixels=view.pixels)

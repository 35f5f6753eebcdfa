"""Class ``default``: draws its scenes with the mapped materials (docs/format.md, 4.4)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nau_py.graph.contract import Access
from nau_py.model.linked import Project
from nau_py.model.passes import Pass
from nau_py.passes.access import add_commands, add_maps, add_process, add_target

if TYPE_CHECKING:
    from nau_py.passes.frame import FrameContext, PassRecord


class DefaultClass:
    """Rasterises scenes into the window or a render target."""

    def access(self, project: Project, pass_: Pass) -> Access:
        access = Access()
        add_maps(access, project, pass_)
        add_commands(access, pass_)
        add_process(access, pass_)
        add_target(access, project, pass_, clears=True)
        return access

    def execute(self, pass_: Pass, frame: FrameContext, record: PassRecord) -> None:
        from nau_py.passes.drawing import begin, draw_scenes

        frame.camera = frame.world.camera(pass_.camera_name)
        target = begin(pass_, frame, uses_camera=True)
        draw_scenes(pass_, frame, target, record)

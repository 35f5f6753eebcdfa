"""Class ``default``: draws its scenes with the mapped materials (nau-format.md, 4.4)."""

from __future__ import annotations

from nau_py.graph.contract import Access
from nau_py.model.linked import Project
from nau_py.model.passes import Pass
from nau_py.passes.access import add_maps, add_process, add_target
from nau_py.passes.drawing import begin, draw_context, note_pixels, process
from nau_py.passes.frame import FrameContext, PassRecord


class DefaultClass:
    """Rasterises scenes into the window or a render target."""

    def access(self, project: Project, pass_: Pass) -> Access:
        access = Access()
        add_maps(access, project, pass_)
        add_process(access, pass_)
        add_target(access, project, pass_, clears=True)
        return access

    def execute(self, pass_: Pass, frame: FrameContext, record: PassRecord) -> None:
        from nau_py.raster.draw import draw, draw_list

        frame.camera = frame.world.camera(pass_.camera_name)
        target = begin(pass_, frame, uses_camera=True)
        process(pass_.preProcess, frame)
        context = draw_context(
            pass_,
            frame,
            target,
            frame.camera.projection_matrix(frame.rect.aspect),
            frame.camera.view_matrix(),
            lights=True,
        )
        materials = frame.session.pass_materials(pass_)
        objects = frame.world.objects(pass_.scene_names)
        draw(draw_list(objects, materials.__getitem__), context)
        frame.session.resources.barrier()
        process(pass_.postProcess, frame)
        note_pixels(record, frame)

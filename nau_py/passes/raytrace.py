"""Class ``raytrace`` (``rt``, ``optix``): traces rays for the pixels that its mask selects."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nau_py.graph.contract import Access
from nau_py.model.linked import Project
from nau_py.model.passes import Pass
from nau_py.model.raytrace import RaytracePass
from nau_py.passes.access import add_process, texture

if TYPE_CHECKING:
    from nau_py.passes.frame import FrameContext, PassRecord


class RaytraceClass:
    """Traces rays through the programs of the pass."""

    def access(self, project: Project, pass_: Pass) -> Access:
        access = Access()
        if isinstance(pass_, RaytracePass):
            for source in pass_.rtInput:
                access.add_read(texture(source.texture, None))
        add_process(access, pass_)
        owner = project.target_of(pass_)
        if owner is not None and owner[1].colors:
            first = texture(owner[1].colors[0].name, owner[0])
            access.add_write(first)
            access.replaces.append(first)
        return access

    def execute(self, pass_: Pass, frame: FrameContext, record: PassRecord) -> None:
        from nau_py.passes.drawing import pass_value, process, target_and_rect
        from nau_py.passes.tracing import read_inputs, read_mask, store_colours, tracing_state
        from nau_py.raytrace.camera import camera_rays, camera_record
        from nau_py.raytrace.launch import LaunchSettings, Work, run_launch, select

        if not isinstance(pass_, RaytracePass) or pass_.rtEntryPoint is None:
            return
        frame.camera = frame.world.camera(pass_.camera_name)
        target, rect = target_and_rect(pass_, frame, uses_camera=True)
        frame.rect = rect
        process(pass_.preProcess, frame)
        state = tracing_state(pass_, frame.session)
        inputs = read_inputs(pass_, frame)
        mask = read_mask(pass_, inputs)
        width, height = target.width, target.height
        pixels = select(mask, width, height)
        scene = state.scene(pass_, frame, target, inputs)
        options = frame.session.options
        samples = options.samples or int(pass_value(frame.project, pass_, "RAYS_PER_PIXEL"))
        name = pass_.name or ""
        work = Work(
            scene,
            state.generate,
            state.exception,
            width,
            camera_record(frame.camera, rect, state.geometry.centre),
            camera_rays(frame.camera, rect),
            LaunchSettings(
                samples,
                options.threads,
                options.tile,
                str(pass_value(frame.project, pass_, "SAMPLER")),
            ),
            state.label,
        )
        progress = frame.session.progress
        result = run_launch(work, pixels, lambda done, total: progress(name, done, total))
        store_colours(target, pixels, result.colours)
        process(pass_.postProcess, frame)
        record.pixels = len(pixels)
        record.rays = dict(result.counts.rays)
        record.avoided = (width * height - len(pixels)) * samples
        record.est_error = result.est_error
        record.nonfinite = result.counts.nonfinite
        if result.counts.cut_layers:
            record.notes.append(
                f"{result.counts.cut_layers} rays met more ignored hits than the limit"
            )

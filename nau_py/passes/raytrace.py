"""Class ``raytrace`` (``rt``, ``optix``): traces rays for the pixels that its mask selects.

``execute`` has the steps of a frame, which are functions of ``passes/tracing/steps.py``:

1. select pixels: the texels of the mask with a weight above 0 (``raytrace/selection/``);
2. generate rays: a launch over the camera rays of these pixels (``raytrace/tracing/launch.py``,
   ``raytrace/kernels/path/camera.py``);
3. trace and shade: tiles over threads (``raytrace/tracing/dispatch.py``), each in compiled code
   that follows packets of paths (``raytrace/kernels/path/packet.py``) through Embree
   (``raytrace/kernels/intersect/embree.py``) to closest-hit programs
   (``raytrace/kernels/shading/closest_hit.py``);
4. estimate: means and errors of the samples (``raytrace/kernels/path/film.py``,
   ``raytrace/tracing/estimate.py``);
5. store: the colours in the render target, the clear value in all other pixels.

Passes whose programs are PTX take ``passes/ptx_launch.py`` instead, with the same selection.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.graph.contract import Access
from nau_py.model.attribute import choice, flag, number
from nau_py.model.linked import Project
from nau_py.model.passes import Pass
from nau_py.model.raytrace import RaytracePass
from nau_py.model.values import DataType
from nau_py.passes.access import add_process, buffer, texture
from nau_py.passes.drawing import begin_view, run_process
from nau_py.passes.frame import FrameContext
from nau_py.passes.registry import PassClass, register_pass
from nau_py.passes.report import PassReport, Stages
from nau_py.raytrace.programs.source import launches_ptx


@register_pass("raytrace", "rt", "optix")
class RaytraceClass(PassClass):
    """Traces rays through the programs of the pass."""

    model = RaytracePass
    parameters = (
        number("RAYS_PER_PIXEL", DataType.INT, 1, "Samples of a pixel.", minimum=1, unit="samples"),
        number("MAX_DEPTH", DataType.INT, 1, "Longest chain of rays.", minimum=1, unit="rays"),
        choice(
            "SAMPLER",
            "SOBOL",
            "SOBOL STRATIFIED RANDOM",
            "nau_py: where built-in ray generation puts the samples of a pixel.",
        ),
        number(
            "TARGET_ERROR",
            DataType.FLOAT,
            0.0,
            "nau_py: above 0, RAYS_PER_PIXEL is the most; pixels stop at this estimated error.",
            minimum=0.0,
            unit="root mean square of RGB",
        ),
        choice(
            "TEXTURE_WEIGHTS",
            "CUDA",
            "CUDA EXACT",
            "nau_py: compiled programs read between texels by weights of 8 bits, or exact ones.",
        ),
        flag("ACCUMULATE", False, "nau_py: frames add up while camera, mask and lights stay."),
        number(
            "LIGHT_SAMPLES",
            DataType.INT,
            1,
            "nau_py: shadow rays from each sample to each area light.",
            minimum=1,
            unit="rays",
        ),
        number(
            "OCCLUSION_DISTANCE",
            DataType.FLOAT,
            1e30,
            "nau_py: reach of `ambient_occlusion`.",
            minimum=0.0,
            unit="world units",
        ),
    )

    def access(self, project: Project, pass_: Pass) -> Access:
        access = Access()
        if isinstance(pass_, RaytracePass):
            for source in pass_.rtInput:
                access.add_read(texture(source.texture, None))
            if launches_ptx(pass_, project.folder):
                for output in pass_.rtOutput:
                    access.add_write(texture(output.texture, None))
            for parameter in pass_.rtGlobalParams:
                name = parameter.context
                if parameter.component == "ID" and name in project.names("texture"):
                    access.add_read(texture(name, None))
                elif parameter.component == "ID" and name in project.names("buffer"):
                    access.add_read(buffer(name, None))
                    access.add_write(buffer(name, None))
        add_process(access, pass_)
        owner = project.target_of(pass_)
        if owner is not None and owner[1].colors:
            first = texture(owner[1].colors[0].name, owner[0])
            access.add_write(first)
            access.replaces.append(first)
        return access

    def faults(self, project: Project, pass_: Pass) -> Iterable[Diagnostic]:
        """Return the faults of compiled programs that cannot run."""
        if isinstance(pass_, RaytracePass) and launches_ptx(pass_, project.folder):
            from nau_py.raytrace.ptx.host.faults import check_programs

            return check_programs(project, pass_)
        return ()

    def execute(self, pass_: Pass, frame: FrameContext) -> PassReport:
        """Select pixels, generate rays, trace and shade them, estimate the pixels, store them."""
        if not isinstance(pass_, RaytracePass) or pass_.rtEntryPoint is None:
            return PassReport()
        if launches_ptx(pass_, frame.project.folder, frame.session.options.programs):
            from nau_py.passes.ptx_launch import execute_ptx  # LLVM

            return execute_ptx(pass_, frame)
        from nau_py.passes.tracing import steps  # Embree and numba: linting imports this module

        view = begin_view(pass_, frame, frame.world.camera(pass_.camera_name))
        run_process(pass_.preProcess, frame)
        stages = Stages()
        context = steps.make_context(pass_, frame, view)
        inputs = steps.read_inputs(pass_, frame)
        stages.end("read_back")
        selection = steps.select_samples(context, inputs)
        if not len(selection.pixels):
            steps.store_colours(view.target, selection.pixels, np.zeros((0, 4), np.float32))
            run_process(pass_.postProcess, frame)
            return PassReport(left_out="its mask selects no pixel", stages=stages.ms)
        scene = steps.build_scene(context, inputs)
        launch = steps.generate_rays(context, scene)
        stages.end("build")
        result = steps.trace_and_shade(context, scene, launch, selection)
        stages.end("shade")
        stages.move("shade", "trace", result.counts.traced_share)
        film = steps.estimate_pixels(result, selection)
        steps.store_colours(view.target, selection.pixels, film.colours)
        stages.end("read_back")
        run_process(pass_.postProcess, frame)
        return steps.report_launch(context, scene, selection, result, film, stages.ms)

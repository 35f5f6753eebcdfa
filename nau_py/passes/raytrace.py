"""Class ``raytrace`` (``rt``, ``optix``): traces rays for the pixels that its mask selects."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.graph.contract import Access
from nau_py.model.attribute import choice, flag, number
from nau_py.model.linked import Project
from nau_py.model.passes import Pass
from nau_py.model.raytrace import RaytracePass
from nau_py.model.values import DataType
from nau_py.passes.access import add_process, buffer, texture
from nau_py.passes.drawing import begin_view, pass_value, run_process
from nau_py.passes.frame import FrameContext
from nau_py.passes.ptx.faults import ptx_faults
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
        """What of its compiled programs cannot be run. Pure."""
        if isinstance(pass_, RaytracePass) and launches_ptx(pass_, project.folder):
            return ptx_faults(project, pass_)
        return ()

    def execute(self, pass_: Pass, frame: FrameContext) -> PassReport:
        from nau_py.passes.effects import effect_data
        from nau_py.passes.tracing import (
            TracingState,
            force_mask,
            read_inputs,
            read_mask,
            store_colours,
        )
        from nau_py.raytrace.tracing.adaptive import run_adaptive
        from nau_py.raytrace.tracing.camera_rays import camera_rays, camera_record
        from nau_py.raytrace.tracing.dispatch import LaunchSettings, Work, run_launch, select

        if not isinstance(pass_, RaytracePass) or pass_.rtEntryPoint is None:
            return PassReport()
        if launches_ptx(pass_, frame.project.folder, frame.session.options.programs):
            from nau_py.passes.ptx.execute import execute_ptx

            return execute_ptx(pass_, frame)
        view = begin_view(pass_, frame, frame.world.camera(pass_.camera_name))
        target = view.target
        run_process(pass_.preProcess, frame)
        stages = Stages()
        options = frame.session.options
        if options.mask != "project":
            force_mask(pass_, frame, float(options.mask == "all"))
        inputs = read_inputs(pass_, frame)
        stages.end("read_back")
        mask = read_mask(pass_, inputs)
        width, height = target.width, target.height
        pixels = select(mask, width, height)
        if not len(pixels):
            store_colours(target, pixels, np.zeros((0, 4), np.float32))
            run_process(pass_.postProcess, frame)
            return PassReport(left_out="its mask selects no pixel", stages=stages.ms)
        state = frame.session.state(pass_, TracingState)
        state.update(pass_)
        scene = state.scene(pass_, frame, view, inputs)

        def value(name: str) -> float:
            return float(pass_value(frame.project, pass_, name))

        samples = options.samples or int(value("RAYS_PER_PIXEL"))
        accumulate = bool(value("ACCUMULATE"))
        name = pass_.name or ""
        work = Work(
            scene,
            state.generate,
            state.exception,
            width,
            camera_record(view.camera, view.rect, state.geometry.centre),
            camera_rays(view.camera, view.rect),
            LaunchSettings(
                samples,
                options.threads,
                options.tile,
                str(pass_value(frame.project, pass_, "SAMPLER")),
                accumulate or value("TARGET_ERROR") > 0,
            ),
            state.label,
            service=state.service,
        )
        if not state.loaded:
            work.load()
            state.loaded = True
        stages.end("build")
        progress = frame.session.progress

        def tell(done: int, total: int) -> None:
            progress(name, done, total)

        if value("TARGET_ERROR") > 0:
            shape = (height, width)
            result = run_adaptive(work, pixels, shape, value("TARGET_ERROR"), tell)
        else:
            kept = state.kept(work, pixels) if accumulate else None
            counts = _spp(pass_, mask, pixels, samples)
            result = run_launch(work, pixels, tell, counts, kept)
        stages.end("shade")
        stages.move("shade", "trace", result.counts.traced_share)
        store_colours(target, pixels, result.colours)
        stages.end("read_back")
        run_process(pass_.postProcess, frame)
        effects = effect_data(
            state.decisions, state.facts, state.simulated, result.counts, stages.ms
        )
        notes = []
        outliers = int(result.estimate.unreliable.sum())
        if outliers:
            notes.append(
                f"in {outliers} pixels one sample outweighs all others: est_error is uncertain"
            )
        if result.counts.cut_layers:
            notes.append(f"{result.counts.cut_layers} rays met more ignored hits than the limit")
        shape = height, width
        return PassReport(
            pixels=len(pixels),
            rays=dict(result.counts.rays),
            avoided=width * height * samples - result.taken,
            est_error=result.est_error,
            nonfinite=result.counts.nonfinite,
            blame=result.counts.blamed(width),
            notes=tuple(notes),
            stages=stages.ms,
            samples=_scattered(result.estimate.taken, pixels, shape, np.int32),
            error=_scattered(result.estimate.error, pixels, shape, np.float32),
            effects=effects,
        )


def _scattered(
    values: NDArray[Any], pixels: NDArray[np.int64], shape: tuple[int, int], dtype: type
) -> NDArray[Any]:
    """An image of ``values`` at ``pixels``, zero elsewhere."""
    image: NDArray[Any] = np.zeros(shape[0] * shape[1], dtype)
    image[pixels] = values
    return image.reshape(shape)


def _spp(
    pass_: RaytracePass,
    mask: NDArray[Any] | None,
    pixels: NDArray[np.int64],
    samples: int,
) -> NDArray[np.int64] | None:
    """Samples of each pixel where the mask's weights say how many; None: the same for all."""
    if mask is None or pass_.mask is None or pass_.mask.weight != "spp":
        return None
    weight = np.clip(mask.reshape(-1)[pixels].astype(np.float64), 0.0, 1.0)
    return np.maximum(np.rint(weight * samples), 1).astype(np.int64)

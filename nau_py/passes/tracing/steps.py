"""The steps of a raytrace pass, from mask to picture, in the order of ``RaytraceClass.execute``."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.passes.report import PassReport
from nau_py.passes.tracing.effects import report_effects
from nau_py.passes.tracing.scene import FrameScene, RayPassContext, build_scene, make_context
from nau_py.passes.tracing.textures import RayInputs, read_inputs, store_colours
from nau_py.raytrace.selection.pixels import select_pixels
from nau_py.raytrace.selection.samples import distribute_samples
from nau_py.raytrace.tracing.adaptive import run_adaptive
from nau_py.raytrace.tracing.camera_rays import encode_camera, make_camera_rays
from nau_py.raytrace.tracing.dispatch import run_launch
from nau_py.raytrace.tracing.estimate import LaunchResult
from nau_py.raytrace.tracing.launch import LaunchSettings, RayGeneration, RayLaunch

__all__ = [
    "build_scene",
    "estimate_pixels",
    "generate_rays",
    "make_context",
    "read_inputs",
    "report_launch",
    "select_samples",
    "store_colours",
    "trace_and_shade",
]


@dataclass(frozen=True, slots=True)
class Selection:
    """Pixels to trace in an image of ``shape`` (height, width).

    ``pixels`` int64 (n,): flat indices, row 0 at the bottom; ``samples`` int64 (n,): samples of
    each, or None for RAYS_PER_PIXEL in all.
    """

    shape: tuple[int, int]
    pixels: NDArray[np.int64]
    samples: NDArray[np.int64] | None


def select_samples(context: RayPassContext, inputs: RayInputs) -> Selection:
    """Select the pixels with a weight above 0, and their samples (``raytrace/selection/``)."""
    target, mask = context.view.target, context.pass_.mask
    width, height = target.width, target.height
    pixels = select_pixels(inputs.mask, width, height)
    meaning = mask.weight if mask is not None else None
    samples = distribute_samples(inputs.mask, pixels, context.parameters.samples, meaning)
    return Selection((height, width), pixels, samples)


def generate_rays(context: RayPassContext, traced: FrameScene) -> RayLaunch:
    """Return the launch: the scene, with the camera and program that generate its rays.

    The rays themselves are generated a tile at a time, by ``kernels/path/camera.py`` or by the
    project's program. Compiles the kernels of the pass the first time.
    """
    options, state = context.frame.session.options, traced.state
    view, parameters = context.view, context.parameters
    generation = RayGeneration(
        state.programs.generation,
        encode_camera(view.camera, view.rect, state.geometry.centre),
        make_camera_rays(view.camera, view.rect),
        view.target.width,
    )
    settings = LaunchSettings(
        parameters.samples,
        options.threads,
        options.tile,
        parameters.sampler,
        parameters.accumulate or parameters.target_error > 0,
    )
    launch = RayLaunch(
        traced.scene,
        generation,
        state.programs.exception,
        settings,
        state.label,
        main_thread=state.main_thread,
    )
    state.compile_once(launch)
    return launch


def trace_and_shade(
    context: RayPassContext, traced: FrameScene, launch: RayLaunch, selection: Selection
) -> LaunchResult:
    """Trace and shade the samples of the selection, in tiles over threads.

    With TARGET_ERROR, rounds of samples follow until the error of each pixel is at most that. With
    ACCUMULATE, the samples add to those of earlier frames. Raises :class:`~nau_py.ProgramError`.
    """
    parameters, pixels = context.parameters, selection.pixels
    progress = _make_progress(context)
    if parameters.target_error > 0:
        return run_adaptive(launch, pixels, selection.shape, parameters.target_error, progress)
    earlier = traced.state.continue_estimates(launch, pixels) if parameters.accumulate else None
    return run_launch(launch, pixels, progress, selection.samples, earlier)


def _make_progress(context: RayPassContext) -> Callable[[int, int], None]:
    """Return a function that reports pixels done, of so many, as progress of the pass."""
    progress, name = context.frame.session.progress, context.pass_.name or ""

    def report(done: int, total: int) -> None:
        progress(name, done, total)

    return report


@dataclass(frozen=True, slots=True)
class Film:
    """Estimates as pictures: ``colours`` RGBA float32 (n, 4) of the selected pixels; ``samples``
    int32 and ``error`` float32 of all, (height, width), row 0 at the bottom."""

    colours: NDArray[np.float32]
    samples: NDArray[np.int32]
    error: NDArray[np.float32]


def estimate_pixels(result: LaunchResult, selection: Selection) -> Film:
    """Estimate colour and error of each pixel from the samples of the launch."""
    return Film(
        result.colours,
        _scatter(result.estimates.taken, selection, np.int32),
        _scatter(result.estimates.error, selection, np.float32),
    )


def _scatter(values: NDArray[Any], selection: Selection, dtype: type) -> NDArray[Any]:
    """Return an image with ``values`` at the selected pixels, 0 elsewhere."""
    height, width = selection.shape
    image: NDArray[Any] = np.zeros(height * width, dtype)
    image[selection.pixels] = values
    return image.reshape(selection.shape)


def report_launch(
    context: RayPassContext,
    traced: FrameScene,
    selection: Selection,
    result: LaunchResult,
    film: Film,
    stages: dict[str, float],
) -> PassReport:
    """Report the rays, errors and effects of a launch. ``stages``: milliseconds by stage."""
    height, width = selection.shape
    counts = result.counts
    notes = []
    outliers = int(result.estimates.unreliable.sum())
    if outliers:
        notes.append(
            f"in {outliers} pixels one sample outweighs all others: est_error is uncertain"
        )
    if counts.cut_layers:
        notes.append(f"{counts.cut_layers} rays met more ignored hits than the limit")
    return PassReport(
        pixels=len(selection.pixels),
        rays=dict(counts.rays),
        avoided=width * height * context.parameters.samples - result.taken,
        est_error=result.est_error,
        nonfinite=counts.nonfinite,
        blame=counts.describe_source(width),
        notes=tuple(notes),
        stages=stages,
        samples=film.samples,
        error=film.error,
        effects=report_effects(traced.effects, counts, stages),
    )

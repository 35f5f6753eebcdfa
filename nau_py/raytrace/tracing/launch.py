"""A launch: the state that all tiles share, and the steps of one tile."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.kernels.core.kernel_tables import USER
from nau_py.raytrace.kernels.path import camera as kernel
from nau_py.raytrace.kernels.path.film import update_film
from nau_py.raytrace.programs.catalogue import find_code_without_effects
from nau_py.raytrace.programs.description import RAY_GENERATION
from nau_py.raytrace.tracing.camera_rays import CameraRays
from nau_py.raytrace.tracing.counts import RayCounts
from nau_py.raytrace.tracing.estimate import PixelEstimates
from nau_py.raytrace.tracing.main_thread import MainThread
from nau_py.raytrace.tracing.program_loader import BoundProgram
from nau_py.raytrace.tracing.ray_batch import SampleBatch
from nau_py.raytrace.tracing.scene_tables import TracedScene
from nau_py.raytrace.tracing.thread_tracer import ThreadTracer, ThreadTracers
from nau_py.scene.mesh import F32


@dataclass(frozen=True, slots=True)
class LaunchSettings:
    """Sampling and scheduling of a launch.

    ``samples`` a pixel; ``threads`` (0: one a core); ``tile``: rays a tile (0: a size that suits
    the programs); ``sampler``: SOBOL, STRATIFIED or RANDOM positions in a pixel. ``progressive``:
    more samples may follow, so that even a single one is jittered.
    """

    samples: int
    threads: int = 0
    tile: int = 0
    sampler: str = "SOBOL"
    progressive: bool = False


@dataclass(frozen=True, slots=True)
class RayGeneration:
    """Ray generation of a launch, for an image of ``width`` pixels.

    ``program``: built-in or the project's; built-in ones read ``camera``, a record of CAMERA
    relative to the scene's centre, the project's call ``rays``.
    """

    program: BoundProgram
    camera: NDArray[Any]
    rays: CameraRays
    width: int


@dataclass(frozen=True, slots=True)
class RayLaunch:
    """Launch state shared by all tiles."""

    scene: TracedScene
    generation: RayGeneration
    exception: BoundProgram | None
    settings: LaunchSettings
    label: str = "the pass"
    """Project and pass, for messages."""
    tracers: ThreadTracers = field(default_factory=ThreadTracers)
    main_thread: MainThread | None = None
    """Runs OpenGL for programs of the tiles; None if no program needs it."""

    @property
    def asks_python(self) -> bool:
        """If any program of the scene is written in Python."""
        return bool(self.scene.tables.record["asks_python"][0])

    def trace_tile(
        self, items: NDArray[Any], estimates: PixelEstimates, part: slice, shift: int
    ) -> RayCounts:
        """Generate, trace and shade the samples of a tile, and add them to the estimates.

        ``items``: records of ITEM, the pixels of the tile; ``part``: their place in ``estimates``.
        Samples of the same pixel >> ``shift`` are traced together.
        """
        tracer = self.tracers.get(self.scene)
        tracer.shift = shift
        radiance = tracer.begin_tile(int(items["count"].sum()))
        with np.errstate(all="ignore"):  # values that are not finite are counted, not printed
            radiance = self._trace_samples(tracer, items, radiance)
            radiance = self._run_exception(tracer, items, radiance)
        nonfinite = np.zeros(2, np.int64)
        update_film(
            radiance,
            items,
            estimates.mean[part],
            estimates.squares[part],
            estimates.number[part],
            estimates.largest[part],
            estimates.batched[part],
            nonfinite,
        )
        tracer.count_nonfinite(self.label, int(nonfinite[0]), int(nonfinite[1]))
        return tracer.counts

    def compile_kernels(self) -> None:
        """Compile the kernels of a launch, or load them; no program of the project is run."""
        if self.asks_python:
            ThreadTracer(self.scene).compile_kernels()
        if self.generation.program.code != USER:
            none = np.zeros(0, kernel.ITEM)
            self.trace_tile(none, PixelEstimates.empty(0), slice(0, 0), 0)

    def _trace_samples(self, tracer: ThreadTracer, items: NDArray[Any], radiance: F32) -> F32:
        """Return the radiance of the samples of ``items``, RGBA float32 (samples, 4)."""
        program = self.generation.program
        if program.code == USER:
            samples = self._make_samples(tracer, items)
            return program.compute_radiance(samples, len(radiance))
        camera, width = self.generation.camera, self.generation.width
        code = program.code
        if not self.scene.settings.simulated.lens:
            code = find_code_without_effects(RAY_GENERATION, code)
        positions = self._choose_positions()
        side = max(round(self.settings.samples**0.5), 1)
        if not self.asks_python:
            tracer.trace_camera_rays(camera, (code, positions, side), width, items, radiance)
            return radiance
        queue = tracer.memory.take_queue(len(radiance))[: len(radiance)]
        seed = np.uint32(self.scene.settings.seed & 0xFFFFFFFF)
        kernel.generate_camera_rays(camera, code, positions, side, seed, width, items, queue)
        tracer.trace_paths(queue, 0, radiance)
        tracer.memory.return_queue(queue)
        return radiance

    def _choose_positions(self) -> int:
        """Return the rule of sample positions: CENTRE, JITTER, STRATA or SOBOL."""
        single = self.settings.samples == 1 and not self.settings.progressive
        if single and self.settings.sampler != "RANDOM":
            return kernel.CENTRE
        if self.settings.sampler == "STRATIFIED":
            side = round(self.settings.samples**0.5)
            return kernel.STRATA if side * side == self.settings.samples else kernel.JITTER
        return kernel.JITTER if self.settings.sampler == "RANDOM" else kernel.SOBOL

    def _run_exception(self, tracer: ThreadTracer, items: NDArray[Any], radiance: F32) -> F32:
        """Replace samples that are not finite by the result of the exception program, if any."""
        if self.exception is None or np.isfinite(radiance).all():
            return radiance
        bad = ~np.isfinite(radiance).all(axis=1)
        samples = self._make_samples(tracer, items)
        tracer.count_nonfinite(self.label, int(bad.sum()), int(samples.pixel[np.argmax(bad)]))
        radiance[bad] = self.exception.compute_radiance(samples, len(radiance))[bad]
        return radiance

    def _make_samples(self, tracer: ThreadTracer, items: NDArray[Any]) -> SampleBatch:
        """Return the samples of ``items`` as a program of the project reads them."""
        flat = np.repeat(items["pixel"], items["count"])
        starts = np.repeat(np.cumsum(items["count"]) - items["count"], items["count"])
        sample = np.arange(len(flat)) - starts + np.repeat(items["first"], items["count"])
        width = self.generation.width
        return SampleBatch(
            tracer,
            (flat % width).astype(np.int32),
            (flat // width).astype(np.int32),
            flat.astype(np.uint32),
            sample.astype(np.uint32),
            self.settings.samples,
            self.generation.rays,
        )

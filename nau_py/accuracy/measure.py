"""Measurement of a candidate by several renders: pictures, errors, times, rays."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.accuracy.candidate import Candidate, Prepared, prepare_candidate
from nau_py.accuracy.metrics import F64, Errors, Mask, measure_errors
from nau_py.accuracy.picture import enlarge, find_traced_pixels, to_picture
from nau_py.accuracy.statistics import Moments, split_error
from nau_py.graph.resource import WINDOW
from nau_py.model.linked import Project
from nau_py.model.pipeline import Pipeline
from nau_py.passes.frame import RunOptions
from nau_py.run.frame import Frame
from nau_py.run.renderer import Renderer

STAGES = ("raster", "trace", "shade", "build", "read_back", "other")
"""Stages of a frame. ``set_up`` happens once, before the first frame."""
ReportPart = Callable[[float], None]
"""Callback for the part of the present frame that is done, 0 to 1."""


@dataclass(slots=True)
class Reference:
    """``mean`` of several renders and the ``variance`` of that mean, float64 (h, w, 3); the pixels
    of the project's ``mask``; ``spp`` in all; ``cached``: taken from an earlier run."""

    mean: F64
    variance: F64
    mask: Mask | None
    spp: int
    label: str
    cached: bool = False

    @property
    def shape(self) -> tuple[int, int]:
        return self.mean.shape[0], self.mean.shape[1]

    @property
    def regions(self) -> tuple[str, ...]:
        """Names of the regions that errors are measured over."""
        return ("picture", "mask") if self.mask is not None else ("picture",)

    def region(self, name: str) -> Mask:
        """Return the pixels of the region ``picture`` or ``mask``, bool (h, w)."""
        whole = np.ones(self.shape, bool)
        return self.mask if name == "mask" and self.mask is not None else whole

    def own_mse(self, name: str) -> float:
        """Estimate the mean squared error of the reference itself in a region."""
        values = self.variance[self.region(name)]
        values = values[np.isfinite(values)]
        return float(values.mean()) if len(values) else float("nan")


@dataclass(slots=True)
class Measured:
    """Results of several runs of a candidate. Times in milliseconds, lists have an entry a run."""

    candidate: Candidate
    ms: list[float] = field(default_factory=list)
    stages: dict[str, list[float]] = field(default_factory=dict)
    set_up_ms: float = 0.0
    build_ms: float = 0.0
    errors: dict[str, list[Errors]] = field(default_factory=dict)
    nonfinite: int = 0
    rays: dict[str, int] = field(default_factory=dict)
    pixels: int = 0
    est_error: float | None = None
    split: dict[str, tuple[float, float]] = field(default_factory=dict)
    """(bias², variance) of one run, by region."""
    last: NDArray[np.float32] | None = None
    """The last picture."""
    samples: NDArray[np.int32] | None = None
    passes: dict[str, float] = field(default_factory=dict)
    """Milliseconds of each pass that does not trace, last run."""
    machine: dict[str, Any] = field(default_factory=dict)


def sum_stages(report: dict[str, Any], capture_ms: float) -> dict[str, float]:
    """Sum the times of a frame by stage; passes that do not trace count as raster."""
    found = dict.fromkeys(STAGES, 0.0)
    frame = report["frames"][0]
    for item in frame["passes"]:
        if item["status"] != "run":
            continue
        stages = item.get("stages", {})
        for name, ms in stages.items():
            found[name] += ms
        found["raster"] += item["ms"] - sum(stages.values())
    found["read_back"] += capture_ms
    found["other"] = max(frame["ms"] - sum(found.values()), 0.0)
    return found


class Bench:
    """Renders candidates of one project and pipeline, always the same frame."""

    def __init__(
        self,
        project: Project,
        pipeline: Pipeline,
        options: RunOptions,
        size: tuple[int, int],
        frame: int = 0,
    ) -> None:
        self.project, self.pipeline = project, pipeline
        self.options, self.size, self.frame = options, size, frame

    def make_renderer(self, candidate: Candidate) -> Renderer:
        """Make a renderer of a candidate."""
        return self._make_renderer(self.prepare(candidate), lambda part: None)

    def _make_renderer(self, prepared: Prepared, report_part: ReportPart) -> Renderer:
        def progress(name: str, done: int, total: int) -> None:
            report_part(done / max(total, 1))

        return Renderer(
            prepared.project,
            self.pipeline.name,
            size=prepared.size,
            options=prepared.options,
            progress=progress,
        )

    def prepare(self, candidate: Candidate) -> Prepared:
        return prepare_candidate(self.project, self.pipeline, candidate, self.options, self.size)

    def average_pictures(
        self, candidate: Candidate, seeds: list[int], report_part: Callable[[int, float], None]
    ) -> tuple[Moments, Mask | None]:
        """Render once for each seed; return mean and variance, and the candidate's mask."""
        prepared = self.prepare(candidate)
        prepared.options.seed = seeds[0]
        renderer = self._make_renderer(prepared, lambda part: report_part(done, part))
        moments: Moments | None = None
        mask: Mask | None = None
        try:
            for done, seed in enumerate(seeds):
                frame = renderer.render(self.frame) if done == 0 else renderer.again(seed)
                image = to_picture(frame, renderer.plan.output == WINDOW)
                mask = find_traced_pixels(frame, self.pipeline)
                moments = moments or Moments(image.shape)
                moments.add(image)
        finally:
            renderer.close()
        assert moments is not None
        return moments, mask

    def measure(
        self,
        candidate: Candidate,
        reference: Reference,
        runs: int,
        first_seed: int,
        report_part: Callable[[int, float], None],
    ) -> Measured:
        """Render once to warm up, then ``runs`` times with different seeds."""
        prepared = self.prepare(candidate)
        done = 0
        renderer = self._make_renderer(prepared, lambda part: report_part(done, part))
        found, moments = Measured(candidate), Moments(reference.mean.shape)
        try:
            warm = renderer.render(self.frame)
            found.set_up_ms = warm.report["setup_ms"]
            found.build_ms = sum_stages(warm.report, 0.0)["build"]
            found.machine = warm.report["machine"]
            for run in range(runs):
                done = run + 1
                report_part(done, 0.0)
                frame = renderer.again(first_seed + run)
                image = enlarge(to_picture(frame, renderer.plan.output == WINDOW), reference.shape)
                moments.add(image)
                self._record(found, frame, image, renderer.capture_ms, reference)
            report_part(runs + 1, 0.0)
        finally:
            renderer.close()
        for region in reference.regions:
            where = reference.region(region)
            found.split[region] = split_error(moments, reference.mean, reference.variance, where)
        return found

    def _record(
        self, found: Measured, frame: Frame, image: F64, capture_ms: float, reference: Reference
    ) -> None:
        report = frame.report
        found.last, found.samples = image.astype(np.float32), frame.samples
        found.nonfinite += int((~np.isfinite(image).all(axis=2)).sum())
        regions = {name: reference.region(name) for name in reference.regions}
        for region, errors in measure_errors(image, reference.mean, regions).items():
            found.errors.setdefault(region, []).append(errors)
        found.ms.append(report["frames"][0]["ms"])
        for name, ms in sum_stages(report, capture_ms).items():
            found.stages.setdefault(name, []).append(ms)
        found.rays = report["totals"]["rays"]
        found.passes = {
            p["name"]: p["ms"]
            for p in report["frames"][0]["passes"]
            if p["status"] == "run" and "stages" not in p
        }
        for item in report["frames"][0]["passes"]:
            if "stages" in item:
                found.est_error, found.pixels = item.get("est_error"), item["pixels"]

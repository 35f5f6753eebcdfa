"""Cost run: reference, sweep, answers, verification."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from nau_py.accuracy.candidate import (
    Candidate,
    Ladders,
    choose_best,
    make_base,
    make_candidates,
    read_cost_settings,
    read_ladders,
)
from nau_py.accuracy.cost_run import CostRun
from nau_py.accuracy.effect_cost import measure_effects
from nau_py.accuracy.measure import Bench, Measured, Reference
from nau_py.accuracy.ranking import RANKED, Ranking, estimate_error, safe_root
from nau_py.accuracy.reference import render_reference
from nau_py.accuracy.refine import refine_number
from nau_py.accuracy.report import SCHEMA, Answer, CostReport, ReferenceFacts, Verified
from nau_py.accuracy.statistics import compute_interval
from nau_py.diagnostics.diagnostic import Severity, error
from nau_py.diagnostics.errors import ProjectError
from nau_py.model.knob import pick_raytrace_passes
from nau_py.model.linked import Project
from nau_py.model.pipeline import Pipeline
from nau_py.passes import pass_classes
from nau_py.passes.frame import RunOptions
from nau_py.rules.engine import lint
from nau_py.run.pipeline_choice import choose_pipeline
from nau_py.scene.names import list_default_materials

RUNS = 5
LEAST_SPP, MORE_SPP = 256, 8
"""Samples of a reference: at least, and times the most of the ladder."""
MOST_SPP = 4096
"""Samples beyond which a target is not pursued."""
NEW_SEEDS = 500_009
"""First seed of a verification: no other render has it."""
Progress = Callable[[str, float], None]
"""``report(task, part)``: the present task, and the part of the whole run that is done, 0 to 1."""


@dataclass(slots=True)
class CostRequest:
    """Request of a user. ``knobs``: ladders as text, by knob; without any, the project's or the
    default ones. ``target_error`` in units of ``measure``; ``budget_time`` in seconds."""

    knobs: Mapping[str, str] = field(default_factory=dict)
    reference: int | None = None
    runs: int | None = None
    combine: bool | None = None
    measure: str = RANKED[0]
    region: str | None = None
    target_error: float | None = None
    budget_time: float | None = None
    keep: bool = True
    effects: bool = False


class _ProgressMeter:
    """Progress of the whole run, from the progress of its parts."""

    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self.total, self.done = 1.0, 0.0

    def report(self, task: str, weight: float, part: float) -> None:
        self._progress(task, min((self.done + weight * part) / self.total, 1.0))

    def plan(self, weight: float) -> None:
        self.total = max(self.done + weight, 1e-9)


@dataclass(slots=True)
class _Sweep:
    """Measurements of an unfinished run."""

    bench: Bench
    truth: Reference
    runs: int
    seed: int
    meter: _ProgressMeter
    found: list[Measured] = field(default_factory=list)

    def measure(self, candidate: Candidate, weight: float, first_seed: int = 1) -> Measured:
        def say(run: int, part: float) -> None:
            self.meter.report(candidate.label, weight, (run + part) / (self.runs + 1))

        made = self.bench.measure(candidate, self.truth, self.runs, first_seed + self.seed, say)
        self.meter.done += weight
        return made

    def add(self, candidate: Candidate) -> None:
        """Measure a candidate that was not planned."""
        weight = _estimate_work(
            candidate, _count_samples(self.bench.project, self.bench.pipeline, candidate)
        )
        self.meter.plan(self.runs * weight)
        self.found.append(self.measure(candidate, self.runs * weight))


def measure_cost(
    project: Project,
    options: RunOptions,
    request: CostRequest,
    pipeline: str | None = None,
    size: tuple[int, int] | None = None,
    frame: int = 0,
    progress: Progress = lambda task, part: None,
) -> CostRun:
    """Measure accuracy and time of ``project`` over the ladders of its knobs.

    Raises :class:`~nau_py.ProjectError` for a project with lint errors and for knobs that do
    not exist, and what rendering raises.
    """
    diagnostics = lint(project, pass_classes(), list_default_materials(project))
    wrong = [d for d in diagnostics if d.severity is Severity.ERROR]
    if wrong:
        raise ProjectError(wrong)
    settings = read_cost_settings(project)
    chosen = choose_pipeline(project, pipeline or settings.pipeline)
    turned = read_ladders(project, chosen, request.knobs)
    start = make_base(project, chosen, turned)
    combine = settings.combine == "all" if request.combine is None else request.combine
    every = make_candidates(start, turned, combine)
    spps = [_count_samples(project, chosen, c) for c in every]
    samples = request.reference or settings.reference or max(MORE_SPP * max(spps), LEAST_SPP)
    rays = pick_raytrace_passes(chosen.passes)
    masked = any(p.mask for p in rays)
    if rays:
        _check_reference(project, samples, max(spps))
    else:
        samples = 1
    if request.region == "mask" and not masked:
        message = "region 'mask' is asked for, but the raytrace pass has no mask"
        raise ProjectError(error("A003", project.file.location, message))
    region = request.region or ("mask" if masked else "picture")
    bench = Bench(project, chosen, options, size or project.size, frame)
    runs = max(request.runs or settings.runs or RUNS, 2)
    most = choose_best(project, chosen, start, turned)

    meter = _ProgressMeter(progress)
    weights = [(runs + 1) * _estimate_work(c, spp) for c, spp in zip(every, spps)]
    whole = _estimate_work(most, samples)
    later = 4 * weights[0] if request.effects else 0.0
    meter.plan(whole + sum(weights) + later)
    label = f"reference, {samples} spp" if rays else "reference"
    truth = render_reference(
        bench,
        most,
        samples,
        _name_device(),
        lambda part: meter.report(label, whole, part),
        request.keep,
    )
    meter.done = 0.0 if truth.cached else whole
    meter.plan(sum(weights) + later)
    sweep = _Sweep(bench, truth, runs, options.seed, meter)
    for candidate, weight in zip(every, weights):
        sweep.found.append(sweep.measure(candidate, weight))
    ranking = Ranking(request.measure, region, truth, sweep.found)
    answers, verified, wanted = _meet_targets(request, sweep, ranking, turned, samples)
    effects = (
        measure_effects(bench, start, runs, lambda task, part: meter.report(task, later, part))
        if request.effects
        else []
    )
    knee = ranking.knee
    report = CostReport(
        schema=SCHEMA,
        project=project.name,
        pipeline=chosen.name or "",
        size=bench.size,
        frame=frame,
        machine=sweep.found[0].machine,
        runs=runs,
        measure=request.measure,
        region=region,
        reference=ReferenceFacts(
            label=truth.label,
            spp=truth.spp,
            cached=truth.cached,
            own_rmse={r: safe_root(truth.own_mse(r)) for r in truth.regions},
        ),
        settings=[ranking.describe_setting(m, m.candidate == start) for m in sweep.found],
        knee=knee.candidate.label if knee is not None else None,
        halving=ranking.halving,
        comparisons=ranking.make_comparisons(),
        answers=answers,
        verified=verified,
        effects=effects,
        notes=ranking.list_notes(),
    )
    return CostRun(report, truth, sweep.found, wanted, diagnostics)


def _check_reference(project: Project, samples: int, most: int) -> None:
    if samples <= most:
        message = f"a reference of {samples} spp cannot judge {most} spp: ask for more"
        raise ProjectError(error("A004", project.file.location, message))


def _meet_targets(
    request: CostRequest, sweep: _Sweep, ranking: Ranking, turned: Ladders, samples: int
) -> tuple[list[Answer], list[Verified], Candidate | None]:
    """Find and verify the settings that meet the target error and the time budget."""
    answers: list[Answer] = []
    verified: list[Verified] = []
    chosen: Candidate | None = None
    own = sweep.found[0].candidate
    most = min(samples // 2, MOST_SPP)

    def pursue(passes: Callable[[Measured], bool]) -> None:
        def tried() -> Sequence[tuple[int, bool]]:
            return [(int(m.candidate["spp"] or 0), passes(m)) for m in ranking.select_ladder("spp")]

        if "spp" in turned:
            refine_number(tried, lambda number: sweep.add(own.with_value("spp", number)), most)

    if request.target_error is not None:
        target = request.target_error
        pursue(lambda m: estimate_error(m, ranking.region, ranking.measure).high <= target)
        answer, best_ = ranking.find_for_error(target)
        answers.append(answer)
        if best_ is not None:
            chosen = best_.candidate
            verified.append(ranking.verify_error(_measure_again(sweep, chosen), target))
    if request.budget_time is not None:
        budget = request.budget_time
        pursue(lambda m: compute_interval(m.ms).high > budget * 1000)
        answer, best_ = ranking.find_for_time(budget)
        answers.append(answer)
        if best_ is not None:
            chosen = best_.candidate
            verified.append(ranking.verify_time(_measure_again(sweep, chosen), budget))
    return answers, verified, chosen


def _measure_again(sweep: _Sweep, candidate: Candidate) -> Measured:
    """Measure with seeds of its own."""
    return sweep.measure(candidate, 0.0, NEW_SEEDS)


def _name_device() -> str:
    from nau_py.raster.device import get_device

    return get_device().renderer


def _count_samples(project: Project, pipeline: Pipeline, candidate: Candidate) -> int:
    given = candidate["spp"]
    if isinstance(given, int):
        return given
    own = [
        project.value(p, "PASS", "RAYS_PER_PIXEL")[0] for p in pick_raytrace_passes(pipeline.passes)
    ]
    return max((int(v) for v in own), default=1)


def _estimate_work(candidate: Candidate, spp: int) -> float:
    """Estimate the work of a frame of a candidate, for the progress bar."""
    everywhere = 6.0 if candidate["mask"] == "all" else 1.0
    return spp * everywhere + 8.0

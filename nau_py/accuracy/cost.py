"""A cost run: reference, sweep, answers, verification."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from nau_py.accuracy.candidate import (
    Candidate,
    Ladders,
    base,
    best,
    candidates,
    ladders,
    wishes,
)
from nau_py.accuracy.cost_run import CostRun
from nau_py.accuracy.judge import RANKED, Judge, error_of, root
from nau_py.accuracy.measure import Bench, Measured, Reference
from nau_py.accuracy.reference import reference
from nau_py.accuracy.refine import refine
from nau_py.accuracy.report import SCHEMA, Answer, CostReport, ReferenceFacts, Verified
from nau_py.accuracy.statistics import interval
from nau_py.accuracy.worth import worth
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
"""``progress(what, part)``: what is being done, and how much of the whole run is done, 0 to 1."""


@dataclass(slots=True)
class Wishes:
    """What a user asks of a cost run. ``knobs``: ladders as text, by knob; none takes the
    project's word or the default. ``target_error`` in ``measure``; ``budget_time`` in seconds."""

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


class _Meter:
    """Turns what is done of the whole into a share."""

    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self.total, self.done = 1.0, 0.0

    def told(self, what: str, weight: float, part: float) -> None:
        self._progress(what, min((self.done + weight * part) / self.total, 1.0))

    def plan(self, weight: float) -> None:
        self.total = max(self.done + weight, 1e-9)


@dataclass(slots=True)
class _Sweep:
    """The measurements of a run in the making."""

    bench: Bench
    truth: Reference
    runs: int
    seed: int
    meter: _Meter
    found: list[Measured] = field(default_factory=list)

    def measure(self, candidate: Candidate, weight: float, first_seed: int = 1) -> Measured:
        def say(run: int, part: float) -> None:
            self.meter.told(candidate.label, weight, (run + part) / (self.runs + 1))

        made = self.bench.measure(candidate, self.truth, self.runs, first_seed + self.seed, say)
        self.meter.done += weight
        return made

    def add(self, candidate: Candidate) -> None:
        """Measure one that was not planned."""
        weight = _weight(candidate, _spp(self.bench.project, self.bench.pipeline, candidate))
        self.meter.plan(self.runs * weight)
        self.found.append(self.measure(candidate, self.runs * weight))


def cost(
    project: Project,
    options: RunOptions,
    asked: Wishes,
    pipeline: str | None = None,
    size: tuple[int, int] | None = None,
    frame: int = 0,
    progress: Progress = lambda what, part: None,
) -> CostRun:
    """Measure accuracy and time of ``project`` over the ladders of its knobs.

    Raises :class:`~nau_py.ProjectError` for a project with lint errors and for knobs that do
    not exist, and what rendering raises.
    """
    diagnostics = lint(project, pass_classes(), list_default_materials(project))
    wrong = [d for d in diagnostics if d.severity is Severity.ERROR]
    if wrong:
        raise ProjectError(wrong)
    told = wishes(project)
    chosen = choose_pipeline(project, pipeline or told.pipeline)
    turned = ladders(project, chosen, asked.knobs)
    start = base(project, chosen, turned)
    combine = told.combine == "all" if asked.combine is None else asked.combine
    every = candidates(start, turned, combine)
    spps = [_spp(project, chosen, c) for c in every]
    samples = asked.reference or told.reference or max(MORE_SPP * max(spps), LEAST_SPP)
    rays = pick_raytrace_passes(chosen.passes)
    masked = any(p.mask for p in rays)
    if rays:
        _check_reference(project, samples, max(spps))
    else:
        samples = 1
    if asked.region == "mask" and not masked:
        message = "region 'mask' is asked for, but the raytrace pass has no mask"
        raise ProjectError(error("A003", project.file.location, message))
    region = asked.region or ("mask" if masked else "picture")
    bench = Bench(project, chosen, options, size or project.size, frame)
    runs = max(asked.runs or told.runs or RUNS, 2)
    most = best(project, chosen, start, turned)

    meter = _Meter(progress)
    weights = [(runs + 1) * _weight(c, spp) for c, spp in zip(every, spps)]
    whole = _weight(most, samples)
    later = 4 * weights[0] if asked.effects else 0.0
    meter.plan(whole + sum(weights) + later)
    label = f"reference, {samples} spp" if rays else "reference"
    truth = reference(
        bench, most, samples, _device(), lambda part: meter.told(label, whole, part), asked.keep
    )
    meter.done = 0.0 if truth.cached else whole
    meter.plan(sum(weights) + later)
    sweep = _Sweep(bench, truth, runs, options.seed, meter)
    for candidate, weight in zip(every, weights):
        sweep.found.append(sweep.measure(candidate, weight))
    judge = Judge(asked.measure, region, truth, sweep.found)
    answers, verified, wanted = _targets(asked, sweep, judge, turned, samples)
    effects = (
        worth(bench, start, runs, lambda what, part: meter.told(what, later, part))
        if asked.effects
        else []
    )
    knee = judge.knee
    report = CostReport(
        schema=SCHEMA,
        project=project.name,
        pipeline=chosen.name or "",
        size=bench.size,
        frame=frame,
        machine=sweep.found[0].machine,
        runs=runs,
        measure=asked.measure,
        region=region,
        reference=ReferenceFacts(
            label=truth.label,
            spp=truth.spp,
            cached=truth.cached,
            own_rmse={r: root(truth.own_mse(r)) for r in truth.regions},
        ),
        settings=[judge.setting(m, m.candidate == start) for m in sweep.found],
        knee=knee.candidate.label if knee is not None else None,
        halving=judge.halving,
        comparisons=judge.comparisons(),
        answers=answers,
        verified=verified,
        effects=effects,
        notes=judge.notes(),
    )
    return CostRun(report, truth, sweep.found, wanted, diagnostics)


def _check_reference(project: Project, samples: int, most: int) -> None:
    if samples <= most:
        message = f"a reference of {samples} spp cannot judge {most} spp: ask for more"
        raise ProjectError(error("A004", project.file.location, message))


def _targets(
    asked: Wishes, sweep: _Sweep, judge: Judge, turned: Ladders, samples: int
) -> tuple[list[Answer], list[Verified], Candidate | None]:
    """Find and verify what meets the target error and the time budget."""
    answers: list[Answer] = []
    verified: list[Verified] = []
    chosen: Candidate | None = None
    own = sweep.found[0].candidate
    most = min(samples // 2, MOST_SPP)

    def pursue(passes: Callable[[Measured], bool]) -> None:
        def tried() -> Sequence[tuple[int, bool]]:
            return [(int(m.candidate["spp"] or 0), passes(m)) for m in judge.only("spp")]

        if "spp" in turned:
            refine(tried, lambda number: sweep.add(own.but("spp", number)), most)

    if asked.target_error is not None:
        target = asked.target_error
        pursue(lambda m: error_of(m, judge.region, judge.measure).high <= target)
        answer, best_ = judge.for_error(target)
        answers.append(answer)
        if best_ is not None:
            chosen = best_.candidate
            verified.append(judge.verify_error(_again(sweep, chosen), target))
    if asked.budget_time is not None:
        budget = asked.budget_time
        pursue(lambda m: interval(m.ms).high > budget * 1000)
        answer, best_ = judge.for_time(budget)
        answers.append(answer)
        if best_ is not None:
            chosen = best_.candidate
            verified.append(judge.verify_time(_again(sweep, chosen), budget))
    return answers, verified, chosen


def _again(sweep: _Sweep, candidate: Candidate) -> Measured:
    """Measure with seeds that nothing else has."""
    return sweep.measure(candidate, 0.0, NEW_SEEDS)


def _device() -> str:
    from nau_py.raster.device import get_device

    return get_device().renderer


def _spp(project: Project, pipeline: Pipeline, candidate: Candidate) -> int:
    given = candidate["spp"]
    if isinstance(given, int):
        return given
    own = [
        project.value(p, "PASS", "RAYS_PER_PIXEL")[0] for p in pick_raytrace_passes(pipeline.passes)
    ]
    return max((int(v) for v in own), default=1)


def _weight(candidate: Candidate, spp: int) -> float:
    """How much work a frame of a candidate is, roughly, for the progress bar."""
    everywhere = 6.0 if candidate["mask"] == "all" else 1.0
    return spp * everywhere + 8.0

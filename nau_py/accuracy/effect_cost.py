"""Cost of each effect: time and difference of the project with and without it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from nau_py.accuracy.candidate import Candidate
from nau_py.accuracy.measure import Bench
from nau_py.accuracy.metrics import F64
from nau_py.accuracy.picture import to_picture
from nau_py.accuracy.report import EffectCost
from nau_py.accuracy.statistics import compute_spread
from nau_py.graph.resource import WINDOW
from nau_py.model.effects import EFFECTS


def measure_effects(
    bench: Bench,
    candidate: Candidate,
    runs: int,
    told: Callable[[str, float], None],
) -> list[EffectCost]:
    """Render with every effect that the scene calls for, then without each of them, with the same
    seeds. Other effects cost nothing."""
    image, ms, rays, called = _render(bench, candidate, None, runs)
    found = []
    for done, effect in enumerate(EFFECTS):
        told(f"without {effect}", done / len(EFFECTS))
        if effect not in called:
            found.append(
                EffectCost(
                    effect=effect, called_for=False, rays=0, ms=0.0, rmse=0.0, largest=0.0,
                    pixels=0,
                )
            )  # fmt: skip
            continue
        rest = ", ".join(e for e in EFFECTS if e != effect and e in called) or "none"
        other, less_ms, less_rays, _ = _render(bench, candidate, rest, runs)
        difference = np.nan_to_num(np.abs(other - image))
        found.append(
            EffectCost(
                effect=effect,
                called_for=True,
                rays=rays - less_rays,
                ms=ms - less_ms,
                rmse=float(np.sqrt(np.mean(difference**2))),
                largest=float(difference.max()),
                pixels=int((difference > 0).any(axis=2).sum()),
            )
        )
    return found


def _render(
    bench: Bench, candidate: Candidate, effects: str | None, runs: int
) -> tuple[F64, float, int, set[str]]:
    """Render with ``effects``, or the project's own for None; return the last picture, the median
    milliseconds, the rays, and the effects that the scene calls for."""
    options = bench.options if effects is None else replace(bench.options, effects=effects)
    other = Bench(bench.project, bench.pipeline, options, bench.size, bench.frame)
    renderer = other.make_renderer(candidate)
    try:
        renderer.render(bench.frame)
        times = []
        for run in range(runs):
            frame = renderer.again(1 + run + options.seed)
            times.append(frame.report["frames"][0]["ms"])
        shown = renderer.plan.output == WINDOW
    finally:
        renderer.close()
    called = {
        e["effect"]
        for e in frame.report["effects"]
        if e["called_for"] and e["status"] == "simulated"
    }
    rays = sum(frame.report["totals"]["rays"].values())
    return to_picture(frame, shown), compute_spread(times).median, rays, called

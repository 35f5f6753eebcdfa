"""Ranking of the settings of a sweep: front, knee, answers, comparisons."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite, sqrt

from nau_py.accuracy.candidate import Candidate
from nau_py.accuracy.front import Point, find_fastest, find_front, find_knee, find_most_accurate
from nau_py.accuracy.measure import Measured, Reference
from nau_py.accuracy.report import (
    Answer,
    Comparison,
    Estimate,
    RegionErrors,
    SettingCost,
    TimeSpread,
    Verified,
)
from nau_py.accuracy.statistics import Interval, compute_interval, compute_spread, fit_exponent

MEASURES = ("mse", "rmse", "relmse", "psnr", "ssim", "flip")
EQUAL = 1.001
"""Errors in this ratio count as equal."""
RANKED = ("rmse", "mse", "relmse")
"""Measures that settings can be ranked by: smaller is better."""


def estimate_error(m: Measured, region: str, measure: str) -> Interval:
    """Return the mean of an error of a candidate over its runs, with its interval."""
    return compute_interval([getattr(e, measure) for e in m.errors[region]])


def to_estimate(found: Interval) -> Estimate:
    def number(value: float) -> float | None:
        return value if isfinite(value) else None

    return Estimate(mean=number(found.mean), interval=(number(found.low), number(found.high)))


def safe_root(value: float) -> float | None:
    return sqrt(value) if isfinite(value) and value >= 0 else None


@dataclass(frozen=True, slots=True)
class Ranking:
    """Ranks ``measured`` by time and by ``measure`` over ``region``."""

    measure: str
    region: str
    truth: Reference
    measured: list[Measured]

    def beats_reference(self, m: Measured) -> bool:
        """Return True if a candidate is more accurate than the reference.

        Their difference is then less than twice the reference's own error, and tells little about
        the error of the candidate.
        """
        own = self.truth.own_mse(self.region)
        return own > 0 and estimate_error(m, self.region, "mse").mean < 2 * own

    def locate(self, m: Measured) -> Point:
        """Return the median time in milliseconds and the mean error."""
        return compute_spread(m.ms).median, estimate_error(m, self.region, self.measure).mean

    @property
    def ranked(self) -> list[Measured]:
        return [
            m for m in self.measured if not self.beats_reference(m) and isfinite(self.locate(m)[1])
        ]

    @property
    def front(self) -> list[Measured]:
        """Settings that no other one beats in time and error, by growing time."""
        usable = self.ranked
        return [usable[i] for i in find_front([self.locate(m) for m in usable])]

    @property
    def knee(self) -> Measured | None:
        line = self.front
        found = find_knee([self.locate(m) for m in line])
        return line[found] if found is not None else None

    def select_ladder(self, knob: str) -> list[Measured]:
        """Return the measurements that differ from the first in ``knob`` only, by its value."""
        own = self.measured[0].candidate
        value = own[knob]
        if value is None:
            return []
        found = [m for m in self.measured if m.candidate.with_value(knob, value) == own]
        return sorted(found, key=lambda m: float(m.candidate[knob] or 0))

    @property
    def halving(self) -> float | None:
        """Factor of the tracing time that halves the error, from error ~ time^p over the samples a
        pixel; raster and other stages do not count."""
        line = [m for m in self.select_ladder("spp") if not self.beats_reference(m)]
        if len(line) < 2:
            return None
        costs = [sum(compute_spread(m.stages[s]).median for s in ("trace", "shade")) for m in line]
        errors = [self.locate(m)[1] for m in line]
        power = fit_exponent(costs, errors)
        return 2 ** (-1 / power) if power is not None and power < 0 else None

    def describe_setting(self, m: Measured, base: bool) -> SettingCost:
        """Make the row of the report for a setting."""
        times = compute_spread(m.ms)
        return SettingCost(
            label=m.candidate.label,
            values=dict(m.candidate.values),
            base=base,
            time=TimeSpread(median=times.median, range=(times.low, times.high)),
            set_up_ms=m.set_up_ms,
            build_ms=m.build_ms,
            stages={name: compute_spread(values).median for name, values in m.stages.items()},
            passes=m.passes,
            rays=m.rays,
            pixels=m.pixels,
            est_error=m.est_error,
            nonfinite=m.nonfinite,
            errors={region: self._errors(m, region) for region in self.truth.regions},
            on_front=any(m is other for other in self.front),
            better_than_reference=self.beats_reference(m),
        )

    def _errors(self, m: Measured, region: str) -> RegionErrors:
        bias2, variance = m.split[region]
        found = {
            name: to_estimate(estimate_error(m, region, name))
            for name in MEASURES
            if getattr(m.errors[region][0], name) is not None
        }
        return RegionErrors(
            **found,
            bias2=bias2 if isfinite(bias2) else None,
            variance=variance if isfinite(variance) else None,
        )

    def _error_promise(self, most: float) -> str:
        return f"{self.measure} of the {self.region} at most {most:g}"

    def find_for_error(self, most: float) -> tuple[Answer, Measured | None]:
        """Find the fastest setting whose error is at most ``most``, interval included."""
        points = [
            (compute_spread(m.ms).median, estimate_error(m, self.region, self.measure).high)
            for m in self.measured
        ]
        found = find_fastest(points, most)
        question = self._error_promise(most)
        if found is None:
            least = min(p[1] for p in points)
            text = f"no setting reaches it; the most accurate reaches {least:.3g}"
            return Answer(question=question, setting=None, text=text), None
        return self._answer(question, self.measured[found])

    def find_for_time(self, seconds: float) -> tuple[Answer, Measured | None]:
        """Find the most accurate setting that takes at most ``seconds``, interval included."""
        points = [
            (compute_interval(m.ms).high, estimate_error(m, self.region, self.measure).mean)
            for m in self.measured
        ]
        found = find_most_accurate(points, seconds * 1000)
        question = _time_promise(seconds)
        if found is None:
            least = min(p[0] for p in points)
            text = f"no setting is so fast; the fastest takes {least / 1000:.3g} s"
            return Answer(question=question, setting=None, text=text), None
        return self._answer(question, self.measured[found])

    def _answer(self, question: str, m: Measured) -> tuple[Answer, Measured]:
        time, value = self.locate(m)
        text = f"{m.candidate.label}: {time:.0f} ms, {self.measure} {value:.3g}"
        return Answer(question=question, setting=m.candidate.label, text=text), m

    def make_comparisons(self) -> list[Comparison]:
        """Compare each setting with the most accurate other one that takes no longer, and with
        the fastest other one that is as accurate."""
        points = [self.locate(m) for m in self.measured]
        found = []
        for k, (time, value) in enumerate(points):
            others = [i for i in range(len(points)) if i != k]
            rest = [points[i] for i in others]
            better, faster = find_most_accurate(rest, time), find_fastest(rest, value * EQUAL)
            if better is not None and rest[better][1] >= value:
                better = None
            if faster is not None and rest[faster][0] >= time:
                faster = None
            labels = [self.measured[i].candidate.label for i in others]
            found.append(
                Comparison(
                    setting=self.measured[k].candidate.label,
                    at_equal_time=labels[better] if better is not None else None,
                    error_ratio=rest[better][1] / value if better is not None else None,
                    at_equal_error=labels[faster] if faster is not None else None,
                    time_ratio=rest[faster][0] / time if faster is not None else None,
                )
            )
        return found

    def verify_error(self, m: Measured, most: float) -> Verified:
        found = estimate_error(m, self.region, self.measure)
        return _verified(self._error_promise(most), m.candidate, found, most)

    def verify_time(self, m: Measured, seconds: float) -> Verified:
        found = compute_interval([ms / 1000 for ms in m.ms])
        return _verified(_time_promise(seconds), m.candidate, found, seconds)

    def list_notes(self) -> list[str]:
        """List the notes that a reader of the numbers needs."""
        found = []
        if self.truth.own_mse(self.region) == 0:
            found.append(
                "Other seeds change nothing: programs draw no random numbers, or their own, as "
                "compiled programs do; then intervals and the reference's error are not known"
            )
        for m in self.measured:
            if m.nonfinite:
                found.append(f"{m.candidate.label}: {m.nonfinite} pixels were not finite")
            if self.beats_reference(m):
                found.append(
                    f"{m.candidate.label}: more accurate than the reference; not ranked. "
                    "A larger --reference would tell"
                )
        return found


def _time_promise(seconds: float) -> str:
    return f"a frame in at most {seconds:g} s"


def _verified(promise: str, candidate: Candidate, found: Interval, most: float) -> Verified:
    return Verified(
        promise=promise,
        setting=candidate.label,
        found=to_estimate(found),
        kept=found.low <= most,
    )

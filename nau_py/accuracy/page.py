"""The page of a cost run: one HTML file that needs no network."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nau_py.accuracy.cost_run import CostRun
from nau_py.accuracy.front_chart import draw_charts
from nau_py.accuracy.metrics import F64
from nau_py.accuracy.report import CostReport
from nau_py.accuracy.tables import (
    make_comparison_grid,
    make_effect_grid,
    make_setting_grid,
    write_sentences,
)
from nau_py.reporting.chart import MISSING
from nau_py.reporting.page import render_template, shrink
from nau_py.reporting.pixels import Array, Bytes, quantize

CROP = 96
"""Side of a crop, pixels."""
MAP_GAIN = 8.0
"""Factor of the absolute difference in error maps."""
LONGEST = 420
"""Longest side of the pictures, pixels."""
_STAGES = {
    "trace": "#0b62c4",
    "shade": "#1a7f37",
    "build": "#8250df",
    "read_back": "#b35900",
    "other": "#d8dee4",
}
_PASSES = ("#424a53", "#6e7781", "#8c959f", "#afb8c1")


@dataclass(frozen=True, slots=True)
class Figure:
    """Images with one label below them."""

    label: str
    images: tuple[Bytes, ...]


@dataclass(frozen=True, slots=True)
class BarPart:
    """Part of a bar: its width in percent of the longest bar."""

    percent: str
    colour: str
    title: str


@dataclass(frozen=True, slots=True)
class Bar:
    """A bar of stacked times."""

    label: str
    parts: tuple[BarPart, ...]
    total: str


def write_page(run: CostRun) -> str:
    """Write the page of a cost run."""
    report = run.report
    regions = sorted(report.settings[0].errors, key=lambda r: r != report.region)
    machine = ", ".join(f"{k} {v}" for k, v in report.machine.items())
    about = (
        f"{report.size[0]} x {report.size[1]} pixels, frame {report.frame}, {report.runs} runs of "
        f"each setting, a seed each; {machine}"
    )
    place, crops = _make_crops(run)
    colours = _choose_colours(report)
    return render_template(
        "cost.html",
        title=f"{report.project}, {report.pipeline}: accuracy against time",
        about=about,
        sentences=write_sentences(report),
        charts=draw_charts(report, regions),
        missing=MISSING,
        comparisons=make_comparison_grid(report),
        key=list(colours.items()),
        bars=_make_bars(report, colours),
        crop_place=place,
        gain=f"{MAP_GAIN:g}",
        crops=crops,
        maps=_make_maps(run),
        settings=make_setting_grid(report),
        effects=make_effect_grid(report),
    )


def find_worst_square(difference: F64, side: int = CROP) -> tuple[int, int]:
    """Find the square with the greatest sum of ``difference`` (h, w); return its top row and left
    column."""
    height, width = difference.shape
    side = min(side, height, width)
    sums = np.pad(difference, ((1, 0), (1, 0))).cumsum(axis=0).cumsum(axis=1)
    boxes = sums[side:, side:] - sums[:-side, side:] - sums[side:, :-side] + sums[:-side, :-side]
    row, column = np.unravel_index(int(np.argmax(boxes)), boxes.shape)
    return int(row), int(column)


def _make_crops(run: CostRun) -> tuple[str, list[Figure]]:
    """Crop the region where the cheapest setting is worst, at each setting, with error maps."""
    reference = run.reference.mean
    region = run.reference.region(run.report.region)
    usable = [m for m in run.measured if m.last is not None]
    cheapest = min(usable, key=lambda m: min(m.ms))
    assert cheapest.last is not None
    difference = np.nan_to_num(((cheapest.last - reference) ** 2).sum(axis=2)) * region
    row, column = find_worst_square(difference)
    cut = np.s_[row : row + CROP, column : column + CROP]
    figures = [Figure("reference", (_to_pixels(reference[cut]),))]
    for m in usable:
        assert m.last is not None
        error = np.abs(m.last[cut] - reference[cut]) * MAP_GAIN
        figures.append(Figure(m.candidate.label, (_to_pixels(m.last[cut]), _to_pixels(error))))
    place = f"rows {row} to {row + CROP}, columns {column} to {column + CROP}, from the top left"
    return place, figures


def _make_maps(run: CostRun) -> list[Figure]:
    """Show the whole picture, its error, and the samples of each pixel."""
    own = run.measured[0]
    assert own.last is not None
    error = np.abs(own.last - run.reference.mean) * MAP_GAIN
    shown: list[tuple[str, Array]] = [
        ("the project as it is", own.last),
        ("reference", run.reference.mean),
        (f"difference, {MAP_GAIN:g} times", error),
    ]
    if own.samples is not None:
        most = max(int(own.samples.max()), 1)
        grey = np.repeat((own.samples / most)[:, :, None], 3, axis=2)
        shown.append((f"samples a pixel, 0 to {most}", grey))
    return [Figure(label, (shrink(_to_pixels(image), LONGEST),)) for label, image in shown]


def _to_pixels(image: Array) -> Bytes:
    return quantize(image, nan=1.0)


def _choose_colours(report: CostReport) -> dict[str, str]:
    """Choose the colour of each part of the time: passes that do not trace, and stages."""
    names = list(dict.fromkeys(n for s in report.settings for n in s.passes))
    return {n: _PASSES[k % len(_PASSES)] for k, n in enumerate(names)} | _STAGES


def _make_bars(report: CostReport, colours: dict[str, str]) -> list[Bar]:
    """Stack the times of each setting: passes by name, the raytrace pass by stage."""
    totals = [
        s.passes | {name: s.stages.get(name, 0.0) for name in _STAGES} for s in report.settings
    ]
    longest = max(sum(times.values()) for times in totals) or 1.0
    return [
        Bar(
            s.label,
            tuple(
                BarPart(f"{100 * ms / longest:.2f}", colours[name], f"{name} {ms:.1f} ms")
                for name, ms in times.items()
            ),
            f"{sum(times.values()):.0f} ms",
        )
        for s, times in zip(report.settings, totals)
    ]

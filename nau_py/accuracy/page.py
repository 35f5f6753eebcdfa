"""The page of a cost run: one HTML file that needs no network."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

import nau_py.reporting.html as html
from nau_py.accuracy.cost import CostRun
from nau_py.accuracy.metrics import F64
from nau_py.accuracy.report import CostReport, SettingCost
from nau_py.accuracy.tables import Grid, comparisons, effects, sentences, settings
from nau_py.reporting.chart import Dot, Shape, scatter, to_png, to_svg
from nau_py.reporting.html import Markup
from nau_py.reporting.output import png

CROP = 96
"""Side of a crop, pixels."""
MAP_GAIN = 8.0
"""Error maps show the absolute difference so many times."""
_STAGES = {
    "trace": "#0b62c4",
    "shade": "#1a7f37",
    "build": "#8250df",
    "read_back": "#b35900",
    "other": "#d8dee4",
}
_PASSES = ("#424a53", "#6e7781", "#8c959f", "#afb8c1")
_STYLE = """
.front td:first-child { font-weight: 600; }
.bar { display: flex; height: 16px; } .bar span { display: block; }
.row { display: grid; grid-template-columns: 15rem 1fr 5rem; gap: .6rem; align-items: center;
  font-size: 13px; margin: 2px 0; }
.row > :last-child { text-align: right; }
.crops { display: flex; flex-wrap: wrap; gap: .8rem; }
figure { margin: 0; font-size: 12px; width: 210px; } figure img { width: 100%;
  image-rendering: pixelated; display: block; margin-bottom: 2px; outline: 1px solid #d8dee4; }
.key span { display: inline-block; width: .8rem; height: .8rem; margin: 0 .3rem 0 1rem; }
"""


def dots(report: CostReport, region: str) -> tuple[list[Dot], list[int]]:
    """The settings as points (time, error) of a region, and the indices of the front."""
    found: list[Dot] = []
    kept: list[SettingCost] = []
    base = next(s for s in report.settings if s.base)
    for s in report.settings:
        error = getattr(s.errors[region], report.measure)
        if error.mean is None or not error.mean > 0:
            continue
        low, high = error.interval
        differing = [k for k, v in s.values.items() if v != base.values[k]]
        found.append(
            Dot(
                (s.time.median, *s.time.range),
                (error.mean, max(low or 0.0, error.mean / 50), high or error.mean),
                ", ".join(f"{k} {s.values[k]}" for k in differing) or "as it is",
                " and ".join(differing) or "the project as it is",
                hollow=not s.on_front or region != report.region,
                marked=s.label == report.knee and region == report.region,
            )
        )
        kept.append(s)
    line = [i for i, s in enumerate(kept) if s.on_front and region == report.region]
    return found, sorted(line, key=lambda i: found[i].x[0])


def _plot(report: CostReport, region: str) -> tuple[list[Shape], str]:
    where = "inside the mask" if region == "mask" else "of the whole picture"
    title = f"{report.project}: {report.measure} {where} against time"
    found, line = dots(report, region)
    return scatter(found, line, title, "ms a frame", report.measure), title


def front_png(report: CostReport) -> bytes:
    """The front as a picture for papers."""
    shapes, _ = _plot(report, report.region)
    return to_png(shapes)


def _bytes(image: NDArray[Any]) -> NDArray[np.uint8]:
    shown = np.nan_to_num(image, nan=1.0, posinf=1.0, neginf=0.0)
    return np.asarray(np.rint(np.clip(shown, 0, 1) * 255), np.uint8)


def worst(difference: F64, side: int = CROP) -> tuple[int, int]:
    """Top row and left column of the square with the greatest sum; ``difference`` (h, w)."""
    height, width = difference.shape
    side = min(side, height, width)
    sums = np.pad(difference, ((1, 0), (1, 0))).cumsum(axis=0).cumsum(axis=1)
    boxes = sums[side:, side:] - sums[:-side, side:] - sums[side:, :-side] + sums[:-side, :-side]
    row, column = np.unravel_index(int(np.argmax(boxes)), boxes.shape)
    return int(row), int(column)


def _crops(run: CostRun) -> str:
    """The region where the cheapest setting is worst, at each setting, with error maps."""
    reference = run.reference.mean
    region = run.reference.region(run.report.region)
    usable = [m for m in run.measured if m.last is not None]
    cheapest = min(usable, key=lambda m: min(m.ms))
    assert cheapest.last is not None
    difference = np.nan_to_num(((cheapest.last - reference) ** 2).sum(axis=2)) * region
    row, column = worst(difference)
    cut = np.s_[row : row + CROP, column : column + CROP]
    parts = [_figure("reference", [_bytes(reference[cut])])]
    for m in usable:
        assert m.last is not None
        error = np.abs(m.last[cut] - reference[cut]) * MAP_GAIN
        parts.append(_figure(m.candidate.label, [_bytes(m.last[cut]), _bytes(error)]))
    place = f"rows {row} to {row + CROP}, columns {column} to {column + CROP}, from the top left"
    return (
        f'<p class="grey">{place}. Below each: the difference, {MAP_GAIN:g} times.</p>'
        f'<div class="crops">{"".join(parts)}</div>'
    )


def _maps(run: CostRun) -> str:
    """Whole-picture error of the project as it is, and where its samples were taken."""
    own = run.measured[0]
    assert own.last is not None
    parts = [
        _figure("the project as it is", [_small(_bytes(own.last))]),
        _figure("reference", [_small(_bytes(run.reference.mean))]),
    ]
    error = np.abs(own.last - run.reference.mean) * MAP_GAIN
    parts.append(_figure(f"difference, {MAP_GAIN:g} times", [_small(_bytes(error))]))
    if own.samples is not None:
        most = max(int(own.samples.max()), 1)
        grey = np.repeat((own.samples / most)[:, :, None], 3, axis=2)
        parts.append(_figure(f"samples a pixel, 0 to {most}", [_small(_bytes(grey))]))
    return f'<div class="crops">{"".join(parts)}</div>'


def _small(values: NDArray[np.uint8], most: int = 420) -> NDArray[np.uint8]:
    step = max(-(-max(values.shape[:2]) // most), 1)
    return np.ascontiguousarray(values[::step, ::step])


def _figure(label: str, images: list[NDArray[np.uint8]]) -> str:
    shown = "".join(html.picture(png(i), label) for i in images)
    return f"<figure>{shown}{html.text(label)}</figure>"


def _bars(report: CostReport) -> str:
    """Stacked times: the passes that do not trace by name, the raytrace pass by stage."""
    names = list(dict.fromkeys(n for s in report.settings for n in s.passes))
    colours = {n: _PASSES[k % len(_PASSES)] for k, n in enumerate(names)} | _STAGES
    most = max(sum(s.stages.values()) for s in report.settings)
    keys = "".join(
        f'<span style="background:{c}"></span>{html.text(n)}' for n, c in colours.items()
    )
    rows = [f'<p class="key grey">{keys}</p>']
    for s in report.settings:
        times = s.passes | {name: s.stages.get(name, 0.0) for name in _STAGES}
        bars = "".join(
            f'<span style="width:{100 * ms / most:.2f}%;background:{colours[name]}" '
            f'title="{html.text(name)} {ms:.1f} ms"></span>'
            for name, ms in times.items()
        )
        rows.append(
            f'<div class="row"><span>{html.text(s.label)}</span><span class="bar">{bars}</span>'
            f"<span>{sum(times.values()):.0f} ms</span></div>"
        )
    return "".join(rows)


def _grid(grid: Grid) -> Markup:
    kinds = ["front" if k in grid.strong else "" for k in range(len(grid.rows))]
    return html.table(grid.head, grid.rows, kinds)


def excerpt(report: CostReport) -> str:
    """The front, the answers and the table, as a part of another page."""
    shapes, title = _plot(report, report.region)
    parts = (to_svg(shapes, title), html.items(sentences(report)), _grid(settings(report)))
    return f"<div>{''.join(parts)}</div>"


def page(run: CostRun) -> str:
    """The whole page."""
    report = run.report
    plots = []
    for region in sorted(report.settings[0].errors, key=lambda r: r != report.region):
        shapes, title = _plot(report, region)
        plots.append(to_svg(shapes, title))
    machine = ", ".join(f"{k} {v}" for k, v in report.machine.items())
    about = (
        f"{report.size[0]} x {report.size[1]} pixels, frame {report.frame}, {report.runs} runs of "
        f"each setting, a seed each; {machine}"
    )
    worth = effects(report)
    title = f"{report.project}, {report.pipeline}: accuracy against time"
    parts = [
        html.tag("h1", title),
        html.tag("p", about, "grey"),
        html.items(sentences(report)),
        "<h2>Front</h2><p>Filled: no other setting is both faster and more accurate. Bars: 95 % "
        "interval of the error, least and greatest time.</p>",
        *plots,
        f"<h2>Equal time, equal error</h2>{_grid(comparisons(report))}",
        f"<h2>Where the time goes</h2>{_bars(report)}",
        f"<h2>Where it is worst</h2>{_crops(run)}",
        f"<h2>Whole picture</h2>{_maps(run)}",
        f"<h2>All numbers</h2>{_grid(settings(report))}",
        "<p class='grey'>relMSE = mean((x - r)² / (r + 0.01)²). Bias and noise are roots of the "
        "parts of the mean squared error of one run, with the reference's own error taken off.</p>",
    ]
    if worth is not None:
        parts.append(html.tag("h2", worth.title) + _grid(worth))
    return html.document(title, parts, _STYLE)

"""The page of a cost run: one HTML file that needs no network."""

from __future__ import annotations

import base64
import io
from html import escape

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from nau_py.accuracy.chart import Dot, Shape, scatter, to_png, to_svg
from nau_py.accuracy.cost import CostRun
from nau_py.accuracy.metrics import F64
from nau_py.accuracy.report import CostReport, SettingCost

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
body { font: 15px/1.5 system-ui, sans-serif; color: #1b1f24; margin: 2rem auto; max-width: 72rem;
  padding: 0 1rem; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.15rem; margin-top: 2.2rem; }
table { border-collapse: collapse; width: 100%; font-size: 13px; }
th, td { padding: .25rem .5rem; border-bottom: 1px solid #d8dee4; text-align: right; }
th:first-child, td:first-child { text-align: left; } td { white-space: nowrap; }
.wide { overflow-x: auto; }
.front td:first-child { font-weight: 600; } .grey { color: #57606a; }
.bar { display: flex; height: 16px; } .bar span { display: block; }
.row { display: grid; grid-template-columns: 15rem 1fr 5rem; gap: .6rem; align-items: center;
  font-size: 13px; margin: 2px 0; }
.row > :last-child { text-align: right; }
.crops { display: flex; flex-wrap: wrap; gap: .8rem; }
figure { margin: 0; font-size: 12px; width: 210px; } figure img { width: 100%;
  image-rendering: pixelated; display: block; margin-bottom: 2px; }
.key span { display: inline-block; width: .8rem; height: .8rem; margin: 0 .3rem 0 1rem; }
"""


def _number(value: float | None, digits: int = 3) -> str:
    return "" if value is None else f"{value:.{digits}g}"


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


def _image(values: NDArray[np.uint8]) -> str:
    stream = io.BytesIO()
    Image.fromarray(values).save(stream, "PNG")
    return "data:image/png;base64," + base64.b64encode(stream.getvalue()).decode()


def _bytes(image: F64) -> NDArray[np.uint8]:
    shown = np.nan_to_num(image, nan=1.0, posinf=1.0, neginf=0.0)
    return np.rint(np.clip(shown, 0, 1) * 255).astype(np.uint8)


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
    shown = "".join(f'<img src="{_image(i)}" alt="">' for i in images)
    return f"<figure>{shown}{escape(label)}</figure>"


def _bars(report: CostReport) -> str:
    """Stacked times: the passes that do not trace by name, the raytrace pass by stage."""
    names = list(dict.fromkeys(n for s in report.settings for n in s.passes))
    colours = {n: _PASSES[k % len(_PASSES)] for k, n in enumerate(names)} | _STAGES
    most = max(sum(s.stages.values()) for s in report.settings)
    keys = "".join(f'<span style="background:{c}"></span>{escape(n)}' for n, c in colours.items())
    rows = [f'<p class="key grey">{keys}</p>']
    for s in report.settings:
        times = s.passes | {name: s.stages.get(name, 0.0) for name in _STAGES}
        bars = "".join(
            f'<span style="width:{100 * ms / most:.2f}%;background:{colours[name]}" '
            f'title="{escape(name)} {ms:.1f} ms"></span>'
            for name, ms in times.items()
        )
        rows.append(
            f'<div class="row"><span>{escape(s.label)}</span><span class="bar">{bars}</span>'
            f"<span>{sum(times.values()):.0f} ms</span></div>"
        )
    return "".join(rows)


def _table(report: CostReport) -> str:
    regions = list(report.settings[0].errors)
    head = ["setting", "ms", "(least to most)", "rays"]
    for region in regions:
        head += [f"{region}: rmse", "± 95 %", "relMSE", "PSNR", "SSIM", "FLIP", "bias", "noise"]
    rows = ["<tr>" + "".join(f"<th>{escape(h)}</th>" for h in [*head, "est. error"]) + "</tr>"]
    for s in report.settings:
        cells = [
            escape(s.label) + (" (as it is)" if s.base else ""),
            f"{s.time.median:.0f}",
            f"{s.time.range[0]:.0f} to {s.time.range[1]:.0f}",
            f"{sum(s.rays.values()):,}",
        ]
        for region in regions:
            e = s.errors[region]
            half = (e.rmse.interval[1] or 0) - (e.rmse.mean or 0)
            cells += [
                _number(e.rmse.mean),
                _number(half, 2),
                _number(e.relmse.mean),
                _number(e.psnr.mean),
                _number(e.ssim.mean, 4),
                _number(e.flip.mean) if e.flip else "",
                _number(None if e.bias2 is None else e.bias2**0.5),
                _number(None if e.variance is None else e.variance**0.5),
            ]
        cells.append(_number(s.est_error))
        kind = ' class="front"' if s.on_front else ""
        rows.append(f"<tr{kind}>" + "".join(f"<td>{c}</td>" for c in cells) + "</tr>")
    return f"<div class='wide'><table>{''.join(rows)}</table></div>"


def summary(report: CostReport) -> list[str]:
    """The answers in sentences."""
    where = "inside the mask" if report.region == "mask" else "over the whole picture"
    own = report.reference.own_rmse.get(report.region)
    found = [
        f"Reference: {report.reference.label}; its own error is about {_number(own, 2)} ({where}, "
        "root mean square)."
    ]
    if report.knee:
        found.append(f"Knee of the front: {report.knee}.")
    if report.halving:
        found.append(
            f"To halve the error by more samples costs {report.halving:.1f} times the time of "
            "tracing and shading."
        )
    found += [f"{a.question[0].upper()}{a.question[1:]}: {a.text}." for a in report.answers]
    for v in report.verified:
        low, high = v.found.interval
        kept = "kept" if v.kept else "NOT kept"
        found.append(
            f"Promise '{v.promise}' by {v.setting}, rendered again with new seeds: "
            f"{_number(v.found.mean)} ({_number(low)} to {_number(high)}), {kept}."
        )
    return found + report.notes


def excerpt(report: CostReport) -> str:
    """The front, the answers and the table, as a part of another page."""
    shapes, title = _plot(report, report.region)
    said = "".join(f"<li>{escape(s)}</li>" for s in summary(report))
    return f"<div>{to_svg(shapes, title)}<ul>{said}</ul>{_table(report)}</div>"


def page(run: CostRun) -> str:
    """The whole page."""
    report = run.report
    plots = []
    for region in sorted(report.settings[0].errors, key=lambda r: r != report.region):
        shapes, title = _plot(report, region)
        plots.append(to_svg(shapes, title))
    machine = ", ".join(f"{k} {v}" for k, v in report.machine.items())
    size = f"{report.size[0]} x {report.size[1]}"
    said = "".join(f"<li>{escape(s)}</li>" for s in summary(report))
    parts = [
        f"<h1>{escape(report.project)}, {escape(report.pipeline)}: accuracy against time</h1>",
        f'<p class="grey">{size} pixels, frame {report.frame}, {report.runs} runs of each setting, '
        f"a seed each; {escape(machine)}</p>",
        f"<ul>{said}</ul>",
        "<h2>Front</h2><p>Filled: no other setting is both faster and more accurate. Bars: 95 % "
        "interval of the error, least and greatest time.</p>",
        *plots,
        f"<h2>Equal time, equal error</h2>{_comparisons(report)}",
        f"<h2>Where the time goes</h2>{_bars(report)}",
        f"<h2>Where it is worst</h2>{_crops(run)}",
        f"<h2>Whole picture</h2>{_maps(run)}",
        f"<h2>All numbers</h2>{_table(report)}",
        "<p class='grey'>relMSE = mean((x - r)² / (r + 0.01)²). Bias and noise are roots of the "
        "parts of the mean squared error of one run, with the reference's own error taken off.</p>",
        _effects(report),
    ]
    body = "\n".join(parts)
    title = escape(f"{report.project}: accuracy against time")
    return (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{title}</title>'
        f"<style>{_STYLE}</style></head><body>{body}</body></html>\n"
    )


def _comparisons(report: CostReport) -> str:
    rows = [
        "<tr><th>setting</th><th>in no more time</th><th>error</th><th>with no more error</th>"
        "<th>time</th></tr>"
    ]
    for c in report.comparisons:
        cells = [
            c.setting,
            c.at_equal_time or "nothing is better",
            f"{c.error_ratio:.2f} x" if c.error_ratio is not None else "",
            c.at_equal_error or "nothing is faster",
            f"{c.time_ratio:.2f} x" if c.time_ratio is not None else "",
        ]
        rows.append("<tr>" + "".join(f"<td>{escape(c)}</td>" for c in cells) + "</tr>")
    return f"<table>{''.join(rows)}</table>"


def _effects(report: CostReport) -> str:
    if not report.effects:
        return ""
    rows = [
        "<tr><th>effect</th><th>called for</th><th>rays</th><th>ms</th><th>rmse</th>"
        "<th>largest</th><th>pixels</th></tr>"
    ]
    for e in report.effects:
        rows.append(
            f"<tr><td>{escape(e.effect)}</td><td>{'yes' if e.called_for else 'no'}</td>"
            f"<td>{e.rays:,}</td><td>{e.ms:.0f}</td><td>{e.rmse:.3g}</td><td>{e.largest:.3g}</td>"
            f"<td>{e.pixels:,}</td></tr>"
        )
    return f"<h2>What each effect is worth</h2><table>{''.join(rows)}</table>"

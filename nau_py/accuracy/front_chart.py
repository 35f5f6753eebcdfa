"""Front of a cost run as a chart, and the excerpt for notebooks."""

from __future__ import annotations

from nau_py.accuracy.report import CostReport, SettingCost
from nau_py.accuracy.tables import make_setting_grid, write_sentences
from nau_py.reporting.chart import MISSING, Chart, ChartPoint, can_draw, draw_png, draw_svg
from nau_py.reporting.page import render_template, to_data_uri


def make_chart(report: CostReport, region: str) -> Chart:
    """Make the chart of error in ``region`` against time."""
    points: list[ChartPoint] = []
    kept: list[SettingCost] = []
    base = next(s for s in report.settings if s.base)
    for s in report.settings:
        error = getattr(s.errors[region], report.measure)
        if error.mean is None or not error.mean > 0:
            continue
        low, high = error.interval
        differing = [k for k, v in s.values.items() if v != base.values[k]]
        points.append(
            ChartPoint(
                (s.time.median, *s.time.range),
                (error.mean, max(low or 0.0, error.mean / 50), high or error.mean),
                ", ".join(f"{k} {s.values[k]}" for k in differing) or "as it is",
                " and ".join(differing) or "the project as it is",
                hollow=not s.on_front or region != report.region,
                marked=s.label == report.knee and region == report.region,
            )
        )
        kept.append(s)
    front = [i for i, s in enumerate(kept) if s.on_front and region == report.region]
    front.sort(key=lambda i: points[i].x[0])
    where = "inside the mask" if region == "mask" else "of the whole picture"
    title = f"{report.project}: {report.measure} {where} against time"
    return Chart(title, "ms a frame", report.measure, tuple(points), tuple(front))


def draw_front(report: CostReport) -> bytes | None:
    """Draw the front as a PNG for papers; None without matplotlib."""
    return draw_png(make_chart(report, report.region)) if can_draw() else None


def draw_charts(report: CostReport, regions: list[str]) -> list[tuple[str, str]]:
    """Draw a chart of each region; return titles and addresses. None without matplotlib."""
    if not can_draw():
        return []
    charts = [make_chart(report, region) for region in regions]
    return [(c.title, to_data_uri(draw_svg(c), "image/svg+xml")) for c in charts]


def write_excerpt(report: CostReport) -> str:
    """Write the front, the answers and the table as a part of another page."""
    return render_template(
        "cost_excerpt.html",
        charts=draw_charts(report, [report.region]),
        missing=MISSING,
        sentences=write_sentences(report),
        settings=make_setting_grid(report),
    )

"""Scatter plots with logarithmic axes, drawn by matplotlib (the extra ``plot``)."""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import find_spec
from typing import TYPE_CHECKING, Literal

Alignment = Literal["left", "center", "right"]

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.text import Annotation

SIZE = (8.6, 5.0)
"""Width and height, inches."""
RESOLUTION = 200
"""Pixels of an inch of a PNG."""
SERIES = ("#0b62c4", "#b35900", "#1a7f37", "#8250df", "#bf3989", "#57606a")
GRID, AXIS = "#d8dee4", "#57606a"
MISSING = "There is no chart: it needs matplotlib. pip install 'nau_py[plot]'"
"""Note in place of a chart."""
_PLACES = (
    (8, 6), (8, -14), (-8, 6), (-8, -14), (0, 12), (0, -20), (14, 16), (14, -26), (-14, 16),
    (-14, -26), (26, 0), (-26, 0), (0, 26), (0, -34),
)  # fmt: skip
"""Offsets of a label from its point that are tried, in points, the best first."""


@dataclass(frozen=True, slots=True)
class ChartPoint:
    """A point with intervals: ``x`` and ``y`` are (value, low, high). ``hollow``: another point is
    better in both; ``marked``: a second circle."""

    x: tuple[float, float, float]
    y: tuple[float, float, float]
    label: str
    series: str
    hollow: bool = False
    marked: bool = False


@dataclass(frozen=True, slots=True)
class Chart:
    """A plot. ``front``: indices of the points that a line joins, by growing x."""

    title: str
    x_label: str
    y_label: str
    points: tuple[ChartPoint, ...]
    front: tuple[int, ...] = ()


def can_draw() -> bool:
    """Return True if matplotlib is installed."""
    return find_spec("matplotlib") is not None


def draw_svg(chart: Chart) -> bytes:
    """Draw a chart as an SVG file. The same chart gives the same bytes."""
    return _draw(chart, "svg")


def draw_png(chart: Chart) -> bytes:
    """Draw a chart as a PNG file."""
    return _draw(chart, "png")


def _draw(chart: Chart, kind: str) -> bytes:
    with _default_settings():
        figure = _make_figure(chart)
        stream = io.BytesIO()
        metadata = {"Date": None} if kind == "svg" else {}
        figure.savefig(stream, format=kind, dpi=RESOLUTION, metadata=metadata)
        return stream.getvalue()


@contextmanager
def _default_settings() -> Iterator[None]:
    """Use matplotlib's defaults: a ``matplotlibrc`` of the working folder has no effect."""
    import matplotlib

    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams["svg.hashsalt"] = "nau_py"
        yield


def _make_figure(chart: Chart) -> Figure:
    from matplotlib.figure import Figure
    from matplotlib.patheffects import withStroke

    figure = Figure(SIZE, layout="constrained")
    axes = figure.subplots()
    axes.set(xscale="log", yscale="log")
    axes.set_title(chart.title, loc="left", fontsize=12, parse_math=False)
    axes.set_xlabel(chart.x_label, color=AXIS, parse_math=False)
    axes.set_ylabel(chart.y_label, color=AXIS, parse_math=False)
    front = [chart.points[i] for i in chart.front]
    axes.plot([p.x[0] for p in front], [p.y[0] for p in front], color=SERIES[0], zorder=2)
    names = list(dict.fromkeys(point.series for point in chart.points))
    colours = {name: SERIES[k % len(SERIES)] for k, name in enumerate(names)}
    for name in names:
        axes.plot([], [], "o", color=colours[name], label=name)
    labels = []
    for point in chart.points:
        colour = colours[point.series]
        _draw_point(axes, point, colour)
        label = axes.annotate(
            point.label, (point.x[0], point.y[0]), _PLACES[0], textcoords="offset points",
            color=colour, fontsize=9, zorder=5, parse_math=False,
        )  # fmt: skip
        label.set_path_effects([withStroke(linewidth=3, foreground="white")])
        labels.append(label)
    axes.margins(0.12)
    for axis in (axes.xaxis, axes.yaxis):
        _set_ticks(axis)
    axes.grid(color=GRID, linewidth=0.8)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    if len(names) > 1:
        legend = figure.legend(loc="outside right upper", frameon=False, fontsize=9)
        for text in legend.get_texts():
            text.set_parse_math(False)
    _place_labels(figure, axes, labels, chart)
    return figure


def _draw_point(axes: Axes, point: ChartPoint, colour: str) -> None:
    """Draw intervals, circle and, for a marked point, a second circle."""
    (x, *x_range), (y, *y_range) = point.x, point.y
    axes.plot(x_range, [y, y], color=colour, linewidth=1, zorder=3)
    axes.plot([x, x], y_range, color=colour, linewidth=1, zorder=3)
    face = "white" if point.hollow else colour
    axes.plot(x, y, "o", markersize=7, color=colour, markerfacecolor=face, zorder=4)
    if point.marked:
        axes.plot(x, y, "o", markersize=13, color=colour, markerfacecolor="none", zorder=4)


def _set_ticks(axis: object) -> None:
    """Label 1, 2 and 5 times powers of ten, so that a narrow range has ticks, too."""
    from matplotlib.axis import Axis
    from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullLocator

    assert isinstance(axis, Axis)
    low, high = axis.get_view_interval()
    narrow = high < 4 * low
    locator = MaxNLocator(6) if narrow else LogLocator(subs=(1, 2, 5) if high < 1e3 * low else (1,))
    axis.set_major_locator(locator)
    axis.set_major_formatter(FuncFormatter(lambda value, position: f"{value:g}"))
    axis.set_minor_locator(NullLocator())


def _place_labels(figure: Figure, axes: Axes, labels: Sequence[Annotation], chart: Chart) -> None:
    """Move each label where it covers neither a point, nor a line, nor another label."""
    from matplotlib.path import Path
    from matplotlib.transforms import Bbox

    figure.draw_without_rendering()
    to_pixels = axes.transData.transform
    size = figure.dpi / 72 * 6
    centres = [to_pixels((p.x[0], p.y[0])) for p in chart.points]
    taken = [Bbox.from_extents(x - size, y - size, x + size, y + size) for x, y in centres]
    lines = [Path([centres[i] for i in chart.front])] if len(chart.front) > 1 else []
    for point in chart.points:
        for ends in (
            [(point.x[1], point.y[0]), (point.x[2], point.y[0])],
            [(point.x[0], point.y[1]), (point.x[0], point.y[2])],
        ):
            lines.append(Path(to_pixels(ends)))
    inside = axes.get_window_extent()
    for label in labels:
        best: tuple[float, tuple[int, int], Bbox] | None = None
        for rank, place in enumerate(_PLACES):
            label.set_position(place)
            label.set_horizontalalignment(_alignment(place[0]))
            box = label.get_window_extent()
            outside = not inside.contains(*box.min) or not inside.contains(*box.max)
            overlaps = box.count_overlaps(taken)
            crossed = sum(line.intersects_bbox(box, filled=False) for line in lines)
            cost = 4 * outside + 2 * overlaps + crossed + 0.01 * rank
            if best is None or cost < best[0]:
                best = cost, place, box
        assert best is not None
        _, place, box = best
        label.set_position(place)
        label.set_horizontalalignment(_alignment(place[0]))
        taken.append(box)


def _alignment(offset: int) -> Alignment:
    return "center" if offset == 0 else "left" if offset > 0 else "right"

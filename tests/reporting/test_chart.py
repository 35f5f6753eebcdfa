"""Charts by matplotlib: ticks, labels, foreign names and settings."""

from __future__ import annotations

import io
import subprocess
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from nau_py.process.isolation import isolated_environment, python_command
from nau_py.reporting.chart import (
    Chart,
    ChartPoint,
    _default_settings,
    _make_figure,
    draw_png,
    draw_svg,
)

pytest.importorskip("matplotlib", reason="the extra [plot] is not installed")


def point(x: float, y: float, label: str, series: str = "spp") -> ChartPoint:
    return ChartPoint((x, x * 0.9, x * 1.1), (y, y * 0.95, y * 1.05), label, series)


def chart(points: list[ChartPoint]) -> Chart:
    return Chart("Title", "ms a frame", "rmse", tuple(points), tuple(range(len(points))))


@pytest.mark.parametrize("spread", [1.001, 1.3, 8.0, 1e3, 1e6])
def test_both_axes_have_ticks(spread: float) -> None:
    points = [point(100, 0.08, "a"), point(100 * spread, 0.08 / spread, "b")]
    with _default_settings():
        figure = _make_figure(chart(points))
        axes = figure.axes[0]
        for axis in (axes.xaxis, axes.yaxis):
            low, high = axis.get_view_interval()
            ticks = [t for t in axis.get_majorticklocs() if low <= t <= high]
            assert 2 <= len(ticks) <= 12


def test_labels_cover_neither_lines_nor_each_other() -> None:
    """Four points along a steep front, and two at nearly the same place."""
    from matplotlib.path import Path as Outline

    places = [(100, 0.1), (101, 0.098), (110, 0.03), (200, 0.012), (800, 0.01)]
    points = [point(x, y, f"depth {k}") for k, (x, y) in enumerate(places)]
    with _default_settings():
        figure = _make_figure(chart(points))
        axes = figure.axes[0]
        boxes = [text.get_window_extent() for text in axes.texts]
        centres = [axes.transData.transform(place) for place in places]
        front = Outline(centres)
        for k, box in enumerate(boxes):
            assert not front.intersects_bbox(box, filled=False), points[k].label
            assert box.count_overlaps([b for n, b in enumerate(boxes) if n != k]) == 0


def test_names_are_text_only() -> None:
    """Neither mathematics of matplotlib nor elements of SVG."""
    names = ["$\\frac{1}$", "<script>alert(1)</script>", "_hidden", "a & b"]
    made = Chart("$x^$", "x", "$y_$", tuple(point(10 + k, 1, n, n) for k, n in enumerate(names)))
    assert b"<script" not in draw_svg(made)
    assert draw_svg(made) == draw_svg(made)
    drawn = np.asarray(Image.open(io.BytesIO(draw_png(made))))
    assert drawn.std() > 5


def test_settings_of_the_working_folder_have_no_effect(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "matplotlibrc").write_text("text.usetex: True\nlines.linewidth: 40\n")
    (tmp_path / "entry").mkdir()
    (tmp_path / "entry" / "draw_entry.py").write_text(
        "import sys\n"
        "from nau_py.reporting.chart import Chart, ChartPoint, draw_png\n"
        "def main():\n"
        "    p = ChartPoint((1, 1, 2), (1, 1, 2), 'a', 's')\n"
        "    open(sys.argv[1], 'wb').write(draw_png(Chart('t', 'x', 'y', (p,))))\n"
    )
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "entry"))
    file = tmp_path / "chart.png"
    subprocess.run(
        python_command("draw_entry:main", [str(file)]),
        env=isolated_environment(),
        cwd=tmp_path,
        check=True,
    )
    same = draw_png(Chart("t", "x", "y", (ChartPoint((1, 1, 2), (1, 1, 2), "a", "s"),)))
    assert file.read_bytes() == same

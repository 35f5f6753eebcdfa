"""Cost run as a page of Markdown."""

from __future__ import annotations

from nau_py.accuracy.report import CostReport
from nau_py.accuracy.tables import (
    make_comparison_grid,
    make_effect_grid,
    make_sample_grid,
    make_setting_grid,
    write_sentences,
)
from nau_py.reporting.table import to_markdown


def write_document(report: CostReport) -> str:
    """Write the numbers of a run as Markdown, to keep beside a project."""
    machine = ", ".join(f"{k} {v}" for k, v in report.machine.items())
    size = f"{report.size[0]} x {report.size[1]}"
    where = "inside the mask" if report.region == "mask" else "over the whole picture"
    parts = [
        f"# {report.project}: accuracy against time",
        f"Made by `nau-cost`; do not edit. Pipeline {report.pipeline}, {size} pixels, "
        f"{report.runs} runs of each setting, a seed each; errors are {where} unless it says "
        f"otherwise. {machine}.",
        "\n".join(f"- {line}" for line in write_sentences(report)),
    ]
    for grid in (
        make_sample_grid(report),
        make_setting_grid(report),
        make_comparison_grid(report),
        make_effect_grid(report),
    ):
        if grid is not None:
            parts.append("\n".join([f"## {grid.title}", "", *to_markdown(grid)]))
    return "\n\n".join(parts) + "\n"

"""A cost run as a page of Markdown."""

from __future__ import annotations

from nau_py.accuracy.report import CostReport
from nau_py.accuracy.tables import comparisons, effects, samples, sentences, settings
from nau_py.reporting.table import to_markdown


def document(report: CostReport) -> str:
    """The numbers of a run, to be kept beside a project."""
    machine = ", ".join(f"{k} {v}" for k, v in report.machine.items())
    size = f"{report.size[0]} x {report.size[1]}"
    where = "inside the mask" if report.region == "mask" else "over the whole picture"
    parts = [
        f"# {report.project}: accuracy against time",
        f"Made by `nau-cost`; do not edit. Pipeline {report.pipeline}, {size} pixels, "
        f"{report.runs} runs of each setting, a seed each; errors are {where} unless it says "
        f"otherwise. {machine}.",
        "\n".join(f"- {line}" for line in sentences(report)),
    ]
    for grid in (samples(report), settings(report), comparisons(report), effects(report)):
        if grid is not None:
            parts.append("\n".join([f"## {grid.title}", "", *to_markdown(grid)]))
    return "\n\n".join(parts) + "\n"

"""What ``nau-cost`` shows and writes: progress, table, files."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console
from rich.table import Table

from nau_py.diagnostic import error
from nau_py.errors import OutputError
from nau_py.files import write_bytes, write_text
from nau_py.model.location import NOWHERE

if TYPE_CHECKING:
    from nau_py.accuracy.cost import CostRun
    from nau_py.accuracy.report import CostReport


@contextmanager
def whole_progress(quiet: bool) -> Iterator[Callable[[str, float], None]]:
    """One bar with the time left, and what is being done; a line each in a pipe."""
    console = Console(stderr=True)
    if quiet:
        yield lambda what, part: None
        return
    if not console.is_terminal:
        last = [""]

        def line(what: str, part: float) -> None:
            if what != last[0]:
                last[0] = what
                console.print(f"{part:4.0%} {what}", highlight=False)

        yield line
        return
    from rich.progress import (
        BarColumn,
        Progress,
        TaskProgressColumn,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    columns = [
        TextColumn("{task.description:<40}"),
        BarColumn(),
        TaskProgressColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    ]
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("", total=1.0)
        yield lambda what, part: bar.update(task, completed=part, description=what)


def print_cost(report: CostReport) -> None:
    """The table of settings, and the answers."""
    from nau_py.accuracy.page import summary

    console = Console(width=None if Console().is_terminal else 160)
    table = Table(title=f"{report.project}: {report.pipeline}", title_justify="left")
    table.add_column("setting")
    for name in ("ms", "least to most", "rays"):
        table.add_column(name, justify="right")
    regions = list(report.settings[0].errors)
    for region in regions:
        table.add_column(f"{region}: rmse", justify="right")
        for name in ("95 %", "relMSE", "bias"):
            table.add_column(name, justify="right")
    table.add_column("front")
    for s in report.settings:
        cells = [
            s.label + (" (as it is)" if s.base else ""),
            f"{s.time.median:,.0f}",
            f"{s.time.range[0]:,.0f} to {s.time.range[1]:,.0f}",
            f"{sum(s.rays.values()):,}",
        ]
        for region in regions:
            e = s.errors[region]
            half = (e.rmse.interval[1] or 0) - (e.rmse.mean or 0)
            bias = "" if e.bias2 is None else f"{e.bias2**0.5:.4f}"
            cells += [f"{e.rmse.mean or 0:.4f}", f"±{half:.2g}", f"{e.relmse.mean or 0:.4g}", bias]
        mark = "better than the reference" if s.better_than_reference else ""
        table.add_row(*cells, "yes" if s.on_front else mark)
    console.print(table)
    for line in summary(report):
        console.print(line, highlight=False)
    if report.effects:
        console.print(_effects(report))


def _effects(report: CostReport) -> Table:
    table = Table(title="What each effect is worth", title_justify="left")
    table.add_column("without")
    table.add_column("called for")
    for name in ("rays saved", "ms saved", "rmse", "largest", "pixels"):
        table.add_column(name, justify="right")
    for e in report.effects:
        table.add_row(
            e.effect,
            "yes" if e.called_for else "no",
            f"{e.rays:,}",
            f"{e.ms:,.0f}",
            f"{e.rmse:.4g}",
            f"{e.largest:.4g}",
            f"{e.pixels:,}",
        )
    return table


def write_all(folder: Path, made: CostRun) -> None:
    """cost.json, cost.csv, cost.html and cost.png. Raises
    :class:`~nau_py.errors.OutputError`."""
    from nau_py.accuracy.page import front_png, page
    from nau_py.accuracy.report import to_csv, to_json

    try:
        folder.mkdir(parents=True, exist_ok=True)
        write_text(folder / "cost.json", to_json(made.report))
        write_text(folder / "cost.csv", to_csv(made.report))
        write_text(folder / "cost.html", page(made))
        write_bytes(folder / "cost.png", front_png(made.report))
    except OSError as problem:
        message = f"output '{folder}' cannot be written: {problem.strerror}"
        raise OutputError(error("E002", NOWHERE, message)) from None

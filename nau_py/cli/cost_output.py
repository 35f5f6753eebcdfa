"""Output of ``nau-cost``: progress, table, files."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console
from rich.table import Table

from nau_py.accuracy.report import to_csv, to_json
from nau_py.accuracy.tables import make_effect_grid, make_setting_grid, write_sentences
from nau_py.diagnostics.diagnostic import error
from nau_py.diagnostics.errors import OutputError
from nau_py.diagnostics.location import NOWHERE
from nau_py.process.files import write_bytes, write_text
from nau_py.reporting.chart import MISSING

if TYPE_CHECKING:
    from nau_py.accuracy.cost_run import CostRun
    from nau_py.accuracy.report import CostReport
    from nau_py.reporting.table import Grid


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
    """Print the table of settings, and the answers."""

    console = Console(width=None if Console().is_terminal else 160)
    console.print(
        _table(make_setting_grid(report, brief=True), f"{report.project}: {report.pipeline}")
    )
    for line in write_sentences(report):
        console.print(line, highlight=False)
    worth = make_effect_grid(report)
    if worth is not None:
        console.print(_table(worth, worth.title))


def _table(grid: Grid, title: str) -> Table:
    table = Table(title=title, title_justify="left")
    for number, name in enumerate(grid.head):
        table.add_column(name, justify="right" if number else "left")
    for row in grid.rows:
        table.add_row(*row)
    return table


def write_all(folder: Path, made: CostRun) -> None:
    """Write cost.json, cost.csv, cost.html and, with the extra ``plot``, cost.png.

    Raises :class:`~nau_py.OutputError`.
    """
    from nau_py.accuracy.front_chart import draw_front
    from nau_py.accuracy.page import write_page

    try:
        folder.mkdir(parents=True, exist_ok=True)
        write_text(folder / "cost.json", to_json(made.report))
        write_text(folder / "cost.csv", to_csv(made.report))
        write_text(folder / "cost.html", write_page(made))
        front = draw_front(made.report)
        if front is not None:
            write_bytes(folder / "cost.png", front)
        else:
            sys.stderr.write(f"{MISSING}\n")
    except OSError as problem:
        message = f"output '{folder}' cannot be written: {problem.strerror}"
        raise OutputError(error("E002", NOWHERE, message)) from None

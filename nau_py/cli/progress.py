"""Progress with time left, on a terminal only."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from nau_py.passes.frame import Progress, no_progress


@contextmanager
def progress_bar(quiet: bool) -> Iterator[Progress]:
    """Give a callback that shows the progress of each pass; silent in a pipe and with ``quiet``."""
    from rich.console import Console

    console = Console(stderr=True)
    if quiet or not console.is_terminal:
        yield no_progress
        return
    from rich.progress import Progress as Bar
    from rich.progress import TaskID, TimeRemainingColumn

    columns = [*Bar.get_default_columns()[:-1], TimeRemainingColumn()]
    with Bar(*columns, console=console, transient=True) as bar:
        tasks: dict[str, TaskID] = {}

        def show(name: str, done: int, total: int) -> None:
            if name not in tasks:
                tasks[name] = bar.add_task(name, total=total)
            bar.update(tasks[name], completed=done, total=total)

        yield show

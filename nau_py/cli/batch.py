"""``nau-run --batch``: every project of a folder, one page."""

from __future__ import annotations

import sys
from pathlib import Path

import typer

from nau_py.cli.common import FAILED, write_result
from nau_py.cli.lint import collect
from nau_py.cli.progress import progress_bar


def run_batch(
    folder: Path,
    report: Path | None,
    seconds: float,
    megabytes: float,
    jobs: int,
    more: list[str],
    quiet: bool,
) -> int:
    """Exit status: 0 where every project was rendered, 1 otherwise."""
    from nau_py.grading.grade import grade_projects
    from nau_py.grading.page import write_page
    from nau_py.process.supervised import Limits

    if not folder.is_dir():
        raise typer.BadParameter(f"'{folder}' is no folder")
    if report is None or report.suffix.lower() != ".html":
        raise typer.BadParameter("--batch writes a page: name it with --report FILE.html")
    projects = [p for p in collect([folder]) if not p.name.endswith((".mlib", ".mlib.yaml"))]
    if not projects:
        raise typer.BadParameter(f"'{folder}' holds no project file")
    limits = Limits(seconds, megabytes)
    with progress_bar(quiet) as progress:
        found = grade_projects(
            folder,
            projects,
            limits,
            more,
            lambda name, done, total: progress("batch", done, total),
            jobs,
        )
    write_result(report, write_page(f"Projects of {folder.resolve().name}", found, limits))
    for result in found:
        if result.status != "rendered":
            sys.stderr.write(f"{folder / result.name}: {result.status}: {result.reason}\n")
    return 0 if all(r.status == "rendered" for r in found) else FAILED

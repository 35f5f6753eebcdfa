"""Lint and render the projects of a class, each in child processes of its own."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from threading import Event
from typing import Any

from nau_py.process.supervised import Limits, Outcome, run_limited

_RUN = "nau_py.cli.run:main"
_LINT = "nau_py.cli.lint:main"


@dataclass(slots=True)
class Result:
    """Result of one project. ``status``: ``rendered``, ``wrong`` (it has errors) or ``stopped``;
    ``reason``: of the last two, one line; ``messages``: standard error of the run."""

    name: str
    status: str
    reason: str = ""
    seconds: float = 0.0
    diagnostics: list[dict[str, Any]] = field(default_factory=list)
    report: dict[str, Any] | None = None
    picture: bytes | None = None
    messages: str = ""

    @property
    def errors(self) -> int:
        return sum(1 for d in self.diagnostics if d["severity"] == "error")

    @property
    def warnings(self) -> int:
        return sum(1 for d in self.diagnostics if d["severity"] == "warning")


def grade_projects(
    folder: Path,
    projects: Sequence[Path],
    limits: Limits,
    more: Sequence[str],
    report_progress: Callable[[str, int, int], None],
    jobs: int = 1,
) -> list[Result]:
    """Lint and render projects; return the results in the order of ``projects``, below ``folder``.

    ``more``: further arguments of nau-run; ``jobs``: projects at a time, which disturb each
    other's times.
    """
    found = []
    interrupted = Event()
    names = [str(path.relative_to(folder)) for path in projects]
    with ThreadPoolExecutor(max_workers=jobs) as pool:
        waiting = pool.map(
            lambda path, name: grade_project(path, name, limits, more, interrupted.is_set),
            projects,
            names,
        )
        try:
            for name, result in zip(names, waiting):
                found.append(result)
                report_progress(name, len(found), len(projects))
        except BaseException:  # Ctrl-C: stop running projects, start no others
            interrupted.set()
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return found


def grade_project(
    path: Path,
    name: str,
    limits: Limits,
    more: Sequence[str],
    cancelled: Callable[[], bool] = lambda: False,
) -> Result:
    """Lint one project, then render it."""

    def run(entry: str, *arguments: str) -> Outcome:
        return run_limited(entry, arguments, limits, cancelled)

    linted = run(_LINT, "--format", "json", str(path))
    if linted.stopped:
        return Result(name, "stopped", f"linting: {linted.stopped}", linted.seconds)
    diagnostics = _parse_diagnostics(linted)
    with tempfile.TemporaryDirectory() as folder:
        picture, report = Path(folder, "picture.png"), Path(folder, "report.json")
        outcome = run(
            _RUN, str(path), "-o", str(picture), "--report", str(report), "--quiet", *more
        )
        found = Result(name, "rendered", "", outcome.seconds, diagnostics, messages=outcome.err)
        if outcome.stopped:
            found.status, found.reason = "stopped", outcome.stopped
        elif outcome.code != 0:
            found.status, found.reason = "wrong", _find_first_error(outcome)
        if picture.is_file():
            found.picture = picture.read_bytes()
        if report.is_file():
            found.report = json.loads(report.read_text())
    return found


def _parse_diagnostics(outcome: Outcome) -> list[dict[str, Any]]:
    try:
        found = json.loads(outcome.out)
    except ValueError:
        return []
    return list(found)


def _find_first_error(outcome: Outcome) -> str:
    lines = [line for line in outcome.err.splitlines() if "error[" in line]
    if lines:
        return lines[0].partition("error[")[2].partition("]: ")[2]
    rest = outcome.err.strip().splitlines()
    return rest[-1] if rest else f"nau-run ended with status {outcome.code}"

"""Linting and rendering every project of a folder; one that hangs or crashes costs only itself."""

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
    """What became of one project. ``status``: ``rendered``, ``wrong`` (diagnostics say why) or
    ``stopped`` (``why`` says it)."""

    name: str
    status: str
    why: str = ""
    seconds: float = 0.0
    diagnostics: list[dict[str, Any]] = field(default_factory=list)
    report: dict[str, Any] | None = None
    picture: bytes | None = None
    said: str = ""
    """What the run wrote to stderr."""

    @property
    def errors(self) -> int:
        return sum(1 for d in self.diagnostics if d["severity"] == "error")

    @property
    def warnings(self) -> int:
        return sum(1 for d in self.diagnostics if d["severity"] == "warning")


def grade(
    folder: Path,
    projects: Sequence[Path],
    limits: Limits,
    more: Sequence[str],
    told: Callable[[str, int, int], None],
    jobs: int = 1,
) -> list[Result]:
    """Results in the order of ``projects``, which lie below ``folder``. ``more``: further words for
    nau-run; ``jobs``: projects at a time, which disturb each other's times."""
    found = []
    ended = Event()
    names = [str(path.relative_to(folder)) for path in projects]
    with ThreadPoolExecutor(max_workers=jobs) as pool:
        waiting = pool.map(
            lambda path, name: grade_one(path, name, limits, more, ended.is_set), projects, names
        )
        try:
            for name, result in zip(names, waiting):
                found.append(result)
                told(name, len(found), len(projects))
        except BaseException:  # Ctrl-C: what runs is stopped, what waits never begins
            ended.set()
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return found


def grade_one(
    path: Path,
    name: str,
    limits: Limits,
    more: Sequence[str],
    cancelled: Callable[[], bool] = lambda: False,
) -> Result:
    """Lint, then render, one project."""

    def run(entry: str, *arguments: str) -> Outcome:
        return run_limited(entry, arguments, limits, cancelled)

    linted = run(_LINT, "--format", "json", str(path))
    if linted.stopped:
        return Result(name, "stopped", f"linting: {linted.stopped}", linted.seconds)
    diagnostics = _findings(linted)
    with tempfile.TemporaryDirectory() as folder:
        picture, report = Path(folder, "picture.png"), Path(folder, "report.json")
        outcome = run(
            _RUN, str(path), "-o", str(picture), "--report", str(report), "--quiet", *more
        )
        found = Result(name, "rendered", "", outcome.seconds, diagnostics, said=outcome.err)
        if outcome.stopped:
            found.status, found.why = "stopped", outcome.stopped
        elif outcome.code != 0:
            found.status, found.why = "wrong", _first_error(outcome)
        if picture.is_file():
            found.picture = picture.read_bytes()
        if report.is_file():
            found.report = json.loads(report.read_text())
    return found


def _findings(outcome: Outcome) -> list[dict[str, Any]]:
    try:
        found = json.loads(outcome.out)
    except ValueError:
        return []
    return list(found)


def _first_error(outcome: Outcome) -> str:
    lines = [line for line in outcome.err.splitlines() if "error[" in line]
    if lines:
        return lines[0].partition("error[")[2].partition("]: ")[2]
    rest = outcome.err.strip().splitlines()
    return rest[-1] if rest else f"nau-run ended with status {outcome.code}"

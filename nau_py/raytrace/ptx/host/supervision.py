"""Runs of compiled programs in a supervised process, as they can crash or loop without end."""

from __future__ import annotations

import os
import signal
import tempfile
from collections.abc import Sequence
from pathlib import Path
from time import monotonic

import numpy as np
from numpy.typing import NDArray

from nau_py.diagnostics.diagnostic import Diagnostic, error
from nau_py.model.linked import Project
from nau_py.model.raytrace import RaytracePass
from nau_py.process.supervised import SupervisedProcess
from nau_py.raytrace.programs.source import launches_ptx
from nau_py.raytrace.ptx.runtime.guarded import MARKS, SLOTS

PROGRAM_LIMIT = 60.0
"""Default seconds that a program may work at one launch index."""
_PERIOD = 0.1


def needs_supervision(project: Project, programs: str = "") -> bool:
    """Return True if ``project`` launches compiled programs and this process is not supervised.

    ``programs``: ``py`` selects the Python files beside the compiled ones.
    """
    passes = [p for pipeline in project.pipelines for p in pipeline.passes]
    traced = (p for p in passes if isinstance(p, RaytracePass))
    return MARKS not in os.environ and any(
        launches_ptx(p, project.folder, programs) for p in traced
    )


def run_supervised(
    entry: str, arguments: Sequence[str], project: Project, limit: float = PROGRAM_LIMIT
) -> tuple[int, list[Diagnostic]]:
    """Run a command, ``MODULE:FUNCTION`` with its arguments, in a supervised process.

    ``limit``: seconds that a program may work at one launch index. Returns the exit status, and a
    diagnostic (T016) if the process crashed or was ended.
    """
    with tempfile.TemporaryDirectory(prefix="nau-ptx-") as folder:
        file = Path(folder) / "marks"
        words = np.full(2 * SLOTS, -1, np.int64)
        words[:SLOTS] = 0
        file.write_bytes(words.tobytes())
        marks = _MarkReader(np.memmap(file, np.int64, "r", shape=(2 * SLOTS,)))
        environment = {MARKS: str(file)}
        worker = SupervisedProcess(
            entry, arguments, stdin=None, environment=environment, foreground=True
        )
        try:
            hung = worker.wait(check=lambda: marks.check_progress(limit), period=_PERIOD)
        except KeyboardInterrupt:  # the worker received the signal too, and ends in order
            hung = worker.wait()
        code = worker.exit_code or 0
        if code >= 0 and not hung:
            return code, []
        event = hung or f"ended the process by signal {signal.Signals(-code).name}"
        label, place = marks.describe()
        subject = label or f"project '{project.name}'"
        return 1, [error("T016", project.file.location, f"{subject} {event}{place}")]


class _MarkReader:
    """Marks that a supervised run leaves (see :mod:`nau_py.raytrace.ptx.runtime.guarded`)."""

    def __init__(self, words: NDArray[np.int64]) -> None:
        self._words = words
        self._last = np.array(words[SLOTS:])
        self._since = monotonic()

    def check_progress(self, limit: float) -> str:
        """Return an error if the launch indices in work are the same for ``limit`` seconds."""
        now = np.array(self._words[SLOTS:])
        if (now != self._last).any() or (now < 0).all():
            self._last, self._since = now, monotonic()
        return f"did not end within {limit:g} s" if self._waited() > limit else ""

    def _waited(self) -> float:
        return monotonic() - self._since

    def describe(self) -> tuple[str, str]:
        """Return the name of what ran, and the launch indices in work as words."""
        text = self._words[:SLOTS].tobytes().rstrip(b"\0").decode("utf-8", "replace")
        width, _, label = text.partition("\n")
        indices = sorted({int(i) for i in self._words[SLOTS:] if i >= 0})
        columns = int(width) if width.isdigit() else 0
        row = max(columns, 1)
        places = ", ".join(f"({i % row}, {i // row})" for i in indices[:4])
        return label, f" at launch index {places}" if places and columns > 0 else ""

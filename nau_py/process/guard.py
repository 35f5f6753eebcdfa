"""Runs ``nau-run`` in a child process where a project's compiled programs could end it."""

from __future__ import annotations

import os
import signal
import subprocess
import tempfile
from pathlib import Path
from time import monotonic

import numpy as np
from numpy.typing import NDArray

from nau_py.diagnostics.diagnostic import Diagnostic, error
from nau_py.model.linked import Project
from nau_py.model.raytrace import RaytracePass
from nau_py.process.isolation import isolated_environment, python_command
from nau_py.raytrace.programs.source import launches_ptx
from nau_py.raytrace.ptx.runtime.guarded import MARKS, SLOTS

Words = NDArray[np.int64]
_PERIOD = 0.1
_ENTRY = "nau_py.cli.run:main"


def needed(project: Project, programs: str) -> bool:
    """Whether a run of ``project`` must be guarded, and is not yet."""
    passes = [p for pipeline in project.pipelines for p in pipeline.passes]
    traced = (p for p in passes if isinstance(p, RaytracePass))
    return MARKS not in os.environ and any(
        launches_ptx(p, project.folder, programs) for p in traced
    )


def run_guarded(
    arguments: list[str], project: Project, limit: float
) -> tuple[int, list[Diagnostic]]:
    """The exit status of ``nau-run`` with these arguments, and what ended it early. ``limit``:
    seconds that a program may work at one launch index."""
    with tempfile.TemporaryDirectory(prefix="nau-ptx-") as folder:
        file = Path(folder) / "marks"
        words = np.full(2 * SLOTS, -1, np.int64)
        words[:SLOTS] = 0
        file.write_bytes(words.tobytes())
        seen = np.memmap(file, np.int64, "r", shape=(2 * SLOTS,))
        child = subprocess.Popen(
            python_command(_ENTRY, arguments), env=isolated_environment({MARKS: str(file)})
        )
        hung = _wait(child, seen, limit)
        if child.returncode >= 0 and not hung:
            return child.returncode, []
        return 1, [_said(project, seen, child.returncode, hung, limit)]


def _wait(child: subprocess.Popen[bytes], seen: Words, limit: float) -> bool:
    """Wait for the end; True where the child was ended because it hung."""
    before, since = np.array(seen[SLOTS:]), monotonic()
    while True:
        try:
            child.wait(_PERIOD)
            return False
        except subprocess.TimeoutExpired:
            now = np.array(seen[SLOTS:])
            if (now != before).any() or (now < 0).all():
                before, since = now, monotonic()
            elif monotonic() - since > limit:
                child.kill()
                child.wait()
                return True
        except KeyboardInterrupt:
            child.wait()  # it has had the signal too
            return False


def _said(project: Project, seen: Words, code: int, hung: bool, limit: float) -> Diagnostic:
    text = seen[:SLOTS].tobytes().rstrip(b"\0").decode("utf-8", "replace")
    width, _, about = text.partition("\n")
    indices = sorted({int(i) for i in seen[SLOTS:] if i >= 0})
    columns = int(width) if width.isdigit() else 0
    row = max(columns, 1)
    places = ", ".join(f"({i % row}, {i // row})" for i in indices[:4])
    where = f" at launch index {places}" if places and columns > 0 else ""
    if hung:
        what = f"did not end within {limit:g} s{where}"
    else:
        what = f"ended the process by signal {signal.Signals(-code).name}{where}"
    named = about or f"project '{project.name}'"
    return error("T016", project.file.location, f"{named} {what}")

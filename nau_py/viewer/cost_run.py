"""Run of ``nau-cost`` for the viewer, in a process of its own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from nau_py.process.supervised import DEVNULL, SupervisedProcess

_ENTRY = "nau_py.cli.cost:main"
_LAST_LINES = 12
"""Lines of its messages that the page shows."""


class ViewerCostRun:
    """One measurement at a time; ``folder`` takes its files."""

    def __init__(self, project: Path, folder: Path) -> None:
        self.project, self.folder = project, folder
        self._process: SupervisedProcess | None = None

    def start(self, pipeline: str) -> None:
        """Measure the saved files, unless a measurement is running."""
        if self._process is not None and self._process.running:
            return
        arguments = [str(self.project), "--pipeline", pipeline, "--out", str(self.folder)]
        with (self.folder / "log.txt").open("wb") as log:
            self._process = SupervisedProcess(_ENTRY, arguments, stdout=DEVNULL, stderr=log)

    def state(self) -> dict[str, Any]:
        """Return ``state``: none, running, done or failed; ``said``: its last messages."""
        if self._process is None:
            return {"state": "none", "said": []}
        code = self._process.exit_code
        lines = (self.folder / "log.txt").read_text("utf-8", "replace").splitlines()
        state = "running" if code is None else "done" if code == 0 else "failed"
        return {"state": state, "said": lines[-_LAST_LINES:]}

    def page(self) -> str | None:
        """Return the page of the last measurement; None if there is none."""
        found = sorted(self.folder.glob("*.html"))
        return found[0].read_text("utf-8") if found else None

    def stop(self) -> None:
        """End a running measurement."""
        if self._process is not None:
            self._process.stop()

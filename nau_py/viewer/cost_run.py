"""``nau-cost`` for the viewer: a process of its own, its page shown when it is done."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from nau_py.process.isolation import Process, start_python

_ENTRY = "nau_py.cli.cost:main"


class CostRun:
    """One measurement at a time; ``folder`` takes what it writes."""

    def __init__(self, project: Path, folder: Path) -> None:
        self.project, self.folder = project, folder
        self._process: Process | None = None

    def start(self, pipeline: str) -> None:
        """Measure the files as they are saved; nothing where a measurement is under way."""
        if self._process is not None and self._process.poll() is None:
            return
        options = ["--pipeline", pipeline, "--out", str(self.folder)]
        self._process = start_python(_ENTRY, [str(self.project), *options], self.folder / "log.txt")

    def state(self) -> dict[str, Any]:
        """``state``: none, running, done or failed; ``said``: the last lines of its messages."""
        if self._process is None:
            return {"state": "none", "said": []}
        code = self._process.poll()
        lines = (self.folder / "log.txt").read_text("utf-8", "replace").splitlines()
        state = "running" if code is None else "done" if code == 0 else "failed"
        return {"state": state, "said": lines[-12:]}

    def page(self) -> str | None:
        found = sorted(self.folder.glob("*.html"))
        return found[0].read_text("utf-8") if found else None

    def stop(self) -> None:
        if self._process is not None and self._process.poll() is None:
            self._process.kill()
            self._process.wait()

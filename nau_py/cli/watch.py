"""``nau-run --watch``: render again at every change, until it is interrupted."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from time import perf_counter, sleep, strftime

from nau_py.api import load
from nau_py.cli.common import say
from nau_py.diagnostics.errors import NauError
from nau_py.model.linked import Project
from nau_py.reporting.output import write_image
from nau_py.run.frame import Frame
from nau_py.run.reload import HotReload
from nau_py.run.renderer import Renderer

PERIOD = 0.02
"""Seconds between two checks of the files."""


def run_watch(
    path: Path,
    output: Path | None,
    make: Callable[[Project], Renderer],
    frame: int,
    show: Callable[[Frame], None],
) -> int:
    """Render, then follow the files. Errors are reported on stderr, and the last good picture
    stays. Ends by Ctrl-C, with exit status 0."""
    reload = HotReload(path, load, make, frame, output)
    sys.stderr.write(f"{strftime('%H:%M:%S')} watching {path}; Ctrl-C ends\n")
    try:
        _attempt(reload, reload.start, "first picture", output, show)
        while True:
            sleep(PERIOD)
            changed = reload.watch.take_settled_changes()
            if not changed:
                continue
            names = ", ".join(sorted(p.name for p in changed))
            _attempt(reload, lambda now=changed: reload.render(now), names, output, show)  # type: ignore[misc]
    except KeyboardInterrupt:
        return 0
    finally:
        reload.close()


def _attempt(
    reload: HotReload,
    render: Callable[[], Frame],
    why: str,
    output: Path | None,
    show: Callable[[Frame], None],
) -> None:
    begun = perf_counter()
    try:
        frame = render()
        if output is not None:
            write_image(output, frame.image)
    except NauError as problem:
        say(problem.diagnostics, reload.project.sources)
        sys.stderr.write(f"{strftime('%H:%M:%S')} {why}: wrong; the last picture stays\n")
        return
    ms = (perf_counter() - begun) * 1000
    sys.stderr.write(f"{strftime('%H:%M:%S')} {why}: {ms:.0f} ms\n")
    show(frame)

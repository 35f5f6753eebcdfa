"""A command in a process of its own, within limits of time and memory."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import monotonic, sleep

from nau_py.process.isolation import isolated_environment

POLL = 0.05
"""Seconds between two looks at what a process holds."""
LONGEST = 4_000_000
"""Bytes of output that are kept."""
LARGEST = 2**30
"""Bytes of the largest file that a process may write, its output included."""


@dataclass(frozen=True, slots=True)
class Ended:
    """How a process ended. ``code``: its status, or None where it was stopped; ``stopped``: why,
    or by which signal it died."""

    code: int | None
    seconds: float
    out: str
    err: str
    stopped: str = ""


def run_limited(
    words: Sequence[str],
    seconds: float,
    megabytes: float,
    give_up: Callable[[], bool] = lambda: False,
) -> Ended:
    """Run a command; kill it, and all that it started, beyond the limits or when ``give_up`` says
    so.

    Memory is what its process group holds resident; where /proc is missing only time is limited.
    """
    begun = monotonic()
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        process = subprocess.Popen(
            words,
            stdin=subprocess.DEVNULL,
            stdout=out,
            stderr=err,
            start_new_session=True,
            env=isolated_environment(),
        )
        stopped = ""
        try:
            while process.poll() is None:
                if monotonic() - begun > seconds:
                    stopped = f"it did not end within {seconds:g} s"
                elif resident(process.pid) > megabytes:
                    stopped = f"it took more than {megabytes:g} MB of memory"
                elif give_up():
                    stopped = "it was interrupted"
                if stopped:
                    break
                sleep(POLL)
        finally:
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()
        took = monotonic() - begun
        code: int | None = process.returncode
        if not stopped and code is not None and code < 0:
            stopped = f"it crashed ({signal.Signals(-code).name})"
        return Ended(None if stopped else code, took, _tail(out), _tail(err), stopped)


def _tail(file: object) -> str:
    assert hasattr(file, "seek")
    assert hasattr(file, "read")
    file.seek(0)
    data = file.read(LONGEST)
    return bytes(data).decode("utf-8", "replace")


def resident(group: int) -> float:
    """Megabytes that the processes of a group hold in memory; 0 where that cannot be told."""
    page = os.sysconf("SC_PAGE_SIZE")
    total = 0
    try:
        entries = [e for e in os.listdir("/proc") if e.isdigit()]
    except OSError:
        return 0.0
    for entry in entries:
        try:
            text = Path("/proc", entry, "stat").read_text()
            fields = text.rpartition(")")[2].split()  # the name before may hold blanks
            if int(fields[2]) == group:
                total += int(fields[21]) * page
        except (OSError, IndexError, ValueError):
            continue
    return total / 1e6

"""Child processes within limits of time and memory; ended together with all that they started."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import inf, isfinite
from time import monotonic
from typing import IO

import psutil

from nau_py.process.isolation import isolated_environment, python_command

PIPE = subprocess.PIPE
DEVNULL = subprocess.DEVNULL
POLL = 0.05
"""Seconds between two checks of the limits."""
KEPT_OUTPUT = 4_000_000
"""Bytes of each output of a process that are kept."""
LARGEST_FILE = 2**30
"""Bytes of the largest file that a limited process may write, its output included."""
_GRACE = 2.0
"""Seconds that a process gets to end after its pipe was closed or it was killed."""
Stream = int | IO[bytes] | None
"""Standard stream of a child: PIPE, DEVNULL, an open file, or None for the parent's own."""


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of one process and all that it starts: ``seconds`` and resident ``megabytes``."""

    seconds: float = inf
    megabytes: float = inf


@dataclass(frozen=True, slots=True)
class Outcome:
    """End of a process. ``code``: exit status, None if it was ended; ``stopped``: the reason, or
    the signal that it died of; ``out`` and ``err``: its output as text."""

    code: int | None
    seconds: float
    out: str
    err: str
    stopped: str = ""


class SupervisedProcess:
    """A Python process of this package, isolated from the working folder.

    ``entry``: ``MODULE:FUNCTION`` to call with ``arguments``. ``foreground``: keep it in the
    terminal's foreground group, so that Ctrl-C reaches it; else it leads a session of its own.
    """

    def __init__(
        self,
        entry: str,
        arguments: Sequence[str] = (),
        *,
        stdin: Stream = DEVNULL,
        stdout: Stream = None,
        stderr: Stream = None,
        environment: Mapping[str, str] | None = None,
        file_limit: int = 0,
        foreground: bool = False,
    ) -> None:
        self._leads_session = not foreground
        self._begun = monotonic()
        self._process = subprocess.Popen(
            python_command(entry, arguments, file_limit),
            stdin=stdin,
            stdout=stdout,
            stderr=stderr,
            env=isolated_environment(environment),
            start_new_session=self._leads_session,
        )
        self.stdin, self.stdout = self._process.stdin, self._process.stdout
        self._family: set[psutil.Process] = set()
        """The process and all descendants that were seen, those that left its group included."""
        with contextlib.suppress(psutil.Error):
            self._family.add(psutil.Process(self._process.pid))

    @property
    def running(self) -> bool:
        return self._process.poll() is None

    @property
    def exit_code(self) -> int | None:
        """Exit status, negative for a signal; None while it runs."""
        return self._process.poll()

    @property
    def seconds(self) -> float:
        """Seconds since the start."""
        return monotonic() - self._begun

    def describe_end(self) -> str:
        """Describe how it ended, as in ``signal 11`` or ``exit status 1``."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(_GRACE)
        code = self.exit_code
        if code is None:
            return "it was ended"
        return f"signal {-code}" if code < 0 else f"exit status {code}"

    def measure_memory(self) -> float:
        """Return the megabytes that it and its descendants hold resident."""
        self._find_descendants()
        total = 0
        for process in list(self._family):
            with contextlib.suppress(psutil.Error):
                total += process.memory_info().rss
        return total / 1e6

    def _find_descendants(self) -> None:
        """Add new descendants to the family, and remove those that have ended."""
        children: dict[int, list[psutil.Process]] = {}
        for process in psutil.process_iter():
            with contextlib.suppress(psutil.Error):
                children.setdefault(process.ppid(), []).append(process)
        found = {process for process in self._family if process.is_running()}
        open_ = list(found)
        while open_:
            new = set(children.get(open_.pop().pid, ())) - found
            found |= new
            open_ += new
        self._family = found

    def wait(
        self,
        limits: Limits = Limits(),
        check: Callable[[], str] = lambda: "",
        period: float = POLL,
    ) -> str:
        """Wait for the end, and return why it was stopped; empty if it ended by itself.

        It is stopped beyond ``limits``, or when ``check``, called every ``period`` seconds, returns
        a reason.
        """
        while True:
            try:
                self._process.wait(period)
                return ""
            except subprocess.TimeoutExpired:
                reason = self._beyond(limits) or check()
            if reason:
                self.stop()
                return reason

    def _beyond(self, limits: Limits) -> str:
        if self.seconds > limits.seconds:
            return f"it did not end within {limits.seconds:g} s"
        if isfinite(limits.megabytes) and self.measure_memory() > limits.megabytes:
            return f"it took more than {limits.megabytes:g} MB of memory"
        return ""

    def stop(self) -> None:
        """End the process and all that it started. A reader of :attr:`stdout` closes that."""
        self._find_descendants()
        if self._leads_session and os.name == "posix":
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(self._process.pid, signal.SIGKILL)
        for process in self._family:
            with contextlib.suppress(psutil.Error):
                process.kill()
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(_GRACE)
        if self.stdin is not None:
            with contextlib.suppress(OSError):
                self.stdin.close()


def run_limited(
    entry: str,
    arguments: Sequence[str],
    limits: Limits,
    cancelled: Callable[[], bool] = lambda: False,
) -> Outcome:
    """Run ``entry`` to its end, within ``limits`` and until ``cancelled`` returns True."""
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        process = SupervisedProcess(
            entry, arguments, stdout=out, stderr=err, file_limit=LARGEST_FILE
        )
        try:
            stopped = process.wait(limits, lambda: "it was interrupted" if cancelled() else "")
        finally:
            code, seconds = process.exit_code, process.seconds
            process.stop()  # what it left behind
        if stopped:
            code = None
        elif code is not None and code < 0:
            stopped = f"it crashed ({signal.Signals(-code).name})"
        return Outcome(code, seconds, _read(out), _read(err), stopped)


def _read(file: IO[bytes]) -> str:
    file.seek(0)
    return file.read(KEPT_OUTPUT).decode("utf-8", "replace")

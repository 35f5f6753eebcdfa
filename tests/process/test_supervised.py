"""Limits of child processes, and worker processes that answer requests (supervised, worker)."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path

import psutil
import pytest

from nau_py.process.supervised import Limits, SupervisedProcess, run_limited
from nau_py.process.worker import RequestRefused, Worker, WorkerLost

CHILD = '''
"""Entries of child processes for the tests."""
import os, subprocess, sys, time


def speak():
    print("x", *sys.argv[1:])
    print("y", file=sys.stderr)
    raise SystemExit(3)


def crash():
    os.abort()


def sleep():
    time.sleep(100)


def eat():
    kept = bytearray(200_000_000)
    kept[::4096] = b"x" * len(kept[::4096])
    time.sleep(100)


def leave_group():
    """Start a process in a session of its own, which no signal to this one's group reaches."""
    entry = [sys.executable, "-c", "import time; time.sleep(100)"]
    child = subprocess.Popen(entry, start_new_session=True)
    open(sys.argv[1] + "~", "w").write(str(child.pid))
    os.rename(sys.argv[1] + "~", sys.argv[1])
    time.sleep(100)


class Target:
    def __init__(self, setup, report):
        self.setup, self.report = setup, report

    def add(self, number):
        print("this goes to standard error")
        return self.setup + number

    def refuse(self):
        raise KeyError("there is no such thing")

    def crash(self):
        os.abort()

    def hang(self):
        time.sleep(100)

    def work(self):
        for step in range(1000):
            self.report("work", step, 1000)
            time.sleep(0.01)
        return "done"


def serve_target():
    from nau_py.process.worker import serve
    serve(Target)
'''


@pytest.fixture(autouse=True)
def child_module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Make the module of the entries importable in child processes."""
    (tmp_path / "child_entries.py").write_text(CHILD)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))


def test_a_process_that_ends_by_itself() -> None:
    outcome = run_limited("child_entries:speak", ["a"], Limits(20, 4000))
    assert (outcome.code, outcome.out, outcome.err, outcome.stopped) == (3, "x a\n", "y\n", "")


def test_a_crash_is_named() -> None:
    outcome = run_limited("child_entries:crash", [], Limits(20, 4000))
    assert outcome.stopped == "it crashed (SIGABRT)"


@pytest.mark.parametrize(
    "entry, limits, reason",
    [
        ("sleep", Limits(0.5), "it did not end within 0.5 s"),
        ("eat", Limits(20, 150), "it took more than 150 MB of memory"),
    ],
)
def test_limits(entry: str, limits: Limits, reason: str) -> None:
    outcome = run_limited(f"child_entries:{entry}", [], limits)
    assert (outcome.code, outcome.stopped) == (None, reason)
    assert outcome.seconds < 10


def test_cancelled() -> None:
    outcome = run_limited("child_entries:sleep", [], Limits(), lambda: True)
    assert (outcome.code, outcome.stopped) == (None, "it was interrupted")


def test_processes_that_it_starts_end_with_it(tmp_path: Path) -> None:
    """A child of a child does not outlive the limit, even in a session of its own."""
    note = tmp_path / "pid"
    outcome = run_limited("child_entries:leave_group", [str(note)], Limits(30, 4000), note.exists)
    assert outcome.stopped == "it was interrupted"
    deadline = time.monotonic() + 5
    pid = int(note.read_text())
    while psutil.pid_exists(pid) and psutil.Process(pid).status() != psutil.STATUS_ZOMBIE:
        assert time.monotonic() < deadline
        time.sleep(0.02)


@pytest.fixture
def worker() -> Iterator[Worker]:
    made = Worker("child_entries:serve_target", 40, "the adder", limit=3.0)
    yield made
    made.stop()


def test_requests(worker: Worker) -> None:
    assert not worker.running
    assert worker.request("add", 2) == 42
    with pytest.raises(RequestRefused, match="there is no such thing"):
        worker.request("refuse")
    assert worker.running


def test_a_worker_is_started_again(worker: Worker) -> None:
    with pytest.raises(WorkerLost, match=r"the adder's process ended while it worked \(signal 6\)"):
        worker.request("crash")
    assert worker.request("add", 1) == 41
    worker.limit = 0.3
    with pytest.raises(
        WorkerLost, match=r"the adder gave no sign of work for 0\.3 s and was ended"
    ):
        worker.request("hang")
    worker.limit = 3.0
    assert worker.request("add", 3) == 43


def test_only_cancellable_requests_are_cancelled(worker: Worker) -> None:
    worker.request("add", 1)
    worker.is_outdated = lambda: True
    begun = time.monotonic()
    assert worker.request("work", cancellable=True) is None
    assert time.monotonic() - begun < 5
    assert worker.request("add", 1) == 41
    worker.is_outdated = lambda: False
    worker.cancel()  # nothing is in work
    assert worker.request("add", 2) == 42


def test_a_worker_ends_with_its_parent(worker: Worker) -> None:
    """Its channel closes, and it ends although it works."""
    worker.request("add", 1)
    process = worker._process
    assert isinstance(process, SupervisedProcess)
    assert process.stdin is not None
    worker._channel.send((99, "hang", ()))  # type: ignore[union-attr]
    process.stdin.close()
    assert process.wait(Limits(5)) == ""
    assert process.exit_code == 0

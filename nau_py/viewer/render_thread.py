"""Render thread of the viewer: redraws when its state or the files change."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import replace
from pathlib import Path
from queue import Empty, SimpleQueue
from time import monotonic
from typing import Any

from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.diagnostics.errors import NauError
from nau_py.passes.frame import RunOptions
from nau_py.process.worker import LIMIT, RequestRefused, Worker, WorkerLost
from nau_py.run.used_files import SHADER
from nau_py.viewer.request import PictureRequest, PictureStep
from nau_py.viewer.state import ViewerState

PERIOD = 0.03
"""Seconds between two checks of the files while there is nothing to do."""
MOST_STEPS = 64
"""Largest number of full pictures that are averaged."""
STILL = 0.25
"""Seconds without a change until a full picture is rendered."""
_Subject = tuple[PictureRequest, int]
"""Request of a picture, and the count of the state of the files."""


def make_worker(path: Path, options: RunOptions, limit: float = LIMIT) -> Worker:
    """Make the worker process that renders a project. ``limit``: seconds until it counts as hung
    and is ended."""
    worker = Worker("nau_py.viewer.worker:main", (str(path), options), "the renderer", limit)
    worker.hint = ": a shader may hang the driver's compiler, or a program may not end"
    return worker


class RenderThread:
    """Thread that keeps the picture of ``state`` up to date through ``worker``: first it reloads
    changed files, then it answers requests, then it renders."""

    def __init__(self, state: ViewerState, worker: Worker) -> None:
        self.state, self.worker = state, worker
        worker.is_outdated = state.watch.has_changes
        self._finished: _Subject | None = None
        self._coarse: _Subject | None = None
        self._failed: _Subject | None = None
        self._scene_of = -1
        self._jobs: SimpleQueue[tuple[str, tuple[Any, ...], Future[Any]]] = SimpleQueue()
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._run, name="render", daemon=True)

    def start(self) -> None:
        self._thread.start()

    def close(self) -> None:
        """End the thread and the worker."""
        self._ending.set()
        self.worker.stop()
        if self._thread.is_alive():
            self._thread.join(2.0)
        self.worker.stop()  # the thread may have started it again meanwhile

    def do(self, command: dict[str, Any]) -> None:
        """Run :meth:`ViewerState.do`; the picture in work is cancelled."""
        self.state.do(command)
        self.worker.cancel()

    def request(self, name: str, *arguments: Any) -> Future[Any]:
        """Call a method of :class:`~nau_py.viewer.worker.RenderWorker` in the worker process.
        The future raises :class:`~nau_py.NauError`, ``WorkerLost`` or ``RequestRefused``."""
        future: Future[Any] = Future()
        self._jobs.put((name, arguments, future))
        self.worker.cancel()
        return future

    def _run(self) -> None:
        while not self._ending.is_set():
            try:
                if not self._do_next():
                    self._ending.wait(PERIOD)
            except Exception as bug:  # shown by the page; the next change is a new attempt
                self._report([], f"{type(bug).__name__}: {bug}", self._subject())

    def _subject(self) -> _Subject:
        with self.state.lock:
            return self.state.picture_request(), self.state.attempt

    def _do_next(self) -> bool:
        """Do the next task. Return False if there is none."""
        changed = self.state.watch.take_settled_changes(self._ending.wait)
        if changed:
            self._reload({str(path): kind for path, kind in changed.items()})
            return True
        if self.state.saved:
            self.state.saved = False
            self._reload({str(self.state.path): "project"})
            return True
        try:
            name, arguments, future = self._jobs.get_nowait()
        except Empty:
            return self._picture()
        try:
            future.set_result(self.worker.request(name, *arguments))
        except (NauError, WorkerLost, RequestRefused) as problem:
            future.set_exception(problem)
        return True

    def _reload(self, changed: dict[str, str]) -> None:
        """Reload changed files. The last good picture stays if they have errors."""
        if set(changed.values()) != {SHADER}:  # lint does not read shaders
            self.state.reload()
        with self.state.lock:
            self.state.attempt += 1
            self.state.render_diagnostics = []
        if self.worker.running:
            self._attempt(lambda: self.worker.request("reload", changed), self._subject())

    def _picture(self) -> bool:
        state = self.state
        now = self._subject()
        shown = state.picture
        if not state.sound or not state.pipeline or now == self._failed:
            return False
        if now != self._finished:
            if now != self._coarse:
                if self._attempt(lambda: self._show(now, coarse=True), now):
                    self._coarse = now
                return True
            if state.playing:
                with state.lock:
                    state.frame += 1
                return True
            if monotonic() - state.moved < STILL:
                return False
        elif state.playing:
            self._finished = None
            return True
        elif shown is None or not shown.more or shown.steps >= MOST_STEPS:
            return False
        if self._attempt(lambda: self._show(now, coarse=False), now):
            self._finished = now
        return True

    def _show(self, now: _Subject, coarse: bool) -> bool:
        state = self.state
        found: PictureStep | None = self.worker.request("render", now[0], coarse, cancellable=True)
        if found is None:
            return False
        if self._scene_of != now[1]:
            state.scene, self._scene_of = self.worker.request("summarize_scene"), now[1]
        news = state.failed or state.render_diagnostics != found.diagnostics
        with state.lock:
            if coarse and state.picture is not None:  # it has no targets of its own
                found = replace(found, targets=state.picture.targets)
            state.picture = found
            if state.failed:
                state.note = ""
            state.render_diagnostics, state.failed = found.diagnostics, False
            state.pictures += 1
            first = not coarse and found.steps == 1
            state.full += first
        state.announce(content=first or news)
        return True

    def _attempt(self, work: Callable[[], Any], now: _Subject) -> bool:
        """Do work of the renderer; report errors, and do not try again until something changes."""
        try:
            return work() is not False
        except NauError as problem:
            shown = "the last good picture is shown" if self.state.picture else ""
            self._report(problem.diagnostics, shown, now)
        except (WorkerLost, RequestRefused) as problem:
            self._report([], str(problem), now)
        return False

    def _report(self, found: list[Diagnostic], note: str, now: _Subject) -> None:
        if self._ending.is_set():
            return
        state = self.state
        with state.lock:
            state.render_diagnostics, state.note = found, note
            state.failed, state.playing = True, False
            self._failed = now
        state.announce()

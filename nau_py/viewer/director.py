"""The thread that keeps the viewer's picture in step with its desk and with the files."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import replace
from queue import Empty, SimpleQueue
from time import monotonic
from typing import Any

from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.diagnostics.errors import NauError
from nau_py.process.renderer_child import Child, Lost, Refused
from nau_py.run.used_files import SHADER
from nau_py.viewer.desk import Desk
from nau_py.viewer.studio import Shown, Wanted

PERIOD = 0.03
"""Seconds between two looks at the files, while nothing is to do."""
MOST_STEPS = 64
"""Pictures of full size that are averaged, at most."""
STILL = 0.25
"""Seconds without a change until the picture gets its full size."""
_Done = tuple[Wanted, int]
"""What was rendered, and of which state of the files."""


class Director:
    """Asks ``child`` for what ``desk`` wants: files first, then questions, then the picture."""

    def __init__(self, desk: Desk, child: Child) -> None:
        self.desk, self.child = desk, child
        child.stale = desk.stale
        self._done: _Done | None = None
        self._coarse: _Done | None = None
        self._failed: _Done | None = None
        self._facts_of = -1
        self._jobs: SimpleQueue[tuple[str, tuple[Any, ...], Future[Any]]] = SimpleQueue()
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._run, name="director", daemon=True)

    def start(self) -> None:
        self._thread.start()

    def close(self) -> None:
        """End the thread and the renderer."""
        self._ending.set()
        self.child.stop()
        if self._thread.is_alive():
            self._thread.join(2.0)

    def do(self, command: dict[str, Any]) -> None:
        """:meth:`Desk.do`; the picture in work is dropped."""
        self.desk.do(command)
        self.child.cancel()

    def ask(self, name: str, *arguments: Any) -> Future[Any]:
        """Ask the renderer for something beside the picture (see the methods of ``Studio``).
        The future raises :class:`~nau_py.NauError`, ``Lost`` or ``Refused``."""
        future: Future[Any] = Future()
        self._jobs.put((name, arguments, future))
        self.child.cancel()
        return future

    def _run(self) -> None:
        while not self._ending.is_set():
            try:
                if not self._one():
                    self._ending.wait(PERIOD)
            except Exception as bug:  # the page says it; the next change is a new attempt
                self._wrong([], f"{type(bug).__name__}: {bug}", self._now())

    def _now(self) -> _Done:
        with self.desk.lock:
            return self.desk.wanted(), self.desk.attempt

    def _one(self) -> bool:
        """Do the next thing. False where there is nothing to do."""
        changed = self.desk.look()
        if changed:
            self._ending.wait(PERIOD)  # an editor may write in several steps
            self._take(changed | self.desk.look())
            return True
        if self.desk.saved:
            self.desk.saved = False
            self._take({str(self.desk.path): "project"})
            return True
        try:
            name, arguments, future = self._jobs.get_nowait()
        except Empty:
            return self._picture()
        try:
            future.set_result(self.child.ask(name, *arguments))
        except (NauError, Lost, Refused) as problem:
            future.set_exception(problem)
        return True

    def _take(self, changed: dict[str, str]) -> None:
        """Take in changed files. The last good picture stays where they are wrong."""
        if set(changed.values()) != {SHADER}:  # lint does not look into those
            self.desk.reload()
        with self.desk.lock:
            self.desk.attempt += 1
            self.desk.wrong = []
        if self.child.running:
            self._guarded(lambda: self.child.ask("reload", changed), self._now())

    def _picture(self) -> bool:
        desk = self.desk
        now = self._now()
        shown = desk.picture
        if not desk.sound or not desk.pipeline or now == self._failed:
            return False
        if now != self._done:
            if now != self._coarse:
                if self._guarded(lambda: self._show(now, coarse=True), now):
                    self._coarse = now
                return True
            if desk.playing:
                with desk.lock:
                    desk.frame += 1
                return True
            if monotonic() - desk.moved < STILL:
                return False
        elif desk.playing:
            self._done = None
            return True
        elif shown is None or not shown.more or shown.steps >= MOST_STEPS:
            return False
        if self._guarded(lambda: self._show(now, coarse=False), now):
            self._done = now
        return True

    def _show(self, now: _Done, coarse: bool) -> bool:
        desk = self.desk
        found: Shown | None = self.child.ask("render", now[0], coarse, droppable=True)
        if found is None:
            return False
        if self._facts_of != now[1]:
            desk.facts, self._facts_of = self.child.ask("facts"), now[1]
        told = desk.failed or desk.wrong != found.diagnostics
        with desk.lock:
            if coarse and desk.picture is not None:  # it has no targets of its own
                found = replace(found, targets=desk.picture.targets)
            desk.picture = found
            if desk.failed:
                desk.note = ""
            desk.wrong, desk.failed = found.diagnostics, False
            desk.pictures += 1
            first = not coarse and found.steps == 1
            desk.full += first
        desk.news(content=first or told)
        return True

    def _guarded(self, work: Callable[[], Any], now: _Done) -> bool:
        """Do what asks the renderer; what goes wrong is said, and not tried again by itself."""
        try:
            return work() is not False
        except NauError as problem:
            shown = "the last good picture is shown" if self.desk.picture else ""
            self._wrong(problem.diagnostics, shown, now)
        except (Lost, Refused) as problem:
            self._wrong([], str(problem), now)
        return False

    def _wrong(self, said: list[Diagnostic], note: str, now: _Done) -> None:
        if self._ending.is_set():
            return
        desk = self.desk
        with desk.lock:
            desk.wrong, desk.note, desk.failed, desk.playing = said, note, True, False
            self._failed = now
        desk.news()

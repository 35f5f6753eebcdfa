"""The renderer's process, as the viewer sees it: asked, waited for, ended where it hangs.

What a project's programs or the driver's compiler do to that process costs nothing but it.
"""

from __future__ import annotations

import multiprocessing
import os
import threading
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path
from time import monotonic
from typing import Any

from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.diagnostics.errors import NauError
from nau_py.passes.frame import RunOptions

LIMIT = 60.0
"""Seconds without an answer or a sign of work until the process counts as hung."""
_SLICE = 0.02
_GRACE = 2.0
_CANCEL, _WORK = "cancel", "work"


class Lost(Exception):
    """The process is gone, or was ended because it hung; the text says which."""


class Refused(Exception):
    """What was asked for does not exist; the text says why."""


def run(path: str, options: RunOptions, pipe: Connection) -> None:
    """The child's work: answer ``(number, name, arguments)`` until the pipe closes."""
    from nau_py.viewer.studio import Cancelled, Studio

    present = 0

    def tell(name: str, done: int, total: int) -> None:
        while pipe.poll():
            if pipe.recv() == (_CANCEL, present):
                raise Cancelled
        pipe.send((_WORK, (name, done, total)))

    studio = Studio(Path(path), options, tell)
    while True:
        try:
            asked = pipe.recv()
        except (EOFError, OSError):
            return
        if asked[0] == _CANCEL:
            continue  # it came after the answer
        present, name, arguments = asked
        try:
            answer: tuple[str, Any] = ("done", getattr(studio, name)(*arguments))
        except Cancelled:
            answer = ("cancelled", None)
        except NauError as problem:
            answer = ("wrong", problem.diagnostics)
        except (KeyError, ValueError) as problem:
            answer = ("refused", str(problem.args[0]) if problem.args else str(problem))
        except Exception as bug:
            answer = ("refused", f"{type(bug).__name__}: {bug}")
        try:
            pipe.send(answer)
        except OSError:
            return


class Child:
    """One process; started at the first question, and again after it was lost. Questions are asked
    by one thread; :meth:`cancel` may be called by any."""

    def __init__(self, path: Path, options: RunOptions, limit: float = LIMIT) -> None:
        self.path, self.options, self.limit = path, options, limit
        self.stale: Callable[[], bool] = lambda: False
        """Whether what is being rendered is not wanted any more; looked at while waiting."""
        self._process: Any = None
        self._pipe: Connection | None = None
        self._number = 0
        self._droppable: int | None = None
        """The number of the question in work, if it may be cancelled."""
        self._asking = threading.Lock()
        self._writing = threading.Lock()

    @property
    def running(self) -> bool:
        return self._process is not None and self._process.is_alive()

    def _start(self) -> Connection:
        if not self.running or self._pipe is None:
            self.stop()
            context = multiprocessing.get_context("spawn")
            mine, theirs = context.Pipe()
            arguments = (str(self.path), self.options, theirs)
            self._process = context.Process(target=run, args=arguments, daemon=True)
            os.environ["PYTHONSAFEPATH"] = "1"  # a spawned Python inherits the environment
            self._process.start()
            theirs.close()
            self._pipe = mine
        return self._pipe

    def ask(self, name: str, *arguments: Any, droppable: bool = False) -> Any:
        """What a method of :class:`~nau_py.viewer.studio.Studio` returns; None where it was
        cancelled, which only a ``droppable`` question can be. Raises
        :class:`~nau_py.NauError`, :class:`Lost`, :class:`Refused`."""
        with self._asking:
            pipe = self._start()
            self._number += 1
            try:
                with self._writing:
                    pipe.send((self._number, name, arguments))
                self._droppable = self._number if droppable else None
                return self._answer(pipe)
            except (EOFError, OSError):
                code = self._ended()
                raise Lost(f"the renderer's process ended while it worked ({code})") from None
            finally:
                self._droppable = None

    def _answer(self, pipe: Connection) -> Any:
        heard = monotonic()
        cancelled = False
        while True:
            if self._droppable is not None and not cancelled and self.stale():
                self.cancel()
                cancelled = True
            if pipe.poll(_SLICE):
                kind, value = pipe.recv()
                heard = monotonic()
                if kind == _WORK:
                    continue
                if kind == "wrong":
                    found: list[Diagnostic] = value
                    raise NauError(found)
                if kind == "refused":
                    raise Refused(value)
                return value
            if monotonic() - heard > self.limit:
                self.stop()
                raise Lost(
                    f"the renderer gave no sign of work for {self.limit:g} s and was ended: a "
                    "shader may hang the driver's compiler, or a program may not end"
                )

    def _ended(self) -> str:
        process = self._process
        if process is None:
            return "it was ended"
        process.join(_GRACE)
        code = process.exitcode
        self.stop()
        return f"signal {-code}" if code is not None and code < 0 else f"exit status {code}"

    def cancel(self) -> None:
        """What is being rendered is not wanted any more. Nothing where that is not droppable."""
        pipe, number = self._pipe, self._droppable
        if pipe is not None and number is not None:
            try:
                with self._writing:
                    pipe.send((_CANCEL, number))
            except OSError:
                return  # the asking thread finds that out

    def stop(self) -> None:
        """End the process."""
        if self._pipe is not None:
            self._pipe.close()
        if self._process is not None and self._process.is_alive():
            self._process.kill()
            self._process.join(_GRACE)
        self._process, self._pipe = None, None

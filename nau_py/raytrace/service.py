"""Work that only the main thread may do (OpenGL), asked for by the threads that trace."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Future
from queue import Empty, SimpleQueue
from typing import Any

_PATIENCE = 0.002
"""Seconds to wait for a request before looking whether the tiles are done."""


class MainThread:
    """Runs functions on the thread that made it."""

    def __init__(self) -> None:
        self._owner = threading.get_ident()
        self._requests: SimpleQueue[tuple[Future[Any], Callable[..., Any], tuple[Any, ...]]]
        self._requests = SimpleQueue()

    def call(self, function: Callable[..., Any], *arguments: Any) -> Any:
        """What ``function`` returns or raises on the main thread; waits for it."""
        if threading.get_ident() == self._owner:
            return function(*arguments)
        future: Future[Any] = Future()
        self._requests.put((future, function, arguments))
        return future.result()

    def results(self, futures: list[Future[Any]]) -> Iterator[Any]:
        """The results of ``futures`` in order, serving requests while they are computed."""
        for awaited in futures:
            while not awaited.done():
                self._serve()
            yield awaited.result()

    def abandon(self, futures: list[Future[Any]]) -> None:
        """Cancel ``futures``; those that run get no answer. Returns when they have ended."""
        for future in futures:
            future.cancel()
        while not all(future.done() for future in futures):
            try:
                waiting, _, _ = self._requests.get(timeout=_PATIENCE)
            except Empty:
                continue
            waiting.set_exception(CancelledError())

    def _serve(self) -> None:
        try:
            future, function, arguments = self._requests.get(timeout=_PATIENCE)
        except Empty:
            return
        try:
            future.set_result(function(*arguments))
        except BaseException as problem:
            future.set_exception(problem)

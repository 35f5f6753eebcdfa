"""Work that only the main thread may do (OpenGL), asked for by the threads that trace."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Future
from queue import SimpleQueue
from typing import Any

Request = tuple[Future[Any], Callable[..., Any], tuple[Any, ...]]


class MainThread:
    """Runs functions on the thread that made it."""

    def __init__(self) -> None:
        self._owner = threading.get_ident()
        self._requests: SimpleQueue[Request | None] = SimpleQueue()
        """What is asked for; None where a tile has ended, so that waiting needs no clock."""

    def call(self, function: Callable[..., Any], *arguments: Any) -> Any:
        """What ``function`` returns or raises on the main thread; waits for it."""
        if threading.get_ident() == self._owner:
            return function(*arguments)
        future: Future[Any] = Future()
        self._requests.put((future, function, arguments))
        return future.result()

    def results(self, futures: list[Future[Any]]) -> Iterator[Any]:
        """The results of ``futures`` in order, serving requests while they are computed."""
        for future in futures:
            future.add_done_callback(self._wake)
        for awaited in futures:
            while not awaited.done():
                request = self._requests.get()
                if request is not None:
                    _serve(request)
            yield awaited.result()

    def abandon(self, futures: list[Future[Any]]) -> None:
        """Cancel ``futures``; those that run get no answer. Returns when they have ended."""
        for future in futures:
            future.add_done_callback(self._wake)
            future.cancel()
        while not all(future.done() for future in futures):
            request = self._requests.get()
            if request is not None:
                request[0].set_exception(CancelledError())

    def _wake(self, _: Future[Any]) -> None:
        self._requests.put(None)


def _serve(request: Request) -> None:
    future, function, arguments = request
    try:
        future.set_result(function(*arguments))
    except BaseException as problem:
        future.set_exception(problem)

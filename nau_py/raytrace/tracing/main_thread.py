"""Calls that only the main thread may make (OpenGL), requested by the threads that trace."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Future
from queue import SimpleQueue
from typing import Any

Request = tuple[Future[Any], Callable[..., Any], tuple[Any, ...]]


class MainThread:
    """Runs functions on the thread that created it, on request of other threads."""

    def __init__(self) -> None:
        self._owner = threading.get_ident()
        self._requests: SimpleQueue[Request | None] = SimpleQueue()
        """Pending requests; None when a tile has ended, so that waiting needs no polling."""

    def call(self, function: Callable[..., Any], *arguments: Any) -> Any:
        """Call ``function`` on the main thread, and return its result or raise its exception."""
        if threading.get_ident() == self._owner:
            return function(*arguments)
        future: Future[Any] = Future()
        self._requests.put((future, function, arguments))
        return future.result()

    def iterate_results(self, futures: list[Future[Any]]) -> Iterator[Any]:
        """Yield the results of ``futures`` in order, and serve requests while they are computed."""
        for future in futures:
            future.add_done_callback(self._wake)
        for awaited in futures:
            while not awaited.done():
                request = self._requests.get()
                if request is not None:
                    _serve(request)
            yield awaited.result()

    def cancel(self, futures: list[Future[Any]]) -> None:
        """Cancel ``futures`` and the requests of those that run; return when they have ended."""
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
    """Run the function of a request and set its result or exception."""
    future, function, arguments = request
    try:
        future.set_result(function(*arguments))
    except BaseException as problem:
        future.set_exception(problem)

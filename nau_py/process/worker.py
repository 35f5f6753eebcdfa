"""A worker process that answers requests one by one, and is started again after a failure.

A crash or a hang of the worker costs nothing but the request in work.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from time import monotonic
from typing import Any

from nau_py.diagnostics.errors import NauError
from nau_py.process.channel import Channel, open_child_channel
from nau_py.process.supervised import PIPE, SupervisedProcess

LIMIT = 60.0
"""Seconds without an answer or a sign of progress until a worker counts as hung."""
_SLICE = 0.02
"""Seconds between two checks while waiting for an answer."""
_CANCEL = "cancel"
_PROGRESS, _DONE, _CANCELLED, _DIAGNOSED, _REFUSED = (
    "progress",
    "done",
    "cancelled",
    "diagnosed",
    "refused",
)

ReportProgress = Callable[[str, int, int], None]
"""``report(name, done, total)``: a sign of progress of the request in work."""


class WorkerLost(Exception):
    """The worker process crashed, or was ended because it hung; the text names the cause."""


class RequestRefused(Exception):
    """A request named something that does not exist; the text names it."""


class RequestCancelled(NauError):
    """The answer to the request in work is no longer needed."""

    def __init__(self) -> None:
        super().__init__([])


def serve(make_target: Callable[[Any, ReportProgress], object]) -> None:
    """Answer requests in a worker process until its parent closes the channel.

    ``make_target`` gets the ``setup`` of :class:`Worker` and a function that reports progress,
    which raises :class:`RequestCancelled` in the middle of a cancelled request. Requests name the
    methods of the object that it returns.
    """
    channel = open_child_channel()
    current = 0

    def report(name: str, done: int, total: int) -> None:
        while channel.pending():
            if channel.receive() == (_CANCEL, current):
                raise RequestCancelled
        channel.send((_PROGRESS, (name, done, total)))

    target = make_target(channel.receive(), report)
    while True:
        try:
            message = channel.receive()
            if message[0] == _CANCEL:
                continue  # it came after the answer
            current, name, arguments = message
            channel.send(_answer(target, name, arguments))
        except (EOFError, OSError):
            return


def _answer(target: object, name: str, arguments: tuple[Any, ...]) -> tuple[str, Any]:
    """Call a method of ``target``; return the kind of the outcome and its value."""
    try:
        return _DONE, getattr(target, name)(*arguments)
    except RequestCancelled:
        return _CANCELLED, None
    except NauError as problem:
        return _DIAGNOSED, problem.diagnostics
    except (KeyError, ValueError) as problem:
        return _REFUSED, str(problem.args[0]) if problem.args else str(problem)
    except Exception as bug:
        return _REFUSED, f"{type(bug).__name__}: {bug}"


class Worker:
    """One worker process; started at the first request, and again after it was lost.

    ``entry``: ``MODULE:FUNCTION`` that calls :func:`serve`; ``setup``: first message to it;
    ``label``: subject of messages about its end. Requests are sent by one thread;
    :meth:`cancel` may be called by any.
    """

    def __init__(self, entry: str, setup: object, label: str, limit: float = LIMIT) -> None:
        self.entry, self.setup, self.label, self.limit = entry, setup, label, limit
        self.is_outdated: Callable[[], bool] = lambda: False
        """Called while waiting: True if the answer in work is no longer needed."""
        self.hint = ""
        """Likely causes of a hang, for the message."""
        self._process: SupervisedProcess | None = None
        self._channel: Channel | None = None
        self._number = 0
        self._cancellable: int | None = None
        """Number of the request in work, if it may be cancelled."""
        self._requesting = threading.Lock()

    @property
    def running(self) -> bool:
        return self._process is not None and self._process.running

    def _start(self) -> Channel:
        if not self.running or self._channel is None:
            self.stop()
            process = SupervisedProcess(self.entry, stdin=PIPE, stdout=PIPE)
            assert process.stdin is not None
            assert process.stdout is not None
            self._process = process
            self._channel = Channel(process.stdout, process.stdin)
            self._channel.send(self.setup)
        return self._channel

    def request(self, name: str, *arguments: Any, cancellable: bool = False) -> Any:
        """Call a method of the worker's target and return its result; None for a cancelled
        request, which only a ``cancellable`` one can be. Raises :class:`~nau_py.NauError`,
        :class:`WorkerLost`, :class:`RequestRefused`."""
        with self._requesting:
            self._number += 1
            try:
                channel = self._start()
                channel.send((self._number, name, arguments))
                self._cancellable = self._number if cancellable else None
                return self._receive(channel)
            except (EOFError, OSError):
                end = self._process.describe_end() if self._process else "it was ended"
                self.stop()
                raise WorkerLost(f"{self.label}'s process ended while it worked ({end})") from None
            finally:
                self._cancellable = None

    def _receive(self, channel: Channel) -> Any:
        last_sign = monotonic()
        cancelled = False
        while True:
            if self._cancellable is not None and not cancelled and self.is_outdated():
                self.cancel()
                cancelled = True
            try:
                kind, value = channel.receive(_SLICE)
            except TimeoutError:
                if monotonic() - last_sign > self.limit:
                    self.stop()
                    raise WorkerLost(
                        f"{self.label} gave no sign of work for {self.limit:g} s and was ended"
                        f"{self.hint}"
                    ) from None
                continue
            last_sign = monotonic()
            if kind == _PROGRESS:
                continue
            if kind == _DIAGNOSED:
                raise NauError(value)
            if kind == _REFUSED:
                raise RequestRefused(value)
            return value

    def cancel(self) -> None:
        """Cancel the request in work, if it is cancellable."""
        channel, number = self._channel, self._cancellable
        if channel is not None and number is not None:
            try:
                channel.send((_CANCEL, number))
            except OSError:
                return  # the requesting thread finds that out

    def stop(self) -> None:
        """End the process."""
        process, self._process, self._channel = self._process, None, None
        if process is not None:
            process.stop()

"""Messages between a process and its child, pickled over the child's standard streams."""

from __future__ import annotations

import os
import pickle
import queue
import sys
import threading
from typing import IO, Any


class Channel:
    """Two streams that carry Python values. A thread reads, so that receiving can time out.

    ``exit_at_end``: end this process as soon as the other side is gone, whatever it works at.
    """

    def __init__(self, source: IO[bytes], sink: IO[bytes], exit_at_end: bool = False) -> None:
        self._source, self._sink, self._exit_at_end = source, sink, exit_at_end
        self._received: queue.SimpleQueue[tuple[Any] | None] = queue.SimpleQueue()
        """Messages, each in a tuple; None for the end."""
        self._writing = threading.Lock()
        threading.Thread(target=self._read, name="channel", daemon=True).start()

    def _read(self) -> None:
        try:
            while True:
                self._received.put((pickle.load(self._source),))
        except (EOFError, OSError, ValueError, pickle.UnpicklingError):
            if self._exit_at_end:
                os._exit(0)
            self._source.close()
            self._received.put(None)

    def send(self, message: object) -> None:
        """Send a message; may be called by any thread. Raises :class:`OSError` at the end."""
        data = pickle.dumps(message)
        with self._writing:
            try:
                self._sink.write(data)
                self._sink.flush()
            except ValueError as closed:
                raise OSError(str(closed)) from None

    def receive(self, seconds: float | None = None) -> Any:
        """Return the next message. Raises :class:`TimeoutError` after ``seconds`` without one, and
        :class:`EOFError` when the other side is gone."""
        try:
            found = self._received.get(timeout=seconds)
        except queue.Empty:
            raise TimeoutError from None
        if found is None:
            self._received.put(None)  # for the next call
            raise EOFError
        return found[0]

    def pending(self) -> bool:
        """Return True if :meth:`receive` would not wait."""
        return not self._received.empty()


def open_child_channel() -> Channel:
    """Take the standard streams of this child process for a channel to its parent.

    Afterwards standard input is empty, and standard output goes where standard error goes: what
    libraries and programs print does not disturb the messages.
    """
    source, sink = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    sys.stdout.flush()
    os.dup2(2, 1)
    return Channel(source, sink, exit_at_end=True)

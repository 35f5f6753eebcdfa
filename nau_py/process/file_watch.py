"""Changes of files, found by asking for their times and sizes."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from time import sleep

Stamp = tuple[int, int, int] | None
PERIOD = 0.02
"""Seconds that an editor may take to write a file in several steps."""


def read_stamp(path: Path) -> Stamp:
    """Return time, size and inode, which tell a file from a later one; None for no file."""
    try:
        found = os.stat(path)
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size, found.st_ino


class FileWatch:
    """Followed files, each with its kind (:mod:`nau_py.run.used_files`).

    Some fifty files take less than a millisecond, on network folders too.
    """

    def __init__(self, kinds: Mapping[Path, str] | None = None) -> None:
        self.kinds: dict[Path, str] = {}
        self._stamps: dict[Path, Stamp] = {}
        self.follow(kinds or {})

    def follow(self, kinds: Mapping[Path, str]) -> None:
        """Follow these files only. A change of a file that was followed before stays a change."""
        self._stamps = {path: self._stamps.get(path, read_stamp(path)) for path in kinds}
        self.kinds = dict(kinds)

    def accept(self) -> None:
        """Take the present state of every file as known."""
        self._stamps = {path: read_stamp(path) for path in self.kinds}

    def has_changes(self) -> bool:
        """Return True if :meth:`take_changes` would return files. Any thread may call it."""
        return any(read_stamp(path) != known for path, known in list(self._stamps.items()))

    def take_changes(self) -> dict[Path, str]:
        """Return the files that have changed since the last call, and their kinds."""
        found = {p: k for p, k in self.kinds.items() if read_stamp(p) != self._stamps[p]}
        for path in found:
            self._stamps[path] = read_stamp(path)
        return found

    def take_settled_changes(self, wait: Callable[[float], object] = sleep) -> dict[Path, str]:
        """Return :meth:`take_changes` after a pause in which an editor can finish writing."""
        found = self.take_changes()
        if found:
            wait(PERIOD)
            found |= self.take_changes()
        return found

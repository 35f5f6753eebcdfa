"""Paths of projects, with backslashes and wrong letter case (docs/format.md, 1.5)."""

from __future__ import annotations

import os
from dataclasses import dataclass
from difflib import get_close_matches
from functools import lru_cache
from pathlib import Path


@dataclass(frozen=True, slots=True)
class Resolved:
    """Path of a project as resolved, and the existing file or folder, if any.

    ``on_disk`` differs from ``path`` if only the letter case of the written path was wrong.
    """

    path: Path
    on_disk: Path | None

    @property
    def exists(self) -> bool:
        return self.on_disk is not None

    @property
    def wrong_case(self) -> bool:
        return self.on_disk is not None and self.on_disk != self.path

    @property
    def best(self) -> Path:
        return self.on_disk or self.path


@lru_cache(maxsize=4096)
def _entries(folder: str) -> dict[str, str]:
    try:
        return {name.lower(): name for name in sorted(os.listdir(folder))}
    except OSError:
        return {}


def forget_folders() -> None:
    """Forget the entries of folders, for processes that live longer than their files."""
    _entries.cache_clear()


def resolve(folder: Path, text: str) -> Resolved:
    """Resolve the path ``text``, written in a file of ``folder``."""
    path = Path(os.path.normpath(folder / text.strip().replace("\\", "/")))
    if path.exists():
        return Resolved(path, path)
    here = Path(path.anchor or ".")
    for part in path.parts[1:] if path.anchor else path.parts:
        step = here / part
        if not step.exists():
            found = _entries(str(here)).get(part.lower())
            if found is None:
                return Resolved(path, None)
            step = here / found
        here = step
    return Resolved(path, here)


def similar(resolved: Resolved) -> list[str]:
    """List names in the folder of a missing file that are similar to its name."""

    folder = resolved.path.parent
    names = list(_entries(str(folder)).values())
    return get_close_matches(resolved.path.name, names, n=3, cutoff=0.6)

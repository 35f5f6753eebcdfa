"""Folders of the user's cache, which only the user can read and write."""

from __future__ import annotations

import os
from pathlib import Path

import platformdirs

APPLICATION = "nau_py"
_OWNER_ONLY = 0o700


def make_cache_folder(name: str) -> Path | None:
    """Make the folder ``name`` in the user's cache; None where nothing can be kept.

    The path is absolute, the folder is the user's own, and nobody else has access: cached machine
    code is executed, so other users must not be able to write it. On Linux it is below
    ``$XDG_CACHE_HOME`` or ``~/.cache``; a relative ``XDG_CACHE_HOME`` is ignored, as the XDG
    specification demands.
    """
    base = platformdirs.user_cache_path(APPLICATION, appauthor=False)
    if not base.is_absolute():
        base = Path.home() / ".cache" / APPLICATION
    folder = base / name
    try:
        base.mkdir(parents=True, exist_ok=True)
        _make_private(base)
        folder.mkdir(exist_ok=True)
        _make_private(folder)
    except OSError:
        return None
    return folder if os.access(folder, os.W_OK) else None


def _make_private(folder: Path) -> None:
    """Take access from other users. Raises :class:`OSError` for a folder of another user."""
    if os.name != "posix":
        return  # folders of a Windows profile are private
    found = folder.stat()
    if found.st_uid != os.getuid():
        raise PermissionError(f"'{folder}' belongs to another user")
    if found.st_mode & 0o777 != _OWNER_ONLY:
        folder.chmod(_OWNER_ONLY)

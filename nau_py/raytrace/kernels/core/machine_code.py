"""Folder in which machine code is kept."""

from __future__ import annotations

import hashlib
import os
from functools import lru_cache
from pathlib import Path

from nau_py.process.cache_folder import make_cache_folder

_RAYTRACE = Path(__file__).parents[2]
_COMPILED_ROOMS = ("kernels", "programs")


@lru_cache(maxsize=1)
def cache_folder() -> str:
    """Return the folder of machine code; empty where nothing can be kept.

    Every version of the kernels has a folder of its own: numba notices changes of a kernel's own
    file only, not of the functions that it calls. Without a folder, every process compiles.
    """
    if chosen := os.environ.get("NUMBA_CACHE_DIR"):
        return chosen
    digest = hashlib.sha256()
    for room in _COMPILED_ROOMS:
        for file in sorted((_RAYTRACE / room).rglob("*.py")):
            digest.update(file.read_bytes())
    folder = make_cache_folder(f"kernels-{digest.hexdigest()[:16]}")
    return "" if folder is None else str(folder)

"""The decorators of kernels, and the type of a vector inside them."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar, cast

import numba
from numba import njit

F = TypeVar("F", bound=Callable[..., object])
V3 = tuple[float, float, float]


def _cache_folder() -> str:
    """Where machine code is kept: a folder of its own for every version of the kernels.

    numba notices changes of a kernel's own file only, not of the functions that it calls.
    """
    digest = hashlib.sha256()
    for file in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(file.read_bytes())
    base = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    folder = Path(base) / "nau_py" / f"kernels-{digest.hexdigest()[:16]}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return ""
    return str(folder) if os.access(folder, os.W_OK) else ""


_FOLDER = numba.config.CACHE_DIR or _cache_folder()
"""Empty where nothing can be kept: kernels are then compiled in every process."""


def kernel(function: F) -> F:
    """Compile ``function``, which Python calls, at its first call: no GIL, IEEE arithmetic."""
    before, numba.config.CACHE_DIR = numba.config.CACHE_DIR, _FOLDER
    try:
        compiled = njit(nogil=True, cache=bool(_FOLDER), error_model="numpy", fastmath=False)(
            function
        )
    finally:
        numba.config.CACHE_DIR = before
    return cast(F, compiled)


def inner(function: F) -> F:
    """Compile ``function``, which only kernels call: without the wrappers that Python needs."""
    compiled = njit(
        nogil=True,
        error_model="numpy",
        fastmath=False,
        no_cpython_wrapper=True,
        no_cfunc_wrapper=True,
    )(function)
    return cast(F, compiled)

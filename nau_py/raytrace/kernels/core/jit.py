"""The decorators of kernels, and the type of a vector inside them."""

from __future__ import annotations

import hashlib
import os
import platform
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from llvmlite import ir
from numba import cfunc, njit, types
from numba.extending import intrinsic

from nau_py.process.cache_folder import make_cache_folder

F = TypeVar("F", bound=Callable[..., object])
V3 = tuple[float, float, float]


def _cache_folder() -> str:
    """Where machine code is kept: a folder of its own for every version of the kernels.

    numba notices changes of a kernel's own file only, not of the functions that it calls.
    """
    digest = hashlib.sha256()
    for file in sorted(Path(__file__).parents[1].rglob("*.py")):
        digest.update(file.read_bytes())
    folder = make_cache_folder(f"kernels-{digest.hexdigest()[:16]}")
    return "" if folder is None else str(folder)


_FOLDER = os.environ.get("NUMBA_CACHE_DIR") or _cache_folder()
"""Empty where nothing can be kept: kernels are then compiled in every process."""


def cache_folder() -> str:
    """Where machine code is kept; empty for nowhere."""
    return _FOLDER


@contextmanager
def _cached() -> Iterator[bool]:
    """Where machine code is kept; whether there is such a place."""
    before, numba.config.CACHE_DIR = numba.config.CACHE_DIR, _FOLDER
    try:
        yield bool(_FOLDER)
    finally:
        numba.config.CACHE_DIR = before


def kernel(function: F) -> F:
    """Compile ``function``, which Python calls, at its first call: no GIL, IEEE arithmetic."""
    with _cached() as cache:
        made = njit(nogil=True, cache=cache, error_model="numpy", fastmath=False)(function)
    return cast(F, made)


def callback(function: Callable[[Any], None]) -> int:
    """Compile ``function`` of one address, which a C library calls; returns where it stands."""
    with _cached() as cache:
        made = cfunc(types.void(types.uint64), cache=cache, error_model="numpy")(function)
    _CALLBACKS.append(made)
    return int(made.address)


_CALLBACKS: list[Any] = []
"""Compiled callbacks: their code lives as long as they do."""


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


COUNTS_CYCLES = platform.machine().lower() in ("x86_64", "amd64")
"""Whether the processor's counter can be read here: elsewhere the instruction may be forbidden."""


@intrinsic  # type: ignore[untyped-decorator]
def read_cycles(typing: Any) -> Any:
    """The processor's cycle counter, int64; 0 where it cannot be read."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        word = ir.IntType(64)
        if not COUNTS_CYCLES:
            return ir.Constant(word, 0)
        counter = ir.FunctionType(word, [])
        return builder.call(
            builder.module.declare_intrinsic("llvm.readcyclecounter", (), counter), []
        )

    return types.int64(), generate


@kernel
def count_cycles() -> int:
    """:func:`cycles` for Python."""
    return read_cycles()

"""Decorators of kernels. They only note the function: numba is imported at the first compilation.

A module of kernels therefore loads as fast as any other, and its functions are plain Python until
the engine calls one. Inside compiled code, numba takes the type of a deferred function from its
``_numba_type_`` and so compiles what a kernel calls together with the kernel.
"""

from __future__ import annotations

import functools
import importlib
import platform
import sys
import threading
from collections.abc import Callable
from types import ModuleType
from typing import Any, TypeVar, cast

from nau_py.process.numba_import import import_numba

F = TypeVar("F", bound=Callable[..., object])
V3 = tuple[float, float, float]
_COMPILER = "nau_py.raytrace.kernels.core.compiler"
"""Module that uses numba; imported by name, at the first compilation."""
_LOCK = threading.RLock()


def _load_compiler() -> ModuleType:
    """Import the module that uses numba, without a configuration from the working folder."""
    if _COMPILER not in sys.modules:
        import_numba()
    return importlib.import_module(_COMPILER)


class Deferred:
    """A function that is compiled at its first use. ``maker``: the function of the compiler that
    makes it; ``arguments``: its arguments."""

    def __init__(self, maker: str, *arguments: Any) -> None:
        self._maker, self._arguments = maker, arguments
        self._compiled: Any = None

    @property
    def compiled(self) -> Any:
        """Numba's object: a dispatcher, an intrinsic or an external function."""
        if self._compiled is None:
            with _LOCK:  # two threads must not make two dispatchers
                if self._compiled is None:
                    make = getattr(_load_compiler(), self._maker)
                    self._compiled = make(*self._arguments)
        return self._compiled

    @property
    def _numba_type_(self) -> Any:
        return _load_compiler().type_of(self.compiled)

    def __call__(self, *arguments: Any) -> Any:
        raise TypeError(f"{self._maker}{self._arguments} works in compiled code only")


class Inner(Deferred):
    """A function that kernels call. Called from Python, it is the plain function."""

    def __init__(
        self, function: Callable[..., Any], link: Callable[[], Callable[..., Any]] | None = None
    ) -> None:
        """``link``: makes the function to compile, if that is another one; it is always inlined."""
        super().__init__("compile_inner", link or (lambda: function), link is not None)
        self.py_func = function
        functools.update_wrapper(self, function)

    def __call__(self, *arguments: Any) -> Any:
        return self.py_func(*arguments)


class Kernel(Deferred):
    """A function that Python calls and that runs compiled."""

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__("compile_kernel", function)
        self.py_func = function
        functools.update_wrapper(self, function)

    def __call__(self, *arguments: Any) -> Any:
        return self.compiled(*arguments)


def kernel(function: F) -> F:
    """Compile ``function``, which Python calls, at its first call: no GIL, IEEE arithmetic."""
    return cast(F, Kernel(function))


def inner(function: F) -> F:
    """Compile ``function``, which only kernels call, with the first kernel that calls it."""
    return cast(F, Inner(function))


def callback(function: Callable[..., None], signature: str = "void(uint64)") -> int:
    """Compile ``function``, which a C library calls; return the address of its code."""
    return int(_load_compiler().compile_callback(function, signature))


def external(name: str, arguments: int) -> Callable[..., Any]:
    """Declare the C function ``name``, which takes this number of addresses and returns nothing."""
    return cast(Callable[..., Any], Deferred("find_external", name, arguments))


COUNTS_CYCLES = platform.machine().lower() in ("x86_64", "amd64")
"""True if the processor's counter can be read: elsewhere the instruction may be forbidden."""
read_cycles = cast(Callable[[], int], Deferred("make_cycle_counter"))
"""The processor's cycle counter, int64; 0 where it cannot be read."""


@kernel
def count_cycles() -> int:
    """Return ``read_cycles`` to Python."""
    return read_cycles()

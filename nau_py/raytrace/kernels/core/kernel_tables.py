"""Tables of the compiled ray programs, one a kind, and functions that run a program by its code.

The programs register themselves (:mod:`nau_py.raytrace.programs.catalogue`); kernels call
``TABLE.run``, whose code is generated at the first compilation.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nau_py.raytrace.kernels.core.jit import Inner

NONE = 0
"""Code for no program."""
PARTIAL = 64
"""First code of the any-hit programs that let a part of the light pass. Embree's filter leaves
them, and USER, to the paths."""
USER = 127
"""Code of a program that is not compiled: Python runs it."""


class KernelTable:
    """The compiled programs of a kind. ``parameters``: those of their kernels."""

    def __init__(self, kind: str, parameters: str) -> None:
        self._kind, self._parameters = kind, parameters
        self._kernels: dict[int, Callable[..., Any]] = {}
        self.run: Any = Inner(self._run, self._link)
        """``run(code, *parameters)`` for compiled code, with the result of the program's kernel.
        A code without a program runs the last one."""

    def add(self, kernel: Callable[..., Any], partial: bool = False) -> int:
        """Add a kernel; return its code, which depends on the order of the additions only."""
        first = PARTIAL if partial else NONE + 1
        code = next(c for c in range(first, USER) if c not in self._kernels)
        self._kernels[code] = kernel
        return code

    def _run(self, code: int, *arguments: Any) -> Any:
        return self._kernels[code](*arguments)

    def _call(self, code: int) -> str:
        return f"kernel_{code}({self._parameters})"

    def _link(self) -> Callable[..., Any]:
        """Generate the function that compiled code calls: a chain of comparisons, which LLVM makes
        a jump table. A dictionary of functions would cost a call by address and its boxing."""
        if not self._kernels:
            raise RuntimeError(f"no {self._kind} program is registered")
        lines = [f"def run(code, {self._parameters}):"]
        *others, last = self._kernels
        for code in others:
            lines += [f"    if code == {code}:", f"        return {self._call(code)}"]
        lines.append(f"    return {self._call(last)}")
        names: dict[str, Any] = {f"kernel_{code}": k for code, k in self._kernels.items()}
        exec(compile("\n".join(lines), f"<{self._kind} programs>", "exec"), names)
        linked: Callable[..., Any] = names["run"]
        return linked


RAY_GENERATION_KERNELS = KernelTable("ray generation", "camera, seed, pixel, sample, x, y")
"""Kernels return origin and unit direction of a ray through image point (x, y), in pixels."""
CLOSEST_HIT_KERNELS = KernelTable("closest-hit", "scene, tile, ray_type, path, hit")
"""Kernels shade the SurfaceHit of a path, and return True if the path continues."""
ANY_HIT_KERNELS = KernelTable(
    "any-hit", "scene, material, triangle, u, v, direction, pixel, sample, depth"
)
"""Kernels return the part of a ray that a hit stops, 0 to 1."""
MISS_KERNELS = KernelTable("miss", "scene, tile, path")
"""Kernels add the radiance of a path that has left the scene."""

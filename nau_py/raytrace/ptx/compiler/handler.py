"""Common parts of the instruction handlers."""

from __future__ import annotations

from collections.abc import Callable

from nau_py.raytrace.ptx.compiler.module import SIZES
from nau_py.raytrace.ptx.compiler.writer import FunctionWriter

Handler = Callable[[FunctionWriter, list[str], tuple[str, ...]], None]
"""``handler(writer, words, operands)`` writes one instruction. ``words``: the parts of the opcode
behind its first dot."""


def type_in(w: FunctionWriter, words: list[str]) -> str:
    """Return the last type that an opcode names."""
    found = next((word for word in reversed(words) if word in SIZES), None)
    if found is None:
        raise w.fail("the instruction names no type")
    return found

"""Common parts of the instruction handlers."""

from __future__ import annotations

from collections.abc import Callable

from nau_py.raytrace.ptx.compiler.literals import llvm_type
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


def clamp_unit(w: FunctionWriter, value: str, type_: str) -> str:
    """Clamp a float to 0..1 (``.sat``). NaN gives 0."""
    t = llvm_type(type_)
    low = w.value(f"call {t} @llvm.maxnum.{type_}({t} {value}, {t} 0.0)")
    return w.value(f"call {t} @llvm.minnum.{type_}({t} {low}, {t} 1.0)")

"""Comparison, selection, logic and shifts (PTX ISA, 9.7.5 to 9.7.8)."""

from __future__ import annotations

from nau_py.raytrace.ptx.compiler.handler import Handler, type_in
from nau_py.raytrace.ptx.compiler.literals import is_float, is_signed, llvm_type
from nau_py.raytrace.ptx.compiler.module import SIZES
from nau_py.raytrace.ptx.compiler.writer import FunctionWriter

_ORDERED = {"eq": "oeq", "ne": "one", "lt": "olt", "le": "ole", "gt": "ogt", "ge": "oge"}
_ORDERED |= {"equ": "ueq", "neu": "une", "ltu": "ult", "leu": "ule", "gtu": "ugt", "geu": "uge"}
_ORDERED |= {"num": "ord", "nan": "uno"}
_SIGNED = {"lt": "slt", "le": "sle", "gt": "sgt", "ge": "sge"}
_UNSIGNED = {"lt": "ult", "le": "ule", "gt": "ugt", "ge": "uge"}
_UNSIGNED |= {"lo": "ult", "ls": "ule", "hi": "ugt", "hs": "uge"}


def compare(w: FunctionWriter, words: list[str], type_: str, a: str, b: str) -> str:
    """Compare two values. Returns an ``i1``."""
    how = words[0]
    t = llvm_type(type_)
    if is_float(type_):
        if how not in _ORDERED:
            raise w.fail(f"'{how}' compares no floats")
        return w.value(f"fcmp {_ORDERED[how]} {t} {a}, {b}")
    table = _SIGNED | {"eq": "eq", "ne": "ne"} if is_signed(type_) else _UNSIGNED
    known = table | {"eq": "eq", "ne": "ne"}
    if how not in known:
        raise w.fail(f"'{how}' compares no '{type_}'")
    return w.value(f"icmp {known[how]} {t} {a}, {b}")


def write_setp(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """Write ``setp.lt.f32 p|q, a, b``, where q is the opposite of p.

    ``setp.lt.and.f32 p|q, a, b, c`` combines both with the predicate c.
    """
    type_ = type_in(w, words)
    truth = compare(w, words, type_, w.read(operands[1], type_), w.read(operands[2], type_))
    outs = [part.strip() for part in operands[0].split("|")]
    other = w.value(f"xor i1 {truth}, true")
    if len(operands) > 3:
        how = next((x for x in words if x in ("and", "or", "xor")), "and")
        c = w.read(operands[3], "pred")
        truth, other = w.value(f"{how} i1 {truth}, {c}"), w.value(f"{how} i1 {other}, {c}")
    for out, value in zip(outs, (truth, other)):
        w.write(out, value, "pred")


def write_set(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """Write ``set.lt.u32.f32``: all bits (of a float, 1.0) where the comparison is true."""
    types = [x for x in words if x in SIZES]
    target, type_ = types[0], types[-1]
    truth = compare(w, words, type_, w.read(operands[1], type_), w.read(operands[2], type_))
    if len(operands) > 3:
        how = next((x for x in words if x in ("and", "or", "xor")), "and")
        truth = w.value(f"{how} i1 {truth}, {w.read(operands[3], 'pred')}")
    t = llvm_type(target)
    yes, no = ("1.0", "0.0") if is_float(target) else ("-1", "0")
    w.write(operands[0], w.value(f"select i1 {truth}, {t} {yes}, {t} {no}"), target)


def write_selp(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    type_ = type_in(w, words)
    a, b = w.read(operands[1], type_), w.read(operands[2], type_)
    p, t = w.read(operands[3], "pred"), llvm_type(type_)
    w.write(operands[0], w.value(f"select i1 {p}, {t} {a}, {t} {b}"), type_)


def write_slct(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """Write the first operand where the third is not negative, else the second."""
    type_, of = next(x for x in words if x in SIZES), type_in(w, words)
    a, b = w.read(operands[1], type_), w.read(operands[2], type_)
    c, t = w.read(operands[3], of), llvm_type(type_)
    truth = w.value(
        f"fcmp oge float {c}, 0.0" if of == "f32" else f"icmp sge {llvm_type(of)} {c}, 0"
    )
    w.write(operands[0], w.value(f"select i1 {truth}, {t} {a}, {t} {b}"), type_)


def _make_logic(how: str) -> Handler:
    def handle(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
        type_ = type_in(w, words)
        a, b = w.read(operands[1], type_), w.read(operands[2], type_)
        w.write(operands[0], w.value(f"{how} {llvm_type(type_)} {a}, {b}"), type_)

    return handle


def write_not(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    type_ = type_in(w, words)
    a, t = w.read(operands[1], type_), llvm_type(type_)
    w.write(operands[0], w.value(f"xor {t} {a}, {'true' if type_ == 'pred' else '-1'}"), type_)


def write_cnot(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    type_ = type_in(w, words)
    a, t = w.read(operands[1], type_), llvm_type(type_)
    truth = w.value(f"icmp eq {t} {a}, 0")
    w.write(operands[0], w.value(f"zext i1 {truth} to {t}"), type_)


def _make_shift(left: bool) -> Handler:
    """Make the handler of a shift. Past the width it gives 0, or the sign of a signed value."""

    def handle(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
        type_ = type_in(w, words)
        bits, t = 8 * SIZES[type_], llvm_type(type_)
        a, by = w.read(operands[1], type_), w.read(operands[2], "u32")
        far = w.value(f"icmp ugt i32 {by}, {bits - 1}")
        near = w.value(f"select i1 {far}, i32 {bits - 1}, i32 {by}")
        amount = near
        if t != "i32":
            amount = w.value(f"{'trunc' if bits < 32 else 'zext'} i32 {near} to {t}")
        how = "shl" if left else "ashr" if is_signed(type_) else "lshr"
        value = w.value(f"{how} {t} {a}, {amount}")
        if how != "ashr":
            value = w.value(f"select i1 {far}, {t} 0, {t} {value}")
        w.write(operands[0], value, type_)

    return handle


LOGIC: dict[str, Handler] = {
    "setp": write_setp,
    "set": write_set,
    "selp": write_selp,
    "slct": write_slct,
    "and": _make_logic("and"),
    "or": _make_logic("or"),
    "xor": _make_logic("xor"),
    "not": write_not,
    "cnot": write_cnot,
    "shl": _make_shift(True),
    "shr": _make_shift(False),
}

"""Integer instructions beyond plain arithmetic, and atomic ones (PTX ISA, 9.7.1, 9.7.8, 9.7.13)."""

from __future__ import annotations

from nau_py.raytrace.ptx.compiler.handler import Handler, type_in
from nau_py.raytrace.ptx.compiler.literals import (
    WHOLE_NUMBER,
    is_float,
    is_signed,
    llvm_type,
    parse_integer,
)
from nau_py.raytrace.ptx.compiler.module import SIZES
from nau_py.raytrace.ptx.compiler.writer import FunctionWriter


def write_sad(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """Add the distance of two numbers to a third."""
    type_ = type_in(w, words)
    t, sign = llvm_type(type_), "s" if is_signed(type_) else "u"
    a, b, c = (w.read(operand, type_) for operand in operands[1:4])
    high = w.value(f"call {t} @llvm.{sign}max.{t}({t} {a}, {t} {b})")
    low = w.value(f"call {t} @llvm.{sign}min.{t}({t} {a}, {t} {b})")
    w.write(operands[0], w.value(f"add {t} {w.value(f'sub {t} {high}, {low}')}, {c}"), type_)


def write_shf(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """Shift two words as one of 64 bits. The second word is the high one."""
    low, high, by = (w.read(operand, "u32") for operand in operands[1:4])
    if "clamp" in words:
        by = w.value(f"call i32 @llvm.umin.i32(i32 {by}, i32 32)")
    else:
        by = w.value(f"and i32 {by}, 31")
    upper = w.value(f"shl i64 {w.value(f'zext i32 {high} to i64')}, 32")
    both = w.value(f"or i64 {upper}, {w.value(f'zext i32 {low} to i64')}")
    amount = w.value(f"zext i32 {by} to i64")
    if words[0] == "l":
        both = w.value(f"lshr i64 {w.value(f'shl i64 {both}, {amount}')}, 32")
    else:
        both = w.value(f"lshr i64 {both}, {amount}")
    w.write(operands[0], w.value(f"trunc i64 {both} to i32"), "u32")


def write_lop3(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """Apply any logic of three words, given by its truth table of eight bits."""
    a, b, c = (w.read(operand, "b32") for operand in operands[1:4])
    if not WHOLE_NUMBER.match(operands[4]):
        raise w.fail(f"the table of 'lop3' is no number: '{operands[4]}'")
    table = parse_integer(operands[4]) & 255
    inverse = [w.value(f"xor i32 {value}, -1") for value in (a, b, c)]
    result = "0"
    for index in range(8):
        if table >> index & 1:
            chosen = [
                plain if index >> 2 - place & 1 else turned
                for place, (plain, turned) in enumerate(zip((a, b, c), inverse))
            ]
            both = w.value(f"and i32 {chosen[0]}, {chosen[1]}")
            result = w.value(f"or i32 {result}, {w.value(f'and i32 {both}, {chosen[2]}')}")
    w.write(operands[0], result, "b32")


def _make_dot(parts: int) -> Handler:
    """Make the handler of ``dp4a`` (bytes times bytes) or ``dp2a`` (halves times bytes)."""

    def handle(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
        types = [word for word in words if word in SIZES]
        a, b, total = (w.read(operand, "u32") for operand in operands[1:4])
        width = 32 // parts
        begin = 16 if "hi" in words else 0
        for index in range(parts):
            x = _extract_field(w, a, index * width, width, is_signed(types[0]))
            y = _extract_field(w, b, begin + index * 8, 8, is_signed(types[-1]))
            total = w.value(f"add i32 {total}, {w.value(f'mul i32 {x}, {y}')}")
        w.write(operands[0], total, "u32")

    return handle


def _extract_field(w: FunctionWriter, word: str, at: int, bits: int, signed: bool) -> str:
    cut = w.value(f"trunc i32 {w.value(f'lshr i32 {word}, {at}')} to i{bits}")
    return w.value(f"{'sext' if signed else 'zext'} i{bits} {cut} to i32")


def _make_mul24(add: bool) -> Handler:
    """Make the handler of ``mul24`` or ``mad24``: low or high 32 bits of a 24-bit product."""

    def handle(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
        type_ = type_in(w, words)
        down = "ashr" if is_signed(type_) else "lshr"
        how = "sext" if is_signed(type_) else "zext"
        wide = []
        for operand in operands[1:3]:
            up = w.value(f"shl i32 {w.read(operand, type_)}, 8")
            wide.append(w.value(f"{how} i32 {w.value(f'{down} i32 {up}, 8')} to i64"))
        product = w.value(f"mul i64 {wide[0]}, {wide[1]}")
        if "hi" in words:
            product = w.value(f"lshr i64 {product}, 16")
        value = w.value(f"trunc i64 {product} to i32")
        if add:
            value = w.value(f"add i32 {value}, {w.read(operands[3], type_)}")
        w.write(operands[0], value, type_)

    return handle


_ATOMIC = {"and": "and", "or": "or", "xor": "xor", "exch": "xchg", "add": "add"}


def write_atom(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """Write ``atom d, [a], b`` or ``red [a], b``: memory that other launch indices write, too."""
    type_ = type_in(w, words)
    keeps = len(operands) > 2 or "cas" in words
    to, rest = (operands[0], operands[1:]) if keeps else ("_", operands)
    t, place = llvm_type(type_), w.pointer(rest[0])
    value = w.read(rest[1], type_)
    known = ("cas", "inc", "dec", "min", "max", *_ATOMIC)
    how = next((word for word in words if word in known), "")
    if how == "cas":
        bits = f"i{8 * SIZES[type_]}"
        new = w.read(rest[2], type_)
        pair = w.value(
            f"cmpxchg ptr {place}, {bits} {value}, {bits} {new} monotonic monotonic, align "
            f"{SIZES[type_]}"
        )
        w.write(to, w.value(f"extractvalue {{{bits}, i1}} {pair}, 0"), type_)
        return
    name = _ATOMIC.get(how, "")
    if how in ("min", "max"):
        name = f"f{how}" if is_float(type_) else how if is_signed(type_) else f"u{how}"
    elif how == "add" and is_float(type_):
        name = "fadd"
    elif how in ("inc", "dec"):
        name = f"u{how}_wrap"
    if not name:
        raise w.fail(f"atomic operation of '{'.'.join(words)}' is not supported")
    found = w.value(f"atomicrmw {name} ptr {place}, {t} {value} monotonic, align {SIZES[type_]}")
    w.write(to, found, type_)


INTEGER: dict[str, Handler] = {
    "sad": write_sad,
    "shf": write_shf,
    "lop3": write_lop3,
    "dp4a": _make_dot(4),
    "dp2a": _make_dot(2),
    "mul24": _make_mul24(False),
    "mad24": _make_mul24(True),
    "atom": write_atom,
    "red": write_atom,
}

"""Bit fields, conversions and moves (PTX ISA, 9.7.1.12 to 9.7.1.19, 9.7.9)."""

from __future__ import annotations

from nau_py.raytrace.ptx.compiler.handler import Handler, clamp_unit, type_in
from nau_py.raytrace.ptx.compiler.literals import is_float, is_signed, llvm_type
from nau_py.raytrace.ptx.compiler.module import SIZES
from nau_py.raytrace.ptx.compiler.rounding import narrow_float, round_integer, rounding_mode
from nau_py.raytrace.ptx.compiler.writer import FunctionWriter

_ROUND = {"rni": "rint", "rzi": "trunc", "rmi": "floor", "rpi": "ceil"}


def _make_count(name: str, extra: str = "") -> Handler:
    def handle(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
        type_ = type_in(w, words)
        t = llvm_type(type_)
        value = w.value(f"call {t} @llvm.{name}.{t}({t} {w.read(operands[1], type_)}{extra})")
        if name == "bitreverse":
            w.write(operands[0], value, type_)
        else:
            w.write(operands[0], w.fit(value, type_, "u32"), "u32")

    return handle


def write_bfind(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """Find the highest bit that is set (for signed values, that differs from the sign).

    The result is its position, or all bits set where there is none.
    """
    type_ = type_in(w, words)
    t, bits = llvm_type(type_), 8 * SIZES[type_]
    a = w.read(operands[1], type_)
    if is_signed(type_):
        a = w.value(f"xor {t} {a}, {w.value(f'ashr {t} {a}, {bits - 1}')}")
    zeros = w.value(f"call {t} @llvm.ctlz.{t}({t} {a}, i1 false)")
    place = w.value(f"sub {t} {bits - 1}, {zeros}")
    if "shiftamt" in words:
        none = w.value(f"icmp eq {t} {a}, 0")
        place = w.value(f"select i1 {none}, {t} -1, {t} {zeros}")
    w.write(operands[0], w.fit(place, "s" + type_[1:], "u32"), "u32")


def write_bfe(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """Extract a bit field, given by its position and length; sign-extend it for signed types."""
    type_ = type_in(w, words)
    t, bits = llvm_type(type_), 8 * SIZES[type_]
    a = w.read(operands[1], type_)
    begin = _read_byte(w, operands[2])
    length = _read_byte(w, operands[3])
    wide = "i128"
    signed = is_signed(type_)
    big = w.value(f"{'sext' if signed else 'zext'} {t} {a} to {wide}")
    start = w.value(f"call i32 @llvm.umin.i32(i32 {begin}, i32 {bits})")
    shifted = w.value(f"lshr {wide} {big}, {w.value(f'zext i32 {start} to {wide}')}")
    limit = w.value(f"call i32 @llvm.umin.i32(i32 {length}, i32 {bits})")
    by = w.value(f"zext i32 {w.value(f'sub i32 128, {limit}')} to {wide}")
    none = w.value(f"icmp eq i32 {limit}, 0")
    left = w.value(f"select i1 {none}, {wide} 0, {wide} {by}")
    up = w.value(f"shl {wide} {shifted}, {left}")
    down = w.value(f"{'ashr' if signed else 'lshr'} {wide} {up}, {left}")
    cut = w.value(f"trunc {wide} {down} to {t}")
    w.write(operands[0], w.value(f"select i1 {none}, {t} 0, {t} {cut}"), type_)


def write_bfi(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """Insert the low bits of the first operand into the second, at a position and length."""
    type_ = type_in(w, words)
    t, bits = llvm_type(type_), 8 * SIZES[type_]
    a, b = w.read(operands[1], type_), w.read(operands[2], type_)
    begin, length = _read_byte(w, operands[3]), _read_byte(w, operands[4])
    wide = "i128"
    start, size = (_limit(w, operand, bits, wide) for operand in (begin, length))
    power = w.value(f"shl {wide} 1, {size}")
    ones = w.value(f"sub {wide} {power}, 1")
    mask = w.value(f"shl {wide} {ones}, {start}")
    put = w.value(f"shl {wide} {w.value(f'zext {t} {a} to {wide}')}, {start}")
    old = w.value(f"zext {t} {b} to {wide}")
    keep = w.value(f"and {wide} {old}, {w.value(f'xor {wide} {mask}, -1')}")
    both = w.value(f"or {wide} {w.value(f'and {wide} {put}, {mask}')}, {keep}")
    w.write(operands[0], w.value(f"trunc {wide} {both} to {t}"), type_)


def _limit(w: FunctionWriter, value: str, bits: int, wide: str) -> str:
    """Clamp a value to ``bits`` and extend it to the LLVM type ``wide``."""
    least = w.value(f"call i32 @llvm.umin.i32(i32 {value}, i32 {bits})")
    return w.value(f"zext i32 {least} to {wide}")


def _read_byte(w: FunctionWriter, operand: str) -> str:
    """Read the low eight bits of an operand."""
    return w.value(f"and i32 {w.read(operand, 'u32')}, 255")


def write_prmt(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """Choose four bytes out of eight, each by four bits. The highest bit repeats the sign."""
    if any(word in words for word in ("f4e", "b4e", "rc8", "ecl", "ecr", "rc16")):
        raise w.fail("modes of 'prmt' are not supported")
    low, high = w.read(operands[1], "u32"), w.read(operands[2], "u32")
    chosen = w.read(operands[3], "u32")
    upper = w.value(f"shl i64 {w.value(f'zext i32 {high} to i64')}, 32")
    all_ = w.value(f"or i64 {w.value(f'zext i32 {low} to i64')}, {upper}")
    result = "0"
    for index in range(4):
        nibble = w.value(f"lshr i32 {chosen}, {4 * index}")
        place = w.value(f"shl i32 {w.value(f'and i32 {nibble}, 7')}, 3")
        moved = w.value(f"lshr i64 {all_}, {w.value(f'zext i32 {place} to i64')}")
        byte = w.value(f"trunc i64 {moved} to i8")
        sign = w.value(f"ashr i8 {byte}, 7")
        bit = w.value(f"icmp ne i32 {w.value(f'and i32 {nibble}, 8')}, 0")
        byte = w.value(f"select i1 {bit}, i8 {sign}, i8 {byte}")
        put = w.value(f"shl i32 {w.value(f'zext i8 {byte} to i32')}, {8 * index}")
        result = w.value(f"or i32 {result}, {put}")
    w.write(operands[0], result, "u32")


def write_mov(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """Copy a value, split it into ``{a, b}`` or join it from them (9.7.9.4)."""
    type_ = type_in(w, words)
    to, source = w.vector(operands[0]), w.vector(operands[1])
    if len(to) == 1 and len(source) == 1:
        w.write(to[0], w.read(source[0], type_), type_)
        return
    t, count = llvm_type(type_), max(len(to), len(source))
    bits = 8 * SIZES[type_] // count
    part = f"b{bits}"
    if len(source) > 1:
        whole = "0"
        for index, operand in enumerate(source):
            value = w.value(f"zext i{bits} {w.read(operand, part)} to {t}")
            whole = w.value(f"or {t} {whole}, {w.value(f'shl {t} {value}, {bits * index}')}")
        w.write(to[0], whole, type_)
        return
    whole = w.read(source[0], type_)
    for index, operand in enumerate(to):
        moved = w.value(f"lshr {t} {whole}, {bits * index}")
        w.write(operand, w.value(f"trunc {t} {moved} to i{bits}"), part)


def write_cvt(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """Convert a number: ``cvt.rounding.to.from`` (9.7.9.21)."""
    types = [word for word in words if word in SIZES]
    if len(types) != 2:
        raise w.fail("only conversions between two of the plain types are supported")
    if "f16" in types:
        _convert_half(w, words, types, operands)
        return
    to, source = types
    value = w.read(operands[1], source)
    rounding = next((word for word in words if word in _ROUND), None)
    mode = rounding_mode(words)
    if is_float(source) and is_float(to):
        made = _convert_float(w, value, source, to, rounding, mode, words)
    elif is_float(source):
        made = _convert_to_integer(w, value, source, to, rounding or "rzi")
    elif is_float(to):
        signed, whole = is_signed(source), llvm_type(source)
        if mode:
            made = round_integer(w, mode, value, whole, signed, to)
        else:
            made = w.value(f"{'s' if signed else 'u'}itofp {whole} {value} to {llvm_type(to)}")
        made = clamp_unit(w, made, to) if "sat" in words else made
    else:
        made = _convert_integer(w, value, source, to, "sat" in words)
    w.write(operands[0], made, to)


def _convert_half(
    w: FunctionWriter, words: list[str], types: list[str], operands: tuple[str, ...]
) -> None:
    """Convert from or to half floats, which are kept as 16-bit registers."""
    to, source = types
    if not (is_float(to) or is_float(source)) or rounding_mode(words):
        raise w.fail("half floats are converted to and from floats only, by the nearest")
    if source == "f16":
        half = w.value(f"bitcast i16 {w.read(operands[1], 'b16')} to half")
        w.write(operands[0], w.value(f"fpext half {half} to {llvm_type(to)}"), to)
        return
    value = w.read(operands[1], source)
    value = clamp_unit(w, value, source) if "sat" in words else value
    half = w.value(f"fptrunc {llvm_type(source)} {value} to half")
    w.write(operands[0], w.value(f"bitcast half {half} to i16"), "b16")


def _convert_float(
    w: FunctionWriter,
    value: str,
    source: str,
    to: str,
    rounding: str | None,
    mode: str,
    words: list[str],
) -> str:
    if rounding:
        t = llvm_type(source)
        value = w.value(f"call {t} @llvm.{_ROUND[rounding]}.{source}({t} {value})")
    if SIZES[to] < SIZES[source] and mode:
        value = narrow_float(w, mode, value)
    elif source != to:
        how = "fpext" if SIZES[to] > SIZES[source] else "fptrunc"
        value = w.value(f"{how} {llvm_type(source)} {value} to {llvm_type(to)}")
    return clamp_unit(w, value, to) if "sat" in words else value


def _convert_to_integer(w: FunctionWriter, value: str, source: str, to: str, rounding: str) -> str:
    """Round a float to an integer and clamp it to the range of the type. NaN gives 0."""
    t, goal = llvm_type(source), llvm_type(to)
    whole = w.value(f"call {t} @llvm.{_ROUND[rounding]}.{source}({t} {value})")
    sign = "s" if is_signed(to) else "u"
    return w.value(f"call {goal} @llvm.fpto{sign}i.sat.{goal}.{source}({t} {whole})")


def _convert_integer(w: FunctionWriter, value: str, source: str, to: str, saturate: bool) -> str:
    have, want = 8 * SIZES[source], 8 * SIZES[to]
    if saturate and (want < have or is_signed(source) != is_signed(to)):
        raise w.fail("saturation between integers is not supported")
    if want == have:
        return value
    how = "trunc" if want < have else "sext" if is_signed(source) else "zext"
    return w.value(f"{how} i{have} {value} to i{want}")


def write_cvta(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """Copy an address: all memory spaces are one."""
    type_ = type_in(w, words)
    w.write(operands[0], w.read(operands[1], type_), type_)


BITS: dict[str, Handler] = {
    "popc": _make_count("ctpop"),
    "clz": _make_count("ctlz", ", i1 false"),
    "brev": _make_count("bitreverse"),
    "bfind": write_bfind,
    "bfe": write_bfe,
    "bfi": write_bfi,
    "prmt": write_prmt,
    "mov": write_mov,
    "cvt": write_cvt,
    "cvta": write_cvta,
}

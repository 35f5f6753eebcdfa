"""Bits, conversions and moves (PTX ISA, 9.7.1.12 to 9.7.1.19, 9.7.9)."""

from __future__ import annotations

from nau_py.raytrace.ptx.compiler.arithmetic import Handler, type_in
from nau_py.raytrace.ptx.compiler.reader import SIZES
from nau_py.raytrace.ptx.compiler.rounding import mode_of, narrowed, of_integer
from nau_py.raytrace.ptx.compiler.writer import FunctionWriter, is_float, is_signed, llvm

_ROUND = {"rni": "rint", "rzi": "trunc", "rmi": "floor", "rpi": "ceil"}


def _count(name: str, extra: str = "") -> Handler:
    def handle(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
        type_ = type_in(w, words)
        t = llvm(type_)
        value = w.value(f"call {t} @llvm.{name}.{t}({t} {w.read(operands[1], type_)}{extra})")
        if name == "bitreverse":
            w.write(operands[0], value, type_)
        else:
            w.write(operands[0], w.fit(value, type_, "u32"), "u32")

    return handle


def bfind(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """The place of the highest bit (of signed ones, of the highest that is not the sign), or all
    bits set where there is none."""
    type_ = type_in(w, words)
    t, bits = llvm(type_), 8 * SIZES[type_]
    a = w.read(operands[1], type_)
    if is_signed(type_):
        a = w.value(f"xor {t} {a}, {w.value(f'ashr {t} {a}, {bits - 1}')}")
    zeros = w.value(f"call {t} @llvm.ctlz.{t}({t} {a}, i1 false)")
    place = w.value(f"sub {t} {bits - 1}, {zeros}")
    if "shiftamt" in words:
        none = w.value(f"icmp eq {t} {a}, 0")
        place = w.value(f"select i1 {none}, {t} -1, {t} {zeros}")
    w.write(operands[0], w.fit(place, "s" + type_[1:], "u32"), "u32")


def bfe(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """A field of bits: from a place, so long; of signed ones filled up with its highest bit."""
    type_ = type_in(w, words)
    t, bits = llvm(type_), 8 * SIZES[type_]
    a = w.read(operands[1], type_)
    begin = _byte(w, operands[2])
    length = _byte(w, operands[3])
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


def bfi(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """The low bits of the first in the second, at a place, so many."""
    type_ = type_in(w, words)
    t, bits = llvm(type_), 8 * SIZES[type_]
    a, b = w.read(operands[1], type_), w.read(operands[2], type_)
    begin, length = _byte(w, operands[3]), _byte(w, operands[4])
    wide = "i128"
    start, size = (_limited(w, operand, bits, wide) for operand in (begin, length))
    power = w.value(f"shl {wide} 1, {size}")
    ones = w.value(f"sub {wide} {power}, 1")
    mask = w.value(f"shl {wide} {ones}, {start}")
    put = w.value(f"shl {wide} {w.value(f'zext {t} {a} to {wide}')}, {start}")
    old = w.value(f"zext {t} {b} to {wide}")
    keep = w.value(f"and {wide} {old}, {w.value(f'xor {wide} {mask}, -1')}")
    both = w.value(f"or {wide} {w.value(f'and {wide} {put}, {mask}')}, {keep}")
    w.write(operands[0], w.value(f"trunc {wide} {both} to {t}"), type_)


def _limited(w: FunctionWriter, value: str, bits: int, wide: str) -> str:
    least = w.value(f"call i32 @llvm.umin.i32(i32 {value}, i32 {bits})")
    return w.value(f"zext i32 {least} to {wide}")


def _byte(w: FunctionWriter, operand: str) -> str:
    """The low eight bits of an operand."""
    return w.value(f"and i32 {w.read(operand, 'u32')}, 255")


def prmt(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """Four bytes chosen out of eight, each by four bits; the highest says to repeat the sign."""
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


def mov(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """Copies; ``{a, b}`` takes a value apart or puts it together (9.7.9.4)."""
    type_ = type_in(w, words)
    to, source = w.vector(operands[0]), w.vector(operands[1])
    if len(to) == 1 and len(source) == 1:
        w.write(to[0], w.read(source[0], type_), type_)
        return
    t, count = llvm(type_), max(len(to), len(source))
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


def cvt(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """Conversions (9.7.9.21): ``cvt.rounding.to.from``."""
    types = [word for word in words if word in SIZES]
    if len(types) != 2:
        raise w.fail("only conversions between two of the plain types are supported")
    if "f16" in types:
        _half(w, words, types, operands)
        return
    to, source = types
    value = w.read(operands[1], source)
    rounding = next((word for word in words if word in _ROUND), None)
    mode = mode_of(words)
    if is_float(source) and is_float(to):
        made = _between_floats(w, value, source, to, rounding, mode, words)
    elif is_float(source):
        made = _to_integer(w, value, source, to, rounding or "rzi")
    elif is_float(to):
        signed, whole = is_signed(source), llvm(source)
        if mode:
            made = of_integer(w, mode, value, whole, signed, to)
        else:
            made = w.value(f"{'s' if signed else 'u'}itofp {whole} {value} to {llvm(to)}")
        made = _clamped(w, made, to) if "sat" in words else made
    else:
        made = _between_integers(w, value, source, to, "sat" in words)
    w.write(operands[0], made, to)


def _half(w: FunctionWriter, words: list[str], types: list[str], operands: tuple[str, ...]) -> None:
    """To and from half floats, which are bits in registers of 16."""
    to, source = types
    if not (is_float(to) or is_float(source)) or mode_of(words):
        raise w.fail("half floats are converted to and from floats only, by the nearest")
    if source == "f16":
        half = w.value(f"bitcast i16 {w.read(operands[1], 'b16')} to half")
        w.write(operands[0], w.value(f"fpext half {half} to {llvm(to)}"), to)
        return
    value = w.read(operands[1], source)
    value = _clamped(w, value, source) if "sat" in words else value
    half = w.value(f"fptrunc {llvm(source)} {value} to half")
    w.write(operands[0], w.value(f"bitcast half {half} to i16"), "b16")


def _between_floats(
    w: FunctionWriter,
    value: str,
    source: str,
    to: str,
    rounding: str | None,
    mode: str,
    words: list[str],
) -> str:
    if rounding:
        t = llvm(source)
        value = w.value(f"call {t} @llvm.{_ROUND[rounding]}.{source}({t} {value})")
    if SIZES[to] < SIZES[source] and mode:
        value = narrowed(w, mode, value)
    elif source != to:
        how = "fpext" if SIZES[to] > SIZES[source] else "fptrunc"
        value = w.value(f"{how} {llvm(source)} {value} to {llvm(to)}")
    return _clamped(w, value, to) if "sat" in words else value


def _clamped(w: FunctionWriter, value: str, type_: str) -> str:
    t = llvm(type_)
    low = w.value(f"call {t} @llvm.maxnum.{type_}({t} {value}, {t} 0.0)")
    return w.value(f"call {t} @llvm.minnum.{type_}({t} {low}, {t} 1.0)")


def _to_integer(w: FunctionWriter, value: str, source: str, to: str, rounding: str) -> str:
    """Rounded, then clamped to what the type holds; NaN gives 0."""
    t, goal = llvm(source), llvm(to)
    whole = w.value(f"call {t} @llvm.{_ROUND[rounding]}.{source}({t} {value})")
    sign = "s" if is_signed(to) else "u"
    return w.value(f"call {goal} @llvm.fpto{sign}i.sat.{goal}.{source}({t} {whole})")


def _between_integers(w: FunctionWriter, value: str, source: str, to: str, saturate: bool) -> str:
    have, want = 8 * SIZES[source], 8 * SIZES[to]
    if saturate and (want < have or is_signed(source) != is_signed(to)):
        raise w.fail("saturation between integers is not supported")
    if want == have:
        return value
    how = "trunc" if want < have else "sext" if is_signed(source) else "zext"
    return w.value(f"{how} i{have} {value} to i{want}")


def address(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """``cvta``: all spaces are one here."""
    type_ = type_in(w, words)
    w.write(operands[0], w.read(operands[1], type_), type_)


BITS: dict[str, Handler] = {
    "popc": _count("ctpop"),
    "clz": _count("ctlz", ", i1 false"),
    "brev": _count("bitreverse"),
    "bfind": bfind,
    "bfe": bfe,
    "bfi": bfi,
    "prmt": prmt,
    "mov": mov,
    "cvt": cvt,
    "cvta": address,
}

"""Arithmetic of integers and floats (PTX ISA, 9.7.1 to 9.7.3)."""

from __future__ import annotations

from nau_py.raytrace.ptx.compiler.handler import Handler, clamp_unit, type_in
from nau_py.raytrace.ptx.compiler.literals import float_text, is_float, is_signed, llvm_type
from nau_py.raytrace.ptx.compiler.module import SIZES
from nau_py.raytrace.ptx.compiler.rounding import round_result
from nau_py.raytrace.ptx.compiler.writer import FunctionWriter


def _saturate(w: FunctionWriter, words: list[str], value: str, type_: str) -> str:
    """Clamp a float to 0..1 where the opcode has ``.sat``."""
    return clamp_unit(w, value, type_) if "sat" in words else value


def _make_binary(integer: str) -> Handler:
    def handle(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
        type_ = type_in(w, words)
        a, b = w.read(operands[1], type_), w.read(operands[2], type_)
        t = llvm_type(type_)
        if is_float(type_):
            value = _saturate(w, words, round_result(w, words, type_, integer, [a, b]), type_)
        elif "cc" in words:
            value = _set_carry(w, integer, t, a, b)
        elif "sat" in words:
            value = w.value(f"call {t} @llvm.s{integer}.sat.{t}({t} {a}, {t} {b})")
        else:
            value = w.value(f"{integer} {t} {a}, {b}")
        w.write(operands[0], value, type_)

    return handle


def _set_carry(w: FunctionWriter, how: str, t: str, a: str, b: str) -> str:
    """Add or subtract and store the carry (``.cc``)."""
    pair = w.value(f"call {{{t}, i1}} @llvm.u{how}.with.overflow.{t}({t} {a}, {t} {b})")
    w.emit(f"store i1 {w.value(f'extractvalue {{{t}, i1}} {pair}, 1')}, ptr %carry")
    return w.value(f"extractvalue {{{t}, i1}} {pair}, 0")


def _make_carrying(how: str) -> Handler:
    """Make the handler of ``addc`` or ``subc``, which use the carry of the instruction before."""

    def handle(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
        type_ = type_in(w, words)
        t = llvm_type(type_)
        a, b = w.read(operands[1], type_), w.read(operands[2], type_)
        w.write(operands[0], _use_carry(w, how, t, a, b, "cc" in words), type_)

    return handle


def _use_carry(w: FunctionWriter, how: str, t: str, a: str, b: str, keep: bool) -> str:
    """Add or subtract with the carry. ``keep``: store the new carry."""
    carry = w.value(f"zext i1 {w.value('load i1, ptr %carry')} to {t}")
    name = f"@llvm.u{how}.with.overflow.{t}"
    first = w.value(f"call {{{t}, i1}} {name}({t} {a}, {t} {b})")
    part = w.value(f"extractvalue {{{t}, i1}} {first}, 0")
    second = w.value(f"call {{{t}, i1}} {name}({t} {part}, {t} {carry})")
    if keep:
        one, two = (w.value(f"extractvalue {{{t}, i1}} {p}, 1") for p in (first, second))
        w.emit(f"store i1 {w.value(f'or i1 {one}, {two}')}, ptr %carry")
    return w.value(f"extractvalue {{{t}, i1}} {second}, 0")


def _widen(w: FunctionWriter, type_: str, value: str) -> tuple[str, str]:
    """Extend an integer to twice its width. Returns the value and its LLVM type."""
    t = f"i{16 * SIZES[type_]}"
    how = "sext" if is_signed(type_) else "zext"
    return w.value(f"{how} {llvm_type(type_)} {value} to {t}"), t


def _multiply(w: FunctionWriter, words: list[str], type_: str, a: str, b: str) -> tuple[str, str]:
    """Multiply integers: low half, high half (``.hi``) or all bits (``.wide``).

    Returns the product and its PTX type.
    """
    t = llvm_type(type_)
    if "wide" in words and SIZES[type_] == 8:
        raise w.fail("a product of 128 bits fits no register")
    if "wide" in words or "hi" in words:
        (x, wide), (y, _) = _widen(w, type_, a), _widen(w, type_, b)
        all_ = w.value(f"mul {wide} {x}, {y}")
        if "wide" in words:
            return all_, type_[0] + str(16 * SIZES[type_])
        shifted = w.value(f"lshr {wide} {all_}, {8 * SIZES[type_]}")
        return w.value(f"trunc {wide} {shifted} to {t}"), type_
    return w.value(f"mul {t} {a}, {b}"), type_


def write_mul(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    type_ = type_in(w, words)
    a, b = w.read(operands[1], type_), w.read(operands[2], type_)
    if is_float(type_):
        product = round_result(w, words, type_, "mul", [a, b])
        w.write(operands[0], _saturate(w, words, product, type_), type_)
        return
    w.write(operands[0], *_multiply(w, words, type_, a, b))


def write_mad(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """Write ``mad`` or ``fma``. With ``.cc`` the sum sets the carry."""
    type_ = type_in(w, words)
    a, b = w.read(operands[1], type_), w.read(operands[2], type_)
    if is_float(type_):
        value = round_result(w, words, type_, "fma", [a, b, w.read(operands[3], type_)])
        w.write(operands[0], _saturate(w, words, value, type_), type_)
        return
    product, wide = _multiply(w, words, type_, a, b)
    c, t = w.read(operands[3], wide), llvm_type(wide)
    if "cc" in words:
        value = _set_carry(w, "add", t, product, c)
    else:
        value = w.value(f"add {t} {product}, {c}")
    w.write(operands[0], value, wide)


def write_madc(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    type_ = type_in(w, words)
    a, b = w.read(operands[1], type_), w.read(operands[2], type_)
    product, wide = _multiply(w, words, type_, a, b)
    c = w.read(operands[3], wide)
    w.write(operands[0], _use_carry(w, "add", llvm_type(wide), product, c, "cc" in words), wide)


def write_div(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    type_ = type_in(w, words)
    a, b = w.read(operands[1], type_), w.read(operands[2], type_)
    if is_float(type_):
        value = round_result(w, words, type_, "div", [a, b])
        w.write(operands[0], _flush_huge(w, a, b, value) if "approx" in words else value, type_)
        return
    w.write(operands[0], _divide(w, "div", type_, a, b), type_)


def _flush_huge(w: FunctionWriter, a: str, b: str, value: str) -> str:
    """Return 0 for ``div.approx`` by more than 2**126, whose reciprocal is 0 (9.7.3.8)."""
    size = w.value(f"call float @llvm.fabs.f32(float {b})")
    huge = w.value(f"fcmp ogt float {size}, {float_text(2.0**126, 'f32')}")
    finite = w.value(f"fcmp olt float {size}, {float_text(float('inf'), 'f32')}")
    zero = w.value(f"call float @llvm.copysign.f32(float 0.0, float {b})")
    product = w.value(f"fmul float {a}, {zero}")
    both = w.value(f"and i1 {huge}, {finite}")
    return w.value(f"select i1 {both}, float {product}, float {value}")


def write_rem(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    type_ = type_in(w, words)
    a, b = w.read(operands[1], type_), w.read(operands[2], type_)
    w.write(operands[0], _divide(w, "rem", type_, a, b), type_)


def _divide(w: FunctionWriter, how: str, type_: str, a: str, b: str) -> str:
    """Divide integers, or take the remainder (``how``: div, rem), without a trap.

    PTX leaves division by 0 undefined. We return the hardware's result: all bits set, and the
    dividend as the remainder. The least number by -1 overflows and gives itself.
    """
    t, signed = llvm_type(type_), is_signed(type_)
    zero = w.value(f"icmp eq {t} {b}, 0")
    least = str(-(1 << (8 * SIZES[type_] - 1)))
    bad = zero
    if signed:
        one = w.value(f"icmp eq {t} {b}, -1")
        low = w.value(f"icmp eq {t} {a}, {least}")
        overflow = w.value(f"and i1 {one}, {low}")
        bad = w.value(f"or i1 {zero}, {overflow}")
    safe = w.value(f"select i1 {bad}, {t} 1, {t} {b}")
    value = w.value(f"{'s' if signed else 'u'}{how} {t} {a}, {safe}")
    if how == "rem":
        return w.value(f"select i1 {zero}, {t} {a}, {t} {value}")
    return w.value(f"select i1 {zero}, {t} -1, {t} {value}")


def _order_zeros(w: FunctionWriter, how: str, type_: str, a: str, b: str, plain: str) -> str:
    """Choose between equal numbers by their bits: -0 is less than +0."""
    t, bits = llvm_type(type_), f"i{8 * SIZES[type_]}"
    same = w.value(f"fcmp oeq {t} {a}, {b}")
    x, y = (w.value(f"bitcast {t} {value} to {bits}") for value in (a, b))
    both = w.value(f"{'or' if how == 'min' else 'and'} {bits} {x}, {y}")
    chosen = w.value(f"bitcast {bits} {both} to {t}")
    return w.value(f"select i1 {same}, {t} {chosen}, {t} {plain}")


def _make_extreme(how: str) -> Handler:
    def handle(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
        type_ = type_in(w, words)
        a, b = w.read(operands[1], type_), w.read(operands[2], type_)
        t = llvm_type(type_)
        if is_float(type_):  # of a NaN and a number, the number
            plain = w.value(f"call {t} @llvm.{how}num.{type_}({t} {a}, {t} {b})")
            w.write(operands[0], _order_zeros(w, how, type_, a, b, plain), type_)
            return
        name = f"@llvm.{'s' if is_signed(type_) else 'u'}{how}.{t}"
        w.write(operands[0], w.value(f"call {t} {name}({t} {a}, {t} {b})"), type_)

    return handle


def write_neg(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    type_ = type_in(w, words)
    a, t = w.read(operands[1], type_), llvm_type(type_)
    text = f"fneg {t} {a}" if is_float(type_) else f"sub {t} 0, {a}"
    w.write(operands[0], w.value(text), type_)


def write_abs(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    type_ = type_in(w, words)
    a, t = w.read(operands[1], type_), llvm_type(type_)
    call = f"fabs.{type_}({t} {a})" if is_float(type_) else f"abs.{t}({t} {a}, i1 false)"
    w.write(operands[0], w.value(f"call {t} @llvm.{call}"), type_)


def _make_function(name: str) -> Handler:
    """Make the handler of a function of one number. Approximate functions are exact (9.7.3)."""

    def handle(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
        type_ = type_in(w, words)
        a, t = w.read(operands[1], type_), llvm_type(type_)
        w.write(operands[0], w.value(f"call {t} @llvm.{name}.{type_}({t} {a})"), type_)

    return handle


def write_rcp(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    type_ = type_in(w, words)
    a = w.read(operands[1], type_)
    w.write(operands[0], round_result(w, words, type_, "div", ["1.0", a]), type_)


def write_sqrt(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    type_ = type_in(w, words)
    w.write(operands[0], round_result(w, words, type_, "sqrt", [w.read(operands[1], type_)]), type_)


def write_copysign(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """Write the second operand with the sign of the first (9.7.3.5)."""
    type_ = type_in(w, words)
    a, b, t = w.read(operands[1], type_), w.read(operands[2], type_), llvm_type(type_)
    call = f"call {t} @llvm.copysign.{type_}({t} {b}, {t} {a})"
    w.write(operands[0], w.value(call), type_)


def write_testp(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """Test the kind of a float (9.7.3.1). The masks are those of LLVM's ``is.fpclass``."""
    type_ = type_in(w, words)
    a, t = w.read(operands[1], type_), llvm_type(type_)
    kinds = {"notanumber": 3, "number": 1020, "infinite": 516, "finite": 504, "normal": 264,
             "subnormal": 144}  # fmt: skip
    mask = next((kinds[word] for word in words if word in kinds), None)
    if mask is None:
        raise w.fail(f"'testp.{'.'.join(words)}' asks for no known kind")
    call = f"call i1 @llvm.is.fpclass.{type_}({t} {a}, i32 {mask})"
    w.write(operands[0], w.value(call), "pred")


def write_rsqrt(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    type_ = type_in(w, words)
    a, t = w.read(operands[1], type_), llvm_type(type_)
    root = w.value(f"call {t} @llvm.sqrt.{type_}({t} {a})")
    w.write(operands[0], w.value(f"fdiv {t} 1.0, {root}"), type_)


def write_tanh(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    a = w.read(operands[1], "f32")
    w.write(operands[0], w.value(f"call float @llvm.tanh.f32(float {a})"), "f32")


ARITHMETIC: dict[str, Handler] = {
    "add": _make_binary("add"),
    "sub": _make_binary("sub"),
    "addc": _make_carrying("add"),
    "subc": _make_carrying("sub"),
    "mul": write_mul,
    "mad": write_mad,
    "fma": write_mad,
    "madc": write_madc,
    "div": write_div,
    "rem": write_rem,
    "min": _make_extreme("min"),
    "max": _make_extreme("max"),
    "neg": write_neg,
    "abs": write_abs,
    "sqrt": write_sqrt,
    "copysign": write_copysign,
    "testp": write_testp,
    "sin": _make_function("sin"),
    "cos": _make_function("cos"),
    "lg2": _make_function("log2"),
    "ex2": _make_function("exp2"),
    "tanh": write_tanh,
    "rcp": write_rcp,
    "rsqrt": write_rsqrt,
}

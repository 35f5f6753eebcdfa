"""Arithmetic, comparison, logic and shifts (PTX ISA, 9.7.1 to 9.7.8)."""

from __future__ import annotations

from collections.abc import Callable

from nau_py.raytrace.ptx.compiler.reader import SIZES
from nau_py.raytrace.ptx.compiler.rounding import rounded
from nau_py.raytrace.ptx.compiler.writer import (
    FunctionWriter,
    float_text,
    is_float,
    is_signed,
    llvm,
)

Handler = Callable[[FunctionWriter, list[str], tuple[str, ...]], None]
_ORDERED = {"eq": "oeq", "ne": "one", "lt": "olt", "le": "ole", "gt": "ogt", "ge": "oge"}
_ORDERED |= {"equ": "ueq", "neu": "une", "ltu": "ult", "leu": "ule", "gtu": "ugt", "geu": "uge"}
_ORDERED |= {"num": "ord", "nan": "uno"}
_SIGNED = {"lt": "slt", "le": "sle", "gt": "sgt", "ge": "sge"}
_UNSIGNED = {"lt": "ult", "le": "ule", "gt": "ugt", "ge": "uge"}
_UNSIGNED |= {"lo": "ult", "ls": "ule", "hi": "ugt", "hs": "uge"}


def type_in(w: FunctionWriter, words: list[str]) -> str:
    """The last type that an opcode names."""
    found = next((word for word in reversed(words) if word in SIZES), None)
    if found is None:
        raise w.fail("the instruction names no type")
    return found


def _saturated(w: FunctionWriter, words: list[str], value: str, type_: str) -> str:
    """``.sat`` of a float: into 0..1, NaN to 0."""
    if "sat" not in words:
        return value
    t = llvm(type_)
    n = type_[1:]
    low = w.value(f"call {t} @llvm.maxnum.f{n}({t} {value}, {t} 0.0)")
    return w.value(f"call {t} @llvm.minnum.f{n}({t} {low}, {t} 1.0)")


def _binary(integer: str) -> Handler:
    def handle(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
        type_ = type_in(w, words)
        a, b = w.read(operands[1], type_), w.read(operands[2], type_)
        t = llvm(type_)
        if is_float(type_):
            value = _saturated(w, words, rounded(w, words, type_, integer, [a, b]), type_)
        elif "cc" in words:
            value = _with_carry(w, integer, t, a, b)
        elif "sat" in words:
            value = w.value(f"call {t} @llvm.s{integer}.sat.{t}({t} {a}, {t} {b})")
        else:
            value = w.value(f"{integer} {t} {a}, {b}")
        w.write(operands[0], value, type_)

    return handle


def _with_carry(w: FunctionWriter, how: str, t: str, a: str, b: str) -> str:
    pair = w.value(f"call {{{t}, i1}} @llvm.u{how}.with.overflow.{t}({t} {a}, {t} {b})")
    w.emit(f"store i1 {w.value(f'extractvalue {{{t}, i1}} {pair}, 1')}, ptr %carry")
    return w.value(f"extractvalue {{{t}, i1}} {pair}, 0")


def _carried(how: str) -> Handler:
    """``addc`` and ``subc``: with the carry of the one before."""

    def handle(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
        type_ = type_in(w, words)
        t = llvm(type_)
        a, b = w.read(operands[1], type_), w.read(operands[2], type_)
        w.write(operands[0], _chain(w, how, t, a, b, "cc" in words), type_)

    return handle


def _chain(w: FunctionWriter, how: str, t: str, a: str, b: str, keep: bool) -> str:
    carry = w.value(f"zext i1 {w.value('load i1, ptr %carry')} to {t}")
    name = f"@llvm.u{how}.with.overflow.{t}"
    first = w.value(f"call {{{t}, i1}} {name}({t} {a}, {t} {b})")
    part = w.value(f"extractvalue {{{t}, i1}} {first}, 0")
    second = w.value(f"call {{{t}, i1}} {name}({t} {part}, {t} {carry})")
    if keep:
        one, two = (w.value(f"extractvalue {{{t}, i1}} {p}, 1") for p in (first, second))
        w.emit(f"store i1 {w.value(f'or i1 {one}, {two}')}, ptr %carry")
    return w.value(f"extractvalue {{{t}, i1}} {second}, 0")


def _wide(w: FunctionWriter, type_: str, value: str) -> tuple[str, str]:
    """An integer at twice its width."""
    t = f"i{16 * SIZES[type_]}"
    how = "sext" if is_signed(type_) else "zext"
    return w.value(f"{how} {llvm(type_)} {value} to {t}"), t


def _product(w: FunctionWriter, words: list[str], type_: str, a: str, b: str) -> tuple[str, str]:
    """The product of integers, and its type: low half, high half or all of it."""
    t = llvm(type_)
    if "wide" in words and SIZES[type_] == 8:
        raise w.fail("a product of 128 bits fits no register")
    if "wide" in words or "hi" in words:
        (x, wide), (y, _) = _wide(w, type_, a), _wide(w, type_, b)
        all_ = w.value(f"mul {wide} {x}, {y}")
        if "wide" in words:
            return all_, type_[0] + str(16 * SIZES[type_])
        shifted = w.value(f"lshr {wide} {all_}, {8 * SIZES[type_]}")
        return w.value(f"trunc {wide} {shifted} to {t}"), type_
    return w.value(f"mul {t} {a}, {b}"), type_


def mul(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    type_ = type_in(w, words)
    a, b = w.read(operands[1], type_), w.read(operands[2], type_)
    if is_float(type_):
        product = rounded(w, words, type_, "mul", [a, b])
        w.write(operands[0], _saturated(w, words, product, type_), type_)
        return
    w.write(operands[0], *_product(w, words, type_, a, b))


def mad(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """``mad`` and ``fma``; with ``cc`` the sum sets the carry, in ``madc`` it takes it."""
    type_ = type_in(w, words)
    a, b = w.read(operands[1], type_), w.read(operands[2], type_)
    if is_float(type_):
        value = rounded(w, words, type_, "fma", [a, b, w.read(operands[3], type_)])
        w.write(operands[0], _saturated(w, words, value, type_), type_)
        return
    product, wide = _product(w, words, type_, a, b)
    c, t = w.read(operands[3], wide), llvm(wide)
    if "cc" in words:
        value = _with_carry(w, "add", t, product, c)
    else:
        value = w.value(f"add {t} {product}, {c}")
    w.write(operands[0], value, wide)


def madc(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    type_ = type_in(w, words)
    a, b = w.read(operands[1], type_), w.read(operands[2], type_)
    product, wide = _product(w, words, type_, a, b)
    c = w.read(operands[3], wide)
    w.write(operands[0], _chain(w, "add", llvm(wide), product, c, "cc" in words), wide)


def div(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    type_ = type_in(w, words)
    a, b = w.read(operands[1], type_), w.read(operands[2], type_)
    if is_float(type_):
        value = rounded(w, words, type_, "div", [a, b])
        w.write(operands[0], _of_huge(w, a, b, value) if "approx" in words else value, type_)
        return
    w.write(operands[0], _divided(w, "div", type_, a, b), type_)


def _of_huge(w: FunctionWriter, a: str, b: str, value: str) -> str:
    """``div.approx`` by more than 2**126: the reciprocal is 0 (9.7.3.8)."""
    size = w.value(f"call float @llvm.fabs.f32(float {b})")
    huge = w.value(f"fcmp ogt float {size}, {float_text(2.0**126, 'f32')}")
    finite = w.value(f"fcmp olt float {size}, {float_text(float('inf'), 'f32')}")
    zero = w.value(f"call float @llvm.copysign.f32(float 0.0, float {b})")
    product = w.value(f"fmul float {a}, {zero}")
    both = w.value(f"and i1 {huge}, {finite}")
    return w.value(f"select i1 {both}, float {product}, float {value}")


def rem(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    type_ = type_in(w, words)
    a, b = w.read(operands[1], type_), w.read(operands[2], type_)
    w.write(operands[0], _divided(w, "rem", type_, a, b), type_)


def _divided(w: FunctionWriter, how: str, type_: str, a: str, b: str) -> str:
    """By 0 there is no defined result, but there must be one: all bits set, as the hardware has
    it; and of the least by -1 nothing may trap."""
    t, signed = llvm(type_), is_signed(type_)
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


def _with_zero(w: FunctionWriter, how: str, type_: str, a: str, b: str, plain: str) -> str:
    """The lesser or greater of equal numbers: by their bits, for zeros have a sign."""
    t, bits = llvm(type_), f"i{8 * SIZES[type_]}"
    same = w.value(f"fcmp oeq {t} {a}, {b}")
    x, y = (w.value(f"bitcast {t} {value} to {bits}") for value in (a, b))
    both = w.value(f"{'or' if how == 'min' else 'and'} {bits} {x}, {y}")
    chosen = w.value(f"bitcast {bits} {both} to {t}")
    return w.value(f"select i1 {same}, {t} {chosen}, {t} {plain}")


def _extreme(how: str) -> Handler:
    def handle(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
        type_ = type_in(w, words)
        a, b = w.read(operands[1], type_), w.read(operands[2], type_)
        t = llvm(type_)
        if is_float(type_):  # of a NaN and a number, the number; -0 is less than +0
            plain = w.value(f"call {t} @llvm.{how}num.{type_}({t} {a}, {t} {b})")
            w.write(operands[0], _with_zero(w, how, type_, a, b, plain), type_)
            return
        name = f"@llvm.{'s' if is_signed(type_) else 'u'}{how}.{t}"
        w.write(operands[0], w.value(f"call {t} {name}({t} {a}, {t} {b})"), type_)

    return handle


def negate(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    type_ = type_in(w, words)
    a, t = w.read(operands[1], type_), llvm(type_)
    text = f"fneg {t} {a}" if is_float(type_) else f"sub {t} 0, {a}"
    w.write(operands[0], w.value(text), type_)


def absolute(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    type_ = type_in(w, words)
    a, t = w.read(operands[1], type_), llvm(type_)
    call = f"fabs.{type_}({t} {a})" if is_float(type_) else f"abs.{t}({t} {a}, i1 false)"
    w.write(operands[0], w.value(f"call {t} @llvm.{call}"), type_)


def _function(name: str) -> Handler:
    """A function of one number; approximate ones are exact here (9.7.3)."""

    def handle(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
        type_ = type_in(w, words)
        a, t = w.read(operands[1], type_), llvm(type_)
        w.write(operands[0], w.value(f"call {t} @llvm.{name}.{type_}({t} {a})"), type_)

    return handle


def reciprocal(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    type_ = type_in(w, words)
    a = w.read(operands[1], type_)
    w.write(operands[0], rounded(w, words, type_, "div", ["1.0", a]), type_)


def root(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    type_ = type_in(w, words)
    w.write(operands[0], rounded(w, words, type_, "sqrt", [w.read(operands[1], type_)]), type_)


def copysign(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """The second with the sign of the first (9.7.3.5)."""
    type_ = type_in(w, words)
    a, b, t = w.read(operands[1], type_), w.read(operands[2], type_), llvm(type_)
    call = f"call {t} @llvm.copysign.{type_}({t} {b}, {t} {a})"
    w.write(operands[0], w.value(call), type_)


def testp(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """What kind of number a float is."""
    type_ = type_in(w, words)
    a, t = w.read(operands[1], type_), llvm(type_)
    kinds = {"notanumber": 3, "number": 1020, "infinite": 516, "finite": 504, "normal": 264,
             "subnormal": 144}  # fmt: skip
    mask = next((kinds[word] for word in words if word in kinds), None)
    if mask is None:
        raise w.fail(f"'testp.{'.'.join(words)}' asks for no known kind")
    call = f"call i1 @llvm.is.fpclass.{type_}({t} {a}, i32 {mask})"
    w.write(operands[0], w.value(call), "pred")


def root_reciprocal(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    type_ = type_in(w, words)
    a, t = w.read(operands[1], type_), llvm(type_)
    root = w.value(f"call {t} @llvm.sqrt.{type_}({t} {a})")
    w.write(operands[0], w.value(f"fdiv {t} 1.0, {root}"), type_)


def tangent_hyperbolic(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    a = w.read(operands[1], "f32")
    w.write(operands[0], w.value(f"call float @llvm.tanh.f32(float {a})"), "f32")


def compare(w: FunctionWriter, words: list[str], type_: str, a: str, b: str) -> str:
    """The truth of a comparison."""
    how = words[0]
    t = llvm(type_)
    if is_float(type_):
        if how not in _ORDERED:
            raise w.fail(f"'{how}' compares no floats")
        return w.value(f"fcmp {_ORDERED[how]} {t} {a}, {b}")
    table = _SIGNED | {"eq": "eq", "ne": "ne"} if is_signed(type_) else _UNSIGNED
    known = table | {"eq": "eq", "ne": "ne"}
    if how not in known:
        raise w.fail(f"'{how}' compares no '{type_}'")
    return w.value(f"icmp {known[how]} {t} {a}, {b}")


def setp(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """``setp.lt.f32 p|q, a, b``, and combined with another predicate: ``setp.lt.and.f32 p, a, b,
    c``."""
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


def set_(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """``set.lt.u32.f32``: all bits, or 1.0, where it is true."""
    types = [x for x in words if x in SIZES]
    target, type_ = types[0], types[-1]
    truth = compare(w, words, type_, w.read(operands[1], type_), w.read(operands[2], type_))
    if len(operands) > 3:
        how = next((x for x in words if x in ("and", "or", "xor")), "and")
        truth = w.value(f"{how} i1 {truth}, {w.read(operands[3], 'pred')}")
    t = llvm(target)
    yes, no = ("1.0", "0.0") if is_float(target) else ("-1", "0")
    w.write(operands[0], w.value(f"select i1 {truth}, {t} {yes}, {t} {no}"), target)


def selp(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    type_ = type_in(w, words)
    a, b = w.read(operands[1], type_), w.read(operands[2], type_)
    p, t = w.read(operands[3], "pred"), llvm(type_)
    w.write(operands[0], w.value(f"select i1 {p}, {t} {a}, {t} {b}"), type_)


def slct(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """The first where the third is not negative, else the second."""
    type_, of = next(x for x in words if x in SIZES), type_in(w, words)
    a, b = w.read(operands[1], type_), w.read(operands[2], type_)
    c, t = w.read(operands[3], of), llvm(type_)
    truth = w.value(f"fcmp oge float {c}, 0.0" if of == "f32" else f"icmp sge {llvm(of)} {c}, 0")
    w.write(operands[0], w.value(f"select i1 {truth}, {t} {a}, {t} {b}"), type_)


def _logic(how: str) -> Handler:
    def handle(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
        type_ = type_in(w, words)
        a, b = w.read(operands[1], type_), w.read(operands[2], type_)
        w.write(operands[0], w.value(f"{how} {llvm(type_)} {a}, {b}"), type_)

    return handle


def not_(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    type_ = type_in(w, words)
    a, t = w.read(operands[1], type_), llvm(type_)
    w.write(operands[0], w.value(f"xor {t} {a}, {'true' if type_ == 'pred' else '-1'}"), type_)


def cnot(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    type_ = type_in(w, words)
    a, t = w.read(operands[1], type_), llvm(type_)
    truth = w.value(f"icmp eq {t} {a}, 0")
    w.write(operands[0], w.value(f"zext i1 {truth} to {t}"), type_)


def _shift(left: bool) -> Handler:
    """Shifts past the width give 0, of signed ones the sign (9.7.8)."""

    def handle(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
        type_ = type_in(w, words)
        bits, t = 8 * SIZES[type_], llvm(type_)
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


ARITHMETIC: dict[str, Handler] = {
    "add": _binary("add"),
    "sub": _binary("sub"),
    "addc": _carried("add"),
    "subc": _carried("sub"),
    "mul": mul,
    "mad": mad,
    "fma": mad,
    "madc": madc,
    "div": div,
    "rem": rem,
    "min": _extreme("min"),
    "max": _extreme("max"),
    "neg": negate,
    "abs": absolute,
    "sqrt": root,
    "copysign": copysign,
    "testp": testp,
    "sin": _function("sin"),
    "cos": _function("cos"),
    "lg2": _function("log2"),
    "ex2": _function("exp2"),
    "tanh": tangent_hyperbolic,
    "rcp": reciprocal,
    "rsqrt": root_reciprocal,
    "setp": setp,
    "set": set_,
    "selp": selp,
    "slct": slct,
    "and": _logic("and"),
    "or": _logic("or"),
    "xor": _logic("xor"),
    "not": not_,
    "cnot": cnot,
    "shl": _shift(True),
    "shr": _shift(False),
}

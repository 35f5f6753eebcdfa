"""Rounding towards zero, down or up (``.rz``, ``.rm``, ``.rp``; PTX ISA, 9.7.3).

The nearest result moves by one unit in the last place where it is on the wrong side of the exact
result. The sign of an exact error decides: TwoSum gives it for sums, a fused multiply-add for
products, quotients and roots. Errors of float32 are computed in float64 (Muller et al., *Handbook
of Floating-Point Arithmetic*, 2nd edition, chapters 4 and 5).
"""

from __future__ import annotations

from nau_py.raytrace.ptx.compiler.literals import llvm_type
from nau_py.raytrace.ptx.compiler.module import SIZES
from nau_py.raytrace.ptx.compiler.writer import FunctionWriter

MODES = ("rz", "rm", "rp")


def rounding_mode(words: list[str]) -> str:
    """Return the rounding direction of an opcode; empty for the nearest."""
    return next((word for word in words if word in MODES), "")


_Exact = tuple[str, str]
"""A result of higher precision: a sum of two doubles, the larger one first."""


def round_result(
    w: FunctionWriter, words: list[str], type_: str, how: str, values: list[str]
) -> str:
    """Compute ``how`` (add, sub, mul, div, sqrt, fma) with the rounding that an opcode names."""
    mode = rounding_mode(words)
    if mode:
        return _round_directed(w, mode, type_, how, values)
    return _round_nearest(w, type_, how, values)


def _round_nearest(w: FunctionWriter, type_: str, how: str, values: list[str]) -> str:
    t = llvm_type(type_)
    if how in ("sqrt", "fma"):
        listed = ", ".join(f"{t} {value}" for value in values)
        return w.value(f"call {t} @llvm.{how}.{type_}({listed})")
    return w.value(f"f{how} {t} {values[0]}, {values[1]}")


def _round_directed(w: FunctionWriter, mode: str, type_: str, how: str, values: list[str]) -> str:
    """Compute ``how`` and round in the direction ``mode``."""
    t = llvm_type(type_)
    if how == "fma" and type_ == "f64":
        raise w.fail("a fused multiply-add of doubles rounds to the nearest only")
    if how == "sub":
        values = [values[0], w.value(f"fneg {t} {values[1]}")]
        how = "add"
    near = _round_nearest(w, type_, how, values)
    wide = values
    if type_ == "f32":
        wide = [w.value(f"fpext float {value} to double") for value in values]
    exact = _compute_exact(w, how, wide)
    mine = near if type_ == "f64" else w.value(f"fpext float {near} to double")
    above, below = _compare_exact(w, exact, mine)
    if type_ == "f64":
        above, below = _correct_overflow(w, how, values, near, above, below)
    found = step_result(w, mode, type_, near, above, below)
    if mode == "rm" and how in ("add", "fma"):
        terms = wide if how == "add" else [w.value(f"fmul double {wide[0]}, {wide[1]}"), wide[2]]
        found = _negate_zero(w, type_, found, terms)
    return found


def _negate_zero(w: FunctionWriter, type_: str, found: str, terms: list[str]) -> str:
    """Return -0 for a sum of exactly 0 rounded down, unless both terms are +0 (IEEE 754, 6.3)."""
    t, bits = llvm_type(type_), f"i{8 * SIZES[type_]}"
    signs = [
        w.value(f"icmp slt i64 {w.value(f'bitcast double {term} to i64')}, 0") for term in terms
    ]
    zero = w.value(f"fcmp oeq {t} {found}, 0.0")
    turned = w.value(f"and i1 {zero}, {w.value(f'or i1 {signs[0]}, {signs[1]}')}")
    minus = w.value(f"bitcast {bits} {-(1 << (8 * SIZES[type_] - 1))} to {t}")
    return w.value(f"select i1 {turned}, {t} {minus}, {t} {found}")


def _fused(w: FunctionWriter, a: str, b: str, c: str) -> str:
    return w.value(f"call double @llvm.fma.f64(double {a}, double {b}, double {c})")


def _sum(w: FunctionWriter, a: str, b: str) -> _Exact:
    """Add two doubles without an error (Knuth's TwoSum)."""
    s = w.value(f"fadd double {a}, {b}")
    part = w.value(f"fsub double {s}, {a}")
    rest = w.value(f"fsub double {s}, {part}")
    low = w.value(f"fsub double {b}, {part}")
    other = w.value(f"fsub double {a}, {rest}")
    return s, w.value(f"fadd double {low}, {other}")


def _compute_exact(w: FunctionWriter, how: str, values: list[str]) -> _Exact:
    """Compute ``how`` of doubles with its error."""
    if how == "add":
        return _sum(w, values[0], values[1])
    if how == "fma":  # the product of two float32 is exact
        return _sum(w, w.value(f"fmul double {values[0]}, {values[1]}"), values[2])
    if how == "mul":
        p = w.value(f"fmul double {values[0]}, {values[1]}")
        minus = w.value(f"fneg double {p}")
        return p, _fused(w, values[0], values[1], minus)
    if how == "sqrt":
        s = w.value(f"call double @llvm.sqrt.f64(double {values[0]})")
        minus = w.value(f"fneg double {s}")
        return s, _fused(w, minus, s, values[0])
    q = w.value(f"fdiv double {values[0]}, {values[1]}")
    minus = w.value(f"fneg double {q}")
    rest = _fused(w, minus, values[1], values[0])
    negative = w.value(f"fcmp olt double {values[1]}, 0.0")
    turned = w.value(f"fneg double {rest}")
    low = w.value(f"select i1 {negative}, double {turned}, double {rest}")
    return q, low


def _compare_exact(w: FunctionWriter, exact: _Exact, mine: str) -> tuple[str, str]:
    """Compare the exact result with ``mine``: two ``i1``, for above and below."""
    same = w.value(f"fcmp oeq double {exact[0]}, {mine}")
    found = []
    for sign in ("ogt", "olt"):
        far = w.value(f"fcmp {sign} double {exact[0]}, {mine}")
        near = w.value(f"fcmp {sign} double {exact[1]}, 0.0")
        little = w.value(f"and i1 {same}, {near}")
        found.append(w.value(f"or i1 {far}, {little}"))
    return found[0], found[1]


def _correct_overflow(
    w: FunctionWriter, how: str, values: list[str], near: str, above: str, below: str
) -> tuple[str, str]:
    """Treat a double that overflowed as too large: no wider type shows its error."""
    finite = "true"
    for value in values:
        size = w.value(f"call double @llvm.fabs.f64(double {value})")
        test = w.value(f"fcmp olt double {size}, 0x7FF0000000000000")
        finite = w.value(f"and i1 {finite}, {test}")
    if how == "div":  # the exact quotient by 0 is infinite
        some = w.value(f"fcmp one double {values[1]}, 0.0")
        finite = w.value(f"and i1 {finite}, {some}")
    up = w.value(f"fcmp oeq double {near}, 0x7FF0000000000000")
    down = w.value(f"fcmp oeq double {near}, 0xFFF0000000000000")
    over, under = w.value(f"and i1 {finite}, {up}"), w.value(f"and i1 {finite}, {down}")
    return w.value(f"or i1 {above}, {under}"), w.value(f"or i1 {below}, {over}")


def step_result(w: FunctionWriter, mode: str, type_: str, near: str, above: str, below: str) -> str:
    """Return the nearest result, or its neighbour in the direction of ``mode`` if that is due.

    ``above``, ``below``: ``i1``, the exact result is above or below ``near``.
    """
    t, bits = llvm_type(type_), f"i{8 * SIZES[type_]}"
    word = w.value(f"bitcast {t} {near} to {bits}")
    negative = w.value(f"icmp slt {bits} {word}, 0")
    more, less = w.value(f"add {bits} {word}, 1"), w.value(f"sub {bits} {word}, 1")
    if mode == "rz":
        wrong = w.value(f"select i1 {negative}, i1 {above}, i1 {below}")
        moved = less
    elif mode == "rp":
        wrong = above
        moved = w.value(f"select i1 {negative}, {bits} {less}, {bits} {more}")
    else:
        wrong = below
        moved = w.value(f"select i1 {negative}, {bits} {more}, {bits} {less}")
    chosen = w.value(f"select i1 {wrong}, {bits} {moved}, {bits} {word}")
    return w.value(f"bitcast {bits} {chosen} to {t}")


def narrow_float(w: FunctionWriter, mode: str, value: str) -> str:
    """Round a float64 to float32."""
    near = w.value(f"fptrunc double {value} to float")
    back = w.value(f"fpext float {near} to double")
    above = w.value(f"fcmp ogt double {value}, {back}")
    below = w.value(f"fcmp olt double {value}, {back}")
    return step_result(w, mode, "f32", near, above, below)


def round_integer(
    w: FunctionWriter, mode: str, value: str, source: str, signed: bool, type_: str
) -> str:
    """Round an integer of LLVM's type ``source`` to a float."""
    t, sign = llvm_type(type_), "s" if signed else "u"
    near = w.value(f"{sign}itofp {source} {value} to {t}")
    back = w.value(f"call i128 @llvm.fptosi.sat.i128.{type_}({t} {near})")
    wide = w.value(f"{'s' if signed else 'z'}ext {source} {value} to i128")
    above = w.value(f"icmp sgt i128 {wide}, {back}")
    below = w.value(f"icmp slt i128 {wide}, {back}")
    return step_result(w, mode, type_, near, above, below)

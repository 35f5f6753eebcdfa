"""Single PTX instructions against NumPy: NaN, infinity, denormals, overflow, shifts past the width.

Expected values follow the PTX ISA, sections 9.7.1 to 9.7.9, computed by NumPy or by Python's integers.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tests.raytrace.ptx.bench import Array, run

F = np.array(
    [0.0, -0.0, 1.0, -1.0, 0.5, 3.75, -2.25, 1e-40, -1e-45, 3e38, -3e38, np.inf, -np.inf, np.nan,
     1e-20, 123456.789],
    np.float32,
)  # fmt: skip
D = F.astype(np.float64) * np.float64(1.0000000001)
I = np.array(  # noqa: E741
    [
        0,
        1,
        -1,
        2,
        7,
        -7,
        2**31 - 1,
        -(2**31),
        123456789,
        -123456789,
        255,
        256,
        65535,
        -65536,
        31,
        33,
    ],
    np.int32,
)
L = np.array(
    [0, 1, -1, 2**63 - 1, -(2**63), 2**32, -(2**32), 1234567890123, 63, 64, 65, -64, 255, 7, -7, 2],
    np.int64,
)
A, B = np.repeat(F, len(F)), np.tile(F, len(F))
P, Q = np.repeat(I, len(I)), np.tile(I, len(I))
U, V = P.view(np.uint32), Q.view(np.uint32)
M, N = np.repeat(L, len(L)), np.tile(L, len(L))


def same_floats(found: Array, wanted: Array, ulps: float = 0.5) -> None:
    """NaNs, infinities and signed zeros are equal; the rest within ``ulps`` units in the last place."""
    kind = found.dtype.type
    wanted = wanted.astype(kind)
    nan = np.isnan(wanted)
    assert (np.isnan(found) == nan).all()
    rest = ~nan
    big = ~np.isfinite(wanted) & rest
    assert (found[big] == wanted[big]).all()
    zero = (wanted == 0) & rest
    assert (found[zero] == 0).all()
    assert (np.signbit(found[zero]) == np.signbit(wanted[zero])).all()
    plain = rest & ~big & ~zero
    assert (np.abs(found[plain] - wanted[plain]) <= ulps * np.spacing(np.abs(wanted[plain]))).all()


def quiet(work: Callable[[], Array]) -> Array:
    with np.errstate(all="ignore"):
        return work()


@pytest.mark.parametrize(
    "opcode, wanted",
    [
        ("add.f32", lambda: A + B),
        ("sub.rn.f32", lambda: A - B),
        ("mul.f32", lambda: A * B),
        ("div.rn.f32", lambda: A / B),
        ("min.f32", lambda: np.fmin(A, B)),
        ("max.f32", lambda: np.fmax(A, B)),
    ],
)
def test_floats(opcode: str, wanted: Callable[[], Array]) -> None:
    found = run(f"{opcode} %d, %a0, %a1;", [("f32", A), ("f32", B)], "f32")
    expected = quiet(wanted)
    if opcode[:3] in ("min", "max"):  # of +0 and -0 either may come
        both = (A == 0) & (B == 0)
        found[both], expected[both] = 0, 0
    same_floats(found, expected)


def test_fused_multiply_add_rounds_once() -> None:
    a = np.float32(1 + 2.0**-12)
    x = np.full(1, a)
    found = run("fma.rn.f32 %d, %a0, %a1, %a2;", [("f32", x), ("f32", x), ("f32", -x * x)], "f32")
    exact = float(a) * float(a) - float(np.float32(float(a) * float(a)))
    assert found[0] == np.float32(exact) != 0


@pytest.mark.parametrize("opcode", ["add", "mul", "sub"])
def test_flush_to_zero(opcode: str) -> None:
    """Denormal operands and results are zeros of their sign."""

    def flushed(x: Array) -> Array:
        return np.where(np.abs(x) < np.finfo(np.float32).tiny, np.copysign(np.float32(0), x), x)

    a, b = flushed(A), flushed(B)
    work: dict[str, Callable[[], Array]] = {
        "add": lambda: a + b, "mul": lambda: a * b, "sub": lambda: a - b,
    }  # fmt: skip
    found = run(f"{opcode}.ftz.f32 %d, %a0, %a1;", [("f32", A), ("f32", B)], "f32")
    same_floats(found, flushed(quiet(work[opcode])))


def test_saturation() -> None:
    found = run("add.sat.f32 %d, %a0, %a1;", [("f32", A), ("f32", B)], "f32")
    total = quiet(lambda: A + B)
    wanted = np.where(np.isnan(total), 0, np.clip(total, 0, 1)).astype(np.float32)
    assert (found == wanted).all()


@pytest.mark.parametrize(
    "opcode, wanted, ulps",
    [
        ("neg.f32", lambda: -F, 0),
        ("abs.f32", lambda: np.abs(F), 0),
        ("sqrt.rn.f32", lambda: np.sqrt(F), 0.5),
        ("sqrt.approx.f32", lambda: np.sqrt(F), 1),
        ("rcp.rn.f32", lambda: 1 / F, 0.5),
        ("rsqrt.approx.f32", lambda: 1 / np.sqrt(F.astype(float)), 2),
        ("sin.approx.f32", lambda: np.sin(F.astype(float)), 2),
        ("cos.approx.f32", lambda: np.cos(F.astype(float)), 2),
        ("ex2.approx.f32", lambda: np.exp2(F.astype(float)), 2),
        ("lg2.approx.f32", lambda: np.log2(F.astype(float)), 2),
    ],
)
def test_functions(opcode: str, wanted: Callable[[], Array], ulps: float) -> None:
    found = run(f"{opcode} %d, %a0;", [("f32", F)], "f32")
    same_floats(found, quiet(wanted).astype(np.float32), ulps)


@pytest.mark.parametrize(
    "opcode, wanted",
    [
        ("add.f64", lambda: D + D[::-1]),
        ("mul.f64", lambda: D * D[::-1]),
        ("div.rn.f64", lambda: D / D[::-1]),
        ("sub.rn.f64", lambda: D - D[::-1]),
    ],
)
def test_doubles(opcode: str, wanted: Callable[[], Array]) -> None:
    found = run(f"{opcode} %d, %a0, %a1;", [("f64", D), ("f64", D[::-1])], "f64")
    same_floats(found, quiet(wanted))


def wrapped(values: list[int], bits: int, signed: bool) -> list[int]:
    """Integers modulo 2**bits."""
    cut = [v & ((1 << bits) - 1) for v in values]
    return [v - (1 << bits) if signed and v >> (bits - 1) else v for v in cut]


INTEGER: dict[str, Callable[[int, int], int]] = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul.lo": lambda a, b: a * b,
    "min": min,
    "max": max,
    "div": lambda a, b: (
        -1 if b == 0 else int(math.copysign(1, a) * math.copysign(1, b)) * (abs(a) // abs(b))
    ),
    "rem": lambda a, b: a if b == 0 else int(math.copysign(1, a)) * (abs(a) % abs(b)),
    "and": lambda a, b: a & b,
    "or": lambda a, b: a | b,
    "xor": lambda a, b: a ^ b,
}


@pytest.mark.parametrize("type_", ["s32", "u32", "s64", "u64"])
@pytest.mark.parametrize("opcode", sorted(INTEGER))
def test_integers(opcode: str, type_: str) -> None:
    """Wrap around; division by 0 gives all bits, and nothing traps."""
    bits, signed = int(type_[1:]), type_[0] == "s"
    a, b = (P, Q) if bits == 32 else (M, N)
    if not signed:
        a, b = (x.view(np.uint32 if bits == 32 else np.uint64) for x in (a, b))
    written = f"b{bits}" if opcode in ("and", "or", "xor") else type_
    found = run(f"{opcode}.{written} %d, %a0, %a1;", [(type_, a), (type_, b)], type_)
    wanted = [INTEGER[opcode](x, y) for x, y in zip(a.tolist(), b.tolist())]
    assert found.tolist() == wrapped(wanted, bits, signed)


def test_wide_and_high_products() -> None:
    wide = run("mul.wide.s32 %d, %a0, %a1;", [("s32", P), ("s32", Q)], "s64")
    assert wide.tolist() == [x * y for x, y in zip(P.tolist(), Q.tolist())]
    high = run("mul.hi.u32 %d, %a0, %a1;", [("u32", U), ("u32", V)], "u32")
    assert high.tolist() == [x * y >> 32 for x, y in zip(U.tolist(), V.tolist())]
    mad = run("mad.lo.s32 %d, %a0, %a1, %a0;", [("s32", P), ("s32", Q)], "s32")
    assert mad.tolist() == wrapped([x * y + x for x, y in zip(P.tolist(), Q.tolist())], 32, True)


def test_carries() -> None:
    """128 bits in two halves: the sum, and the product's middle, as nvcc writes them."""
    low = run("add.cc.u32 %i0, %a0, %a1; addc.u32 %d, %a0, 0;", [("u32", U), ("u32", V)], "u32")
    carry = [(x + y) >> 32 for x, y in zip(U.tolist(), V.tolist())]
    assert low.tolist() == [(x + c) & 0xFFFFFFFF for x, c in zip(U.tolist(), carry)]
    body = "sub.cc.u32 %i0, %a0, %a1; subc.u32 %d, %a0, 0;"
    less = run(body, [("u32", U), ("u32", V)], "u32")
    borrow = [int(x < y) for x, y in zip(U.tolist(), V.tolist())]
    assert less.tolist() == [(x - b) & 0xFFFFFFFF for x, b in zip(U.tolist(), borrow)]
    body = "mad.lo.cc.u32 %i0, %a0, %a1, %a1; madc.hi.u32 %d, %a0, %a1, 0;"
    high = run(body, [("u32", U), ("u32", V)], "u32")
    pairs = zip(U.tolist(), V.tolist())
    assert high.tolist() == [((x * y + y) >> 32) & 0xFFFFFFFF for x, y in pairs]


@pytest.mark.parametrize(
    "opcode, type_", [("shl", "b32"), ("shr", "u32"), ("shr", "s32"), ("shr", "s64")]
)
def test_shifts_past_the_width(opcode: str, type_: str) -> None:
    bits, signed = int(type_[1:]), type_[0] == "s"
    a = {"b32": U, "u32": U, "s32": P, "s64": M}[type_]
    by = np.tile(np.array([0, 1, 5, 31, 32, 33, 63, 64, 65, 4294967295], np.uint32), len(a))
    a = np.repeat(a, 10)
    found = run(f"{opcode}.{type_} %d, %a0, %a1;", [(type_, a), ("u32", by)], type_)
    wanted = []
    for value, shift in zip(a.tolist(), by.tolist()):
        moved = value << min(shift, bits) if opcode == "shl" else value >> min(shift, bits)
        wanted.append(moved)
    assert found.tolist() == wrapped(wanted, bits, signed)


@pytest.mark.parametrize(
    "how",
    ["eq", "ne", "lt", "le", "gt", "ge", "equ", "neu", "ltu", "leu", "gtu", "geu", "num", "nan"],
)
def test_float_comparisons(how: str) -> None:
    """With a NaN ordered comparisons are false, those with u are true."""
    body = f"setp.{how}.f32 %p1, %a0, %a1; selp.u32 %d, 1, 0, %p1;"
    found = run(body, [("f32", A), ("f32", B)], "u32").astype(bool)
    nan = np.isnan(A) | np.isnan(B)
    plain = {"eq": A == B, "ne": A != B, "lt": A < B, "le": A <= B, "gt": A > B, "ge": A >= B}
    if how in ("num", "nan"):
        wanted = nan if how == "nan" else ~nan
    else:
        wanted = (plain[how[:2]] & ~nan) | (nan if how.endswith("u") else False)
    assert (found == wanted).all()


@pytest.mark.parametrize("how", ["eq", "ne", "lt", "le", "gt", "ge"])
def test_integer_comparisons(how: str) -> None:
    for type_, a, b in (("s32", P, Q), ("u32", U, V)):
        body = f"setp.{how}.{type_} %p1, %a0, %a1; selp.u32 %d, 1, 0, %p1;"
        found = run(body, [(type_, a), (type_, b)], "u32").astype(bool)
        plain = {"eq": a == b, "ne": a != b, "lt": a < b, "le": a <= b, "gt": a > b, "ge": a >= b}
        assert (found == plain[how]).all()


def test_predicates_and_guards() -> None:
    body = (
        "setp.lt.s32 %p1|%p2, %a0, %a1; setp.gt.and.s32 %p3, %a0, 0, %p2; mov.u32 %d, 0;"
        "@%p1 add.u32 %d, %d, 1; @!%p1 add.u32 %d, %d, 2; @%p3 add.u32 %d, %d, 4;"
    )
    found = run(body, [("s32", P), ("s32", Q)], "u32")
    less = P < Q
    wanted = np.where(less, 1, 2) + np.where((P > 0) & ~less, 4, 0)
    assert (found == wanted).all()


def test_branches_and_loops() -> None:
    """The sum of 1 to n by a loop; a jump over an instruction."""
    body = (
        "mov.u32 %d, 0; mov.u32 %i0, 0;\nLOOP:\n\tadd.u32 %i0, %i0, 1; add.u32 %d, %d, %i0;"
        "setp.lt.u32 %p1, %i0, %a0; @%p1 bra LOOP; bra DONE; mov.u32 %d, 77;\nDONE:\n\t"
    )
    n = np.arange(1, 40, dtype=np.uint32)
    assert run(body, [("u32", n)], "u32").tolist() == [k * (k + 1) // 2 for k in n.tolist()]


def clamped(value: float, bits: int, signed: bool) -> int:
    if math.isnan(value):
        return 0
    low, high = (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) if signed else (0, 2**bits - 1)
    return int(min(max(value, low), high))


ROUND: dict[str, Callable[[Any], Any]] = {
    "rni": np.rint, "rzi": np.trunc, "rmi": np.floor, "rpi": np.ceil,
}  # fmt: skip


@pytest.mark.parametrize("rounding", sorted(ROUND))
@pytest.mark.parametrize("to", ["s32", "u32", "s64"])
def test_floats_to_integers(rounding: str, to: str) -> None:
    """Out of range clamps, NaN gives 0."""
    found = run(f"cvt.{rounding}.{to}.f32 %d, %a0;", [("f32", F)], to)
    rounded = ROUND[rounding](F.astype(float))
    bits, signed = int(to[1:]), to[0] == "s"
    assert found.tolist() == [clamped(v, bits, signed) for v in rounded.tolist()]


def test_other_conversions() -> None:
    assert (
        run("cvt.rn.f32.s32 %d, %a0;", [("s32", P)], "f32").tolist()
        == P.astype(np.float32).tolist()
    )
    assert (
        run("cvt.rn.f32.u32 %d, %a0;", [("u32", U)], "f32").tolist()
        == U.astype(np.float32).tolist()
    )
    same_floats(run("cvt.f64.f32 %d, %a0;", [("f32", F)], "f64"), F.astype(np.float64))
    same_floats(
        run("cvt.rn.f32.f64 %d, %a0;", [("f64", D)], "f32"), quiet(lambda: D.astype(np.float32))
    )
    same_floats(run("cvt.rzi.f64.f64 %d, %a0;", [("f64", D)], "f64"), np.trunc(D))
    assert run("cvt.s64.s32 %d, %a0;", [("s32", P)], "s64").tolist() == P.tolist()
    assert run("cvt.u64.u32 %d, %a0;", [("u32", U)], "u64").tolist() == U.tolist()
    assert run("cvt.u32.u64 %d, %a0;", [("u64", M.view(np.uint64))], "u32").tolist() == wrapped(
        M.tolist(), 32, False
    )


def test_bits() -> None:
    listed = U.tolist()
    assert run("popc.b32 %d, %a0;", [("u32", U)], "u32").tolist() == [v.bit_count() for v in listed]
    assert run("clz.b32 %d, %a0;", [("u32", U)], "u32").tolist() == [
        32 - v.bit_length() for v in listed
    ]
    wide = M.view(np.uint64)
    assert run("clz.b64 %d, %a0;", [("u64", wide)], "u32").tolist() == [
        64 - v.bit_length() for v in wide.tolist()
    ]
    assert run("brev.b32 %d, %a0;", [("u32", U)], "u32").tolist() == [
        int(f"{v:032b}"[::-1], 2) for v in listed
    ]
    assert run("not.b32 %d, %a0;", [("u32", U)], "u32").tolist() == [v ^ 0xFFFFFFFF for v in listed]
    place = run("bfind.u32 %d, %a0;", [("u32", U)], "s32").tolist()
    assert place == [v.bit_length() - 1 for v in listed]


@pytest.mark.parametrize("type_", ["u32", "s32", "u64"])
def test_bit_fields(type_: str) -> None:
    """Positions and lengths past the width; signed fields are extended by their sign."""
    bits, signed = int(type_[1:]), type_[0] == "s"
    values = {"u32": U, "s32": P, "u64": M.view(np.uint64)}[type_][:48]
    begins, lengths = np.array([0, 3, 20, 31, 32, 40, 255]), np.array([0, 1, 5, 16, 32, 64, 255])
    grid = np.array(np.meshgrid(values, begins, lengths, indexing="ij")).reshape(3, -1)
    a, b, c = (
        values.repeat(49),
        np.tile(begins.repeat(7), len(values)),
        np.tile(lengths, 7 * len(values)),
    )
    assert len(a) == grid.shape[1]
    inputs = [(type_, a), ("u32", b), ("u32", c)]
    found = run(f"bfe.{type_} %d, %a0, %a1, %a2;", inputs, type_).tolist()
    wanted = []
    for value, begin, length in zip(a.tolist(), b.tolist(), c.tolist()):
        big = value if signed else value & ((1 << bits) - 1)
        field = (big >> min(begin, bits)) & ((1 << min(length, bits)) - 1)
        if signed and length and field >> (min(length, bits) - 1):
            field -= 1 << min(length, bits)
        wanted.append(field)
    assert found == wrapped(wanted, bits, signed)


def test_bit_field_insert_and_permute() -> None:
    body = "bfi.b32 %d, %a0, %a1, 5, 9;"
    found = run(body, [("u32", U), ("u32", V)], "u32").tolist()
    mask = (2**9 - 1) << 5
    assert found == [((x << 5) & mask) | (y & ~mask) for x, y in zip(U.tolist(), V.tolist())]
    found = run("prmt.b32 %d, %a0, %a1, 0x7198;", [("u32", U), ("u32", V)], "u32").tolist()
    wanted = []
    for x, y in zip(U.tolist(), V.tolist()):
        data = struct.pack("<II", x, y)
        sign = [0xFF if data[k] & 0x80 else 0 for k in (0, 1)]
        wanted.append(sign[0] | sign[1] << 8 | data[1] << 16 | data[7] << 24)
    assert found == wanted


def test_moves_and_vectors() -> None:
    body = "mov.b64 {%i0, %i1}, %a0; mov.b64 %d, {%i1, %i0};"
    wide = M.view(np.uint64)
    found = run(body, [("u64", wide)], "u64").tolist()
    assert found == [(v >> 32) | (v & 0xFFFFFFFF) << 32 for v in wide.tolist()]
    bits = run("mov.b32 %d, %a0;", [("f32", F)], "u32")
    assert (bits == F.view(np.uint32)).all()
    assert run("mov.f32 %d, 0f3FC00000;", [("f32", F)], "f32").tolist() == [1.5] * len(F)
    assert run("mov.f64 %d, 0dBFF8000000000000;", [("f32", F)], "f64").tolist() == [-1.5] * len(F)
    body = "slct.u32.s32 %d, 11, 22, %a0;"
    assert run(body, [("s32", I)], "u32").tolist() == [11 if v >= 0 else 22 for v in I.tolist()]


def test_memory_of_all_widths() -> None:
    """Signed bytes are extended by their sign; a wide register is cut off when it is stored."""
    small = np.array([0, 1, 127, -128, -1, 77], np.int8)
    assert run("cvt.s32.s16 %d, %a0;", [("s8", small)], "s32").tolist() == small.tolist()
    found = run("st.u32 [%at1], %a0; ld.u32 %d, [%at1];", [("u64", M.view(np.uint64))], "u32")
    assert found.tolist() == wrapped(M.tolist(), 32, False)


def test_blocks_have_registers_of_their_own() -> None:
    """Declarations of a block shadow outer ones, for single and numbered registers."""
    body = (
        "mov.u32 %i1, 5; mov.u32 %i2, 7;\n"
        "{ .reg .b32 %i1; .reg .b64 %l<3>; mov.u32 %i1, 9; mov.u64 %l2, 1; add.u32 %i2, %i1, %i2; }\n"
        "{ .reg .b32 %i<4>; mov.u32 %i1, 100; { .reg .b32 %i1; mov.u32 %i1, 1000; } "
        "add.u32 %d, %a0, %i1; }\n"
        "add.u32 %d, %d, %i1; add.u32 %d, %d, %i2;"
    )
    np.testing.assert_array_equal(run(body, {"u32": U}, "u32"), U + np.uint32(100 + 5 + 16))


def test_parameters_of_calls_have_the_width_of_their_block() -> None:
    """A parameter's name is used again with more bytes: its neighbours are not overwritten."""
    body = (
        "{ .param .b32 param0; st.param.b32 [param0], %a0; ld.param.b32 %i1, [param0]; }\n"
        "{ .param .align 8 .b8 param0[16]; mov.u64 %l1, 77; st.param.v2.b64 [param0], {%l1, %l1};"
        " ld.param.b64 %l2, [param0+8]; }\n"
        "cvt.u32.u64 %i2, %l2; add.u32 %d, %i1, %i2;"
    )
    np.testing.assert_array_equal(run(body, {"u32": U}, "u32"), U + np.uint32(77))


def test_branches_by_a_list_of_labels() -> None:
    body = (
        "and.b32 %i1, %a0, 3;\n brx.idx %i1, LIST;\nLIST: .branchtargets A, B, C, A;\n"
        "A: mov.u32 %d, 10; bra END;\nB: mov.u32 %d, 20; bra END;\nC: mov.u32 %d, 30;\nEND:"
    )
    wanted = np.array([10, 20, 30, 10], np.uint32)[U & 3]
    np.testing.assert_array_equal(run(body, {"u32": U}, "u32"), wanted)


@pytest.mark.parametrize("table", [0x00, 0xFF, 0xCA, 0x96, 0xE8, 0x01])
def test_logic_by_a_table(table: int) -> None:
    """Bit k of the result is bit ``4 a + 2 b + c`` of the table (9.7.8.6)."""
    third = U ^ (V << 3)
    found = run(
        f"lop3.b32 %d, %a0, %a1, %a2, {table};", [("u32", U), ("u32", V), ("u32", third)], "u32"
    )
    wanted = np.zeros_like(U)
    for bit in range(32):
        a, b, c = (x >> np.uint32(bit) & 1 for x in (U, V, third))
        wanted |= (np.uint32(table) >> (4 * a + 2 * b + c) & 1) << np.uint32(bit)
    np.testing.assert_array_equal(found, wanted)


def test_dot_products_and_short_products() -> None:
    x = P.astype("<i4").view(np.int16).reshape(-1, 2).astype(np.int64)
    y = Q.astype("<i4").view(np.uint8).reshape(-1, 4).astype(np.int64)
    wanted = (x * y[:, 2:]).sum(axis=1) + 5
    found = run("dp2a.hi.s32.u32 %d, %a0, %a1, 5;", [("s32", P), ("s32", Q)], "s32")
    np.testing.assert_array_equal(found, wanted.astype(np.int32))
    low = [(v.astype(np.int64) << 40) >> 40 for v in (P, Q)]
    found = run("mad24.lo.s32 %d, %a0, %a1, 7;", [("s32", P), ("s32", Q)], "s32")
    np.testing.assert_array_equal(found, (low[0] * low[1] + 7).astype(np.int32))
    found = run("mul24.hi.s32 %d, %a0, %a1;", [("s32", P), ("s32", Q)], "s32")
    np.testing.assert_array_equal(found, (low[0] * low[1] >> 16).astype(np.int32))


@pytest.mark.parametrize(
    "kind, wanted",
    [
        ("finite", np.isfinite(F)),
        ("infinite", np.isinf(F)),
        ("number", ~np.isnan(F)),
        ("notanumber", np.isnan(F)),
        ("normal", np.isfinite(F) & (np.abs(F) >= np.finfo(np.float32).tiny)),
        ("subnormal", (F != 0) & (np.abs(F) < np.finfo(np.float32).tiny)),
    ],
)
def test_kinds_of_numbers(kind: str, wanted: Array) -> None:
    found = run(f"testp.{kind}.f32 %p1, %a0; selp.u32 %d, 1, 0, %p1;", {"f32": F}, "u32")
    np.testing.assert_array_equal(found, wanted.astype(np.uint32))


def test_atomic_operations_return_the_old_value() -> None:
    """Each launch index has its own memory: its output."""
    body = (
        "st.global.u32 [%at1], %a0; atom.global.inc.u32 %i1, [%at1], 7; ld.global.u32 %i2, [%at1];\n"
        "red.global.max.s32 [%at1], -3; atom.global.cas.b32 %i3, [%at1], %i2, 99;\n"
        "sub.u32 %d, %i2, %i1;"
    )
    found = run(body, {"u32": U}, "u32")
    wanted = np.where(U >= 7, np.uint32(0), U + np.uint32(1)) - U
    np.testing.assert_array_equal(found, wanted)


@pytest.mark.parametrize("mode", ["rz", "rm", "rp"])
def test_doubles_become_floats_by_direction(mode: str) -> None:
    values = np.concatenate([D, np.array([1 + 2.0**-40, -1 - 2.0**-40, 1e39, -1e39, 2.0**-200])])
    found = run(f"cvt.{mode}.f32.f64 %d, %a0;", {"f64": values}, "f32").astype(np.float64)
    finite = np.isfinite(values)
    if mode == "rp":
        assert (found[finite] >= values[finite]).all()
    elif mode == "rm":
        assert (found[finite] <= values[finite]).all()
    else:
        assert (np.abs(found[finite]) <= np.abs(values[finite])).all()
    near = quiet(lambda: values.astype(np.float32))
    steps = found[finite].astype(np.float32).view(np.int32).astype(np.int64)
    assert (np.abs(steps - near[finite].view(np.int32)) <= 1).all()


@pytest.mark.parametrize("mode", ["rz", "rm", "rp"])
@pytest.mark.parametrize("how", ["add", "mul", "div"])
def test_doubles_that_overflow_round_by_direction(how: str, mode: str) -> None:
    """A finite result that overflows rounds to the largest number; infinity stays infinite."""
    big = np.array([1.7e308, -1.7e308, np.inf, 1.0, 1.7e308])
    other = {"add": big, "mul": np.full(5, 10.0), "div": np.array([0.1, 0.1, 0.1, 0.0, 0.0])}[how]
    most = np.finfo(np.float64).max
    found = run(f"{how}.{mode}.f64 %d, %a0, %a1;", [("f64", big), ("f64", other)], "f64")
    assert found[0] == (np.inf if mode == "rp" else most)
    assert found[1] == (-np.inf if mode == "rm" else -most)
    assert found[2] == np.inf
    if how == "div":
        assert (found[3:] == np.inf).all()

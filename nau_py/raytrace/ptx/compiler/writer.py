"""One function of a module as text of LLVM's language: its registers, blocks and operands.

Registers are memory on the stack, which LLVM's optimiser turns into values again. Integers have no
sign, as in LLVM; the type of an instruction says how one is meant.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Callable
from dataclasses import dataclass, field

from nau_py.raytrace.ptx.compiler.reader import (
    SIZES,
    PtxError,
    PtxFunction,
    PtxInstruction,
    PtxModule,
    PtxVariable,
)

FRAME = "%frame"
"""The hidden first argument of every function: what runs, for whom (``optix7``)."""
_HEX_FLOAT = re.compile(r"0[fF]([0-9A-Fa-f]{8})$")
_HEX_DOUBLE = re.compile(r"0[dD]([0-9A-Fa-f]{16})$")
WHOLE_NUMBER = re.compile(r"-?(0[xX][0-9A-Fa-f]+|0[bB][01]+|0[0-7]*|[1-9]\d*)U?$")
_DECIMAL = re.compile(r"-?(\d+\.\d*|\.\d+|\d+)([eE][+-]?\d+)?$")
_ADDRESS = re.compile(r"\[\s*([^\s+\]]+)\s*(?:\+\s*(-?\w+)\s*)?\]$")
_SPECIAL = re.compile(r"%(n?tid|n?ctaid|laneid|warpid|nwarpid|smid|nsmid|clock|clock64)(\.[xyz])?$")


def llvm(type_: str) -> str:
    """LLVM's type of a PTX type."""
    if type_ == "pred":
        return "i1"
    if type_ in ("f32", "f64"):
        return "float" if type_ == "f32" else "double"
    return f"i{8 * SIZES[type_]}"


def is_float(type_: str) -> bool:
    return type_ in ("f32", "f64")


def is_signed(type_: str) -> bool:
    return type_.startswith("s")


def float_text(value: float, type_: str) -> str:
    """A constant as LLVM writes it: the bits of the double."""
    if type_ == "f32":
        value = struct.unpack("<f", struct.pack("<f", value))[0] if abs(value) < 3.5e38 else value
    return f"0x{struct.unpack('<Q', struct.pack('<d', value))[0]:016X}"


def single_text(bits: int) -> str:
    """A float32 of these bits; of a NaN, the payload too."""
    exponent, fraction, sign = bits >> 23 & 0xFF, bits & 0x7FFFFF, bits >> 31
    if exponent == 0xFF:
        return f"0x{sign << 63 | 0x7FF << 52 | fraction << 29:016X}"
    return float_text(struct.unpack("<f", struct.pack("<I", bits))[0], "f32")


@dataclass(slots=True)
class FunctionWriter:
    """Text of one function in the making."""

    module: PtxModule
    function: PtxFunction
    address: dict[str, str]
    """Names of the module's variables to their LLVM names."""
    bound: Callable[[FunctionWriter, str], str | None] = lambda writer, name: None
    """The address of a variable that is not the module's own."""
    lines: list[str] = field(default_factory=list)
    head: list[str] = field(default_factory=list)
    """Of the entry block: memory on the stack."""
    registers: dict[str, str] = field(default_factory=dict)
    families: dict[str, tuple[str, int]] = field(default_factory=dict)
    places: dict[str, str] = field(default_factory=dict)
    """Variables of the function: name to the LLVM value that is their address."""
    line: int = 0
    soft: bool = False
    """Whether the instruction treats denormals as zero, and the processor does not do it."""
    _count: int = 0
    _open: bool = True

    def fail(self, message: str) -> PtxError:
        return PtxError(self.line, f"procedure '{self.function.name}': {message}")

    def new(self) -> str:
        self._count += 1
        return f"%t{self._count}"

    def emit(self, text: str) -> None:
        if not self._open:  # what follows a jump is never reached
            self.block(f"dead{self._count}")
            self._count += 1
        self.lines.append("  " + text)

    def value(self, text: str) -> str:
        """Emit an instruction that gives a value; its name."""
        name = self.new()
        self.emit(f"{name} = {text}")
        return name

    def label(self, name: str) -> str:
        """A name for a block, used once."""
        self._count += 1
        return f"{name}{self._count}"

    def block(self, name: str) -> None:
        """Begin a block; the one before goes on into it."""
        if self._open:
            self.lines.append(f'  br label %"{name}"')
        self.lines.append(f'"{name}":')
        self._open = True

    def jump(self, text: str) -> None:
        """End the block."""
        self.emit(text)
        self._open = False

    def stack(self, type_: str, count: int = 1, align: int = 16) -> str:
        """Memory that lives as long as the call."""
        self._count += 1
        name = f"%s{self._count}"
        shape = type_ if count == 1 else f"[{count} x {type_}]"
        self.head.append(f"  {name} = alloca {shape}, align {align}")
        return name

    # ------------------------------------------------------------------ registers

    def declare(self, variable: PtxVariable) -> None:
        if variable.space == "reg":
            if variable.count is not None:
                self.families[variable.name] = (variable.type, variable.count)
            else:
                self.registers.setdefault(variable.name, "")
                self._make(variable.name, variable.type)
            return
        if variable.name not in self.places:
            self.places[variable.name] = self.stack("i8", max(variable.size, 1))

    def _make(self, name: str, type_: str) -> str:
        known = self.registers.get(name)
        if not known:
            place = f'%"r.{name}"'
            self.head.append(f"  {place} = alloca {llvm(type_)}")
            self.head.append(f"  store {llvm(type_)} zeroinitializer, ptr {place}")
            self.registers[name] = type_
        return self.registers[name]

    def register(self, name: str) -> str | None:
        """The type of a register; None where there is none of that name."""
        found = self.registers.get(name)
        if found:
            return found
        family = name.rstrip("0123456789")
        if family in self.families and family != name:
            type_, count = self.families[family]
            if int(name[len(family) :]) < count:
                return self._make(name, type_)
        return None

    # ------------------------------------------------------------------ operands

    def read(self, operand: str, type_: str) -> str:
        """The value of an operand, of LLVM's type for ``type_``."""
        negated = operand.startswith("!")
        if negated:
            inner = self.read(operand[1:].strip(), "pred")
            return self.value(f"xor i1 {inner}, true")
        held = self.register(operand)
        if held is not None:
            loaded = self.value(f'load {llvm(held)}, ptr %"r.{operand}"')
            fitted = self.fit(loaded, held, type_)
            return self.flushed(fitted) if self.soft and type_ == "f32" else fitted
        return self._constant(operand, type_)

    def _constant(self, operand: str, type_: str) -> str:
        if _SPECIAL.match(operand):
            return "0"
        if operand == "WARP_SZ":
            return "32"
        single, double = _HEX_FLOAT.match(operand), _HEX_DOUBLE.match(operand)
        if single:
            bits = int(single[1], 16)
            if type_ == "f64":
                return float_text(struct.unpack("<f", struct.pack("<I", bits))[0], "f64")
            return single_text(bits) if type_ == "f32" else str(bits)
        if double:
            bits = int(double[1], 16)
            if type_ == "f32":
                value = struct.unpack("<d", struct.pack("<Q", bits))[0]
                return float_text(value, "f32")
            return f"0x{bits:016X}" if type_ == "f64" else str(bits)
        if is_float(type_) and _DECIMAL.match(operand):
            return float_text(float(operand), type_)
        if WHOLE_NUMBER.match(operand):
            number = integer(operand)
            if type_ == "pred":
                return "true" if number else "false"
            if is_float(type_):
                return float_text(float(number), type_)
            return str(_wrapped(number, 8 * SIZES[type_]))
        if _DECIMAL.match(operand):
            return self.fit(float_text(float(operand), "f64"), "f64", type_)
        place = self.place(operand)
        if place is not None:
            pointer = self.value(f"ptrtoint ptr {place} to i64")
            return self.fit(pointer, "u64", type_)
        raise self.fail(f"'{operand}' is not declared")

    def place(self, name: str) -> str | None:
        """The address of a variable, as a pointer."""
        found = self.places.get(name) or self.address.get(name)
        return found if found is not None else self.bound(self, name)

    def fit(self, value: str, held: str, type_: str) -> str:
        """A value of one PTX type as another: bits kept, cut off, or filled up by the sign of
        ``type_`` (9.4.1)."""
        have, want = llvm(held), llvm(type_)
        if have == want:
            return value
        if "pred" in (held, type_):
            raise self.fail("a predicate stands where a number must, or a number for a predicate")
        if is_float(held):
            bits = f"i{8 * SIZES[held]}"
            value, have = self.value(f"bitcast {have} {value} to {bits}"), bits
        goal = f"i{8 * SIZES[type_]}"
        if have != goal:
            smaller = int(have[1:]) > int(goal[1:])
            how = "trunc" if smaller else "sext" if is_signed(type_) else "zext"
            value = self.value(f"{how} {have} {value} to {goal}")
        return self.value(f"bitcast {goal} {value} to {want}") if is_float(type_) else value

    def write(self, operand: str, value: str, type_: str) -> None:
        """Put a value into a register. ``_`` takes any and keeps none."""
        if operand == "_":
            return
        held = self.register(operand)
        if held is None:
            raise self.fail(f"'{operand}' is no register")
        if self.soft and type_ == "f32":
            value = self.flushed(value)
        if held != type_ and llvm(held) != llvm(type_):
            as_sign = "s" if is_signed(type_) else "b"
            wide = held if is_float(held) or held == "pred" else f"{as_sign}{8 * SIZES[held]}"
            value = self.fit(value, type_, wide)
        self.emit(f'store {llvm(held)} {value}, ptr %"r.{operand}"')

    def flushed(self, value: str) -> str:
        """A float32, a denormal as zero of its sign."""
        size = self.value(f"bitcast float {value} to i32")
        exponent = self.value(f"and i32 {size}, {0x7F800000}")
        small = self.value(f"icmp eq i32 {exponent}, 0")
        sign = self.value(f"and i32 {size}, {-0x80000000}")
        kept = self.value(f"select i1 {small}, i32 {sign}, i32 {size}")
        return self.value(f"bitcast i32 {kept} to float")

    def pointer(self, operand: str) -> str:
        """The pointer of ``[base + offset]``."""
        found = _ADDRESS.match(operand)
        if found is None:
            raise self.fail(f"'{operand}' is no address")
        base, offset = found[1], 0
        if found[2]:
            if not WHOLE_NUMBER.match(found[2]):
                raise self.fail(f"'{operand}' is no address")
            offset = integer(found[2])
        place = self.place(base) if self.register(base) is None else None
        if place is None:
            number = self.read(base, "u64")
            place = self.value(f"inttoptr i64 {number} to ptr")
        if offset == 0:
            return place
        return self.value(f"getelementptr i8, ptr {place}, i64 {offset}")

    def vector(self, operand: str) -> list[str]:
        """The parts of ``{a, b}``, or the operand alone."""
        if not operand.startswith("{"):
            return [operand]
        return [part.strip() for part in operand.strip("{}").split(",")]


def integer(text: str) -> int:
    """An integer as PTX writes it (4.5.1)."""
    plain = text.rstrip("U")
    sign = -1 if plain.startswith("-") else 1
    digits = plain.lstrip("-")
    if digits.lower().startswith(("0x", "0b")):
        return sign * int(digits, 0)
    return sign * int(digits, 8 if len(digits) > 1 and digits.startswith("0") else 10)


def _wrapped(number: int, bits: int) -> int:
    """The number modulo 2**bits, as LLVM reads it."""
    return number & ((1 << bits) - 1)


def split(instruction: PtxInstruction) -> tuple[str, list[str]]:
    """The base of an opcode and what follows its dots."""
    base, *rest = instruction.opcode.split(".")
    return base, [part for part in rest if part]

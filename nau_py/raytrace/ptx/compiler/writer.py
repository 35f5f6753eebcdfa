"""Write one function of a module as text of LLVM's language: registers, blocks and operands.

Registers are memory on the stack. LLVM's optimiser turns them into values again. Integers have no
sign, as in LLVM; the type of an instruction defines how a value is read.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field

from nau_py.raytrace.ptx.compiler.literals import (
    WHOLE_NUMBER,
    bits_text,
    float_text,
    integer_text,
    is_float,
    is_signed,
    llvm_type,
    parse_integer,
)
from nau_py.raytrace.ptx.compiler.module import (
    SIZES,
    PtxError,
    PtxFunction,
    PtxInstruction,
    PtxModule,
    PtxVariable,
)

FRAME = "%frame"
"""The hidden first argument of every function: the frame that it runs in (``runtime.layout``)."""
_DECIMAL = re.compile(r"-?(\d+\.\d*|\.\d+|\d+)([eE][+-]?\d+)?$")
_ADDRESS = re.compile(r"\[\s*([^\s+\]]+)\s*(?:\+\s*(-?\w+)\s*)?\]$")
_SPECIAL = re.compile(r"%(n?tid|n?ctaid|laneid|warpid|nwarpid|smid|nsmid|clock|clock64)(\.[xyz])?$")


@dataclass(slots=True)
class FunctionWriter:
    """Text of a function that is being compiled."""

    module: PtxModule
    function: PtxFunction
    address: dict[str, str]
    """LLVM's names of the module's variables and functions."""
    bound: Callable[[FunctionWriter, str], str | None] = lambda writer, name: None
    """Return the address of a variable that the device interface binds, or None."""
    lines: list[str] = field(default_factory=list)
    head: list[str] = field(default_factory=list)
    """Lines of the entry block: memory on the stack."""
    registers: dict[str, str] = field(default_factory=dict)
    families: dict[str, tuple[str, int]] = field(default_factory=dict)
    places: dict[str, str] = field(default_factory=dict)
    """LLVM's values of the addresses of the function's variables, by name."""
    line: int = 0
    soft: bool = False
    """True where the instruction flushes denormals and the processor's mode does not."""
    _count: int = 0
    _open: bool = True

    def fail(self, message: str) -> PtxError:
        """Return an error at the current line."""
        return PtxError(self.line, f"procedure '{self.function.name}': {message}")

    def emit(self, text: str) -> None:
        """Append an instruction to the open block."""
        if not self._open:  # code behind a jump is never reached
            self.block(f"dead{self._count}")
            self._count += 1
        self.lines.append("  " + text)

    def value(self, text: str) -> str:
        """Emit an instruction and return the name of its value."""
        self._count += 1
        name = f"%t{self._count}"
        self.emit(f"{name} = {text}")
        return name

    def label(self, name: str) -> str:
        """Return a unique name for a block."""
        self._count += 1
        return f"{name}{self._count}"

    def block(self, name: str) -> None:
        """Begin a block. The block before continues into it."""
        if self._open:
            self.lines.append(f'  br label %"{name}"')
        self.lines.append(f'"{name}":')
        self._open = True

    def jump(self, text: str) -> None:
        """End the block with a jump or return."""
        self.emit(text)
        self._open = False

    def stack(self, type_: str, count: int = 1, align: int = 16) -> str:
        """Reserve memory for the duration of the call and return its pointer."""
        self._count += 1
        name = f"%s{self._count}"
        shape = type_ if count == 1 else f"[{count} x {type_}]"
        self.head.append(f"  {name} = alloca {shape}, align {align}")
        return name

    # ------------------------------------------------------------------ registers

    def declare(self, variable: PtxVariable) -> None:
        """Reserve memory for a variable or register of the function."""
        if variable.space == "reg":
            if variable.count is not None:
                self.families[variable.name] = (variable.type, variable.count)
            else:
                self.registers.setdefault(variable.name, "")
                self._make_register(variable.name, variable.type)
            return
        if variable.name not in self.places:
            self.places[variable.name] = self.stack("i8", max(variable.size, 1))

    def _make_register(self, name: str, type_: str) -> str:
        known = self.registers.get(name)
        if not known:
            place = f'%"r.{name}"'
            self.head.append(f"  {place} = alloca {llvm_type(type_)}")
            self.head.append(f"  store {llvm_type(type_)} zeroinitializer, ptr {place}")
            self.registers[name] = type_
        return self.registers[name]

    def register(self, name: str) -> str | None:
        """Return the type of a register; None where no register has that name."""
        found = self.registers.get(name)
        if found:
            return found
        family = name.rstrip("0123456789")
        if family in self.families and family != name:
            type_, count = self.families[family]
            if int(name[len(family) :]) < count:
                return self._make_register(name, type_)
        return None

    # ------------------------------------------------------------------ operands

    def read(self, operand: str, type_: str) -> str:
        """Return the value of an operand, of LLVM's type for ``type_``."""
        negated = operand.startswith("!")
        if negated:
            inner = self.read(operand[1:].strip(), "pred")
            return self.value(f"xor i1 {inner}, true")
        held = self.register(operand)
        if held is not None:
            loaded = self.value(f'load {llvm_type(held)}, ptr %"r.{operand}"')
            fitted = self.fit(loaded, held, type_)
            return self.flush(fitted) if self.soft and type_ == "f32" else fitted
        return self._constant(operand, type_)

    def _constant(self, operand: str, type_: str) -> str:
        if _SPECIAL.match(operand):
            return "0"
        if operand == "WARP_SZ":
            return "32"
        literal = bits_text(operand, type_)
        if literal is not None:
            return literal
        if is_float(type_) and _DECIMAL.match(operand):
            return float_text(float(operand), type_)
        if WHOLE_NUMBER.match(operand):
            return integer_text(operand, type_)
        if _DECIMAL.match(operand):
            return self.fit(float_text(float(operand), "f64"), "f64", type_)
        place = self.place(operand)
        if place is not None:
            pointer = self.value(f"ptrtoint ptr {place} to i64")
            return self.fit(pointer, "u64", type_)
        raise self.fail(f"'{operand}' is not declared")

    def place(self, name: str) -> str | None:
        """Return the address of a variable as a pointer; None for an unknown name."""
        found = self.places.get(name) or self.address.get(name)
        return found if found is not None else self.bound(self, name)

    def fit(self, value: str, held: str, type_: str) -> str:
        """Convert a value between PTX types without a conversion of numbers (9.4.1).

        Bits are kept, cut off, or extended by the sign of ``type_``.
        """
        have, want = llvm_type(held), llvm_type(type_)
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
        """Store a value in a register. The register ``_`` discards it."""
        if operand == "_":
            return
        held = self.register(operand)
        if held is None:
            raise self.fail(f"'{operand}' is no register")
        if self.soft and type_ == "f32":
            value = self.flush(value)
        if held != type_ and llvm_type(held) != llvm_type(type_):
            as_sign = "s" if is_signed(type_) else "b"
            wide = held if is_float(held) or held == "pred" else f"{as_sign}{8 * SIZES[held]}"
            value = self.fit(value, type_, wide)
        self.emit(f'store {llvm_type(held)} {value}, ptr %"r.{operand}"')

    def flush(self, value: str) -> str:
        """Replace a denormal float32 by the zero of its sign."""
        size = self.value(f"bitcast float {value} to i32")
        exponent = self.value(f"and i32 {size}, {0x7F800000}")
        small = self.value(f"icmp eq i32 {exponent}, 0")
        sign = self.value(f"and i32 {size}, {-0x80000000}")
        kept = self.value(f"select i1 {small}, i32 {sign}, i32 {size}")
        return self.value(f"bitcast i32 {kept} to float")

    def pointer(self, operand: str) -> str:
        """Return the pointer of ``[base + offset]``."""
        found = _ADDRESS.match(operand)
        if found is None:
            raise self.fail(f"'{operand}' is no address")
        base, offset = found[1], 0
        if found[2]:
            if not WHOLE_NUMBER.match(found[2]):
                raise self.fail(f"'{operand}' is no address")
            offset = parse_integer(found[2])
        place = self.place(base) if self.register(base) is None else None
        if place is None:
            number = self.read(base, "u64")
            place = self.value(f"inttoptr i64 {number} to ptr")
        if offset == 0:
            return place
        return self.value(f"getelementptr i8, ptr {place}, i64 {offset}")

    def vector(self, operand: str) -> list[str]:
        """Return the parts of ``{a, b}``, or the operand alone."""
        if not operand.startswith("{"):
            return [operand]
        return [part.strip() for part in operand.strip("{}").split(",")]


def split_opcode(instruction: PtxInstruction) -> tuple[str, list[str]]:
    """Split an opcode into its base and the words behind its dots."""
    base, *rest = instruction.opcode.split(".")
    return base, [part for part in rest if part]

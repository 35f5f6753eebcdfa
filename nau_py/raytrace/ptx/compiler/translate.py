"""Translate the functions of a PTX module to text of LLVM's language."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from nau_py.raytrace.ptx.compiler.arithmetic import ARITHMETIC
from nau_py.raytrace.ptx.compiler.bits import BITS
from nau_py.raytrace.ptx.compiler.data import global_text
from nau_py.raytrace.ptx.compiler.frame_access import unwind
from nau_py.raytrace.ptx.compiler.handler import Handler
from nau_py.raytrace.ptx.compiler.integer import INTEGER
from nau_py.raytrace.ptx.compiler.logic import LOGIC
from nau_py.raytrace.ptx.compiler.memory import MEMORY
from nau_py.raytrace.ptx.compiler.module import FLUSHED, PtxError, PtxInstruction, PtxModule
from nau_py.raytrace.ptx.compiler.reader import split_call
from nau_py.raytrace.ptx.compiler.writer import FRAME, FunctionWriter, split_opcode

HANDLERS: dict[str, Handler] = ARITHMETIC | LOGIC | BITS | INTEGER | MEMORY
CALLABLE = ("__direct_callable__", "__continuation_callable__")
"""Prefixes of the names of callable programs."""
_OVERFLOWS = "".join(
    f"declare {{{t}, i1}} @llvm.u{how}.with.overflow.{t}({t}, {t})\n"
    for t in ("i16", "i32", "i64")
    for how in ("add", "sub")
)
_RUNTIME = """
declare void @nau.trace(ptr, i64, float, float, float, float, float, float, float, float, float,
                        i32, i32, i32, i32, i32, ptr)
declare void @nau.texture(i64, i32, float, float, float, ptr)
declare i32 @nau.attribute(ptr, i32)
declare i32 @nau.potential(ptr, float)
declare i32 @nau.report(ptr)
declare i32 @nau.report7(ptr, float, i32, ptr, i64)
declare i64 @nau.element(ptr, i64, i32, i64, i64, i64)
declare i64 @nau.callable(ptr, i32)
declare void @nau.vertices(ptr, i32, i32, ptr)
declare void @nau.print_start(ptr, i64)
declare void @nau.print_write(ptr, i32, i32)
declare void @nau.printf(ptr, i64, i64)
"""


@dataclass(frozen=True, slots=True)
class CallHandler:
    """A device interface. ``handles(name)`` tells whether it has a function of that name,
    ``write(writer, name, returns, takes)`` writes a call of it."""

    handles: Callable[[str], bool]
    write: Callable[[FunctionWriter, str, list[str], list[str]], None]


def translate_module(
    module: PtxModule,
    bound: set[str],
    bound_pointer: Callable[[FunctionWriter, str], str | None],
    interfaces: Sequence[CallHandler],
) -> tuple[str, list[PtxError]]:
    """Return the text of all functions that can be translated, and the errors of the others.

    ``bound``: variables that the device interface stores, not the module; ``bound_pointer``
    returns the address of one of them.
    """
    errors: list[PtxError] = []
    address = {f.name: f'@"{f.name}"' for f in module.functions.values() if f.body is not None}
    own = {v.name: v for v in module.variables if v.name not in bound}
    address |= {name: f'@"{name}"' for name in own}
    parts = [_RUNTIME]
    for variable in own.values():
        try:
            parts.append(global_text(variable, address))
        except PtxError as error:
            errors.append(error)
    for function in module.functions.values():
        if function.body is None:
            continue
        w = FunctionWriter(module, function, address, bound_pointer)
        try:
            parts.append(_FunctionTranslator(w, interfaces).translate())
        except PtxError as error:
            errors.append(error)
    return "\n".join(parts) + "\n" + _OVERFLOWS, errors


class _FunctionTranslator:
    """Translates the instructions of one function."""

    def __init__(self, writer: FunctionWriter, interfaces: Sequence[CallHandler]) -> None:
        self.w = writer
        self.interfaces = interfaces
        self.body = writer.function.body or []
        self.labels = {i.label for i in self.body if i.label}

    def translate(self) -> str:
        """Return the text of the function. Raises :class:`PtxError`."""
        w, function = self.w, self.w.function
        w.line = function.line
        takes = [f"ptr {FRAME}"]
        for number, variable in enumerate([*function.returns, *function.takes]):
            takes.append(f"ptr %p{number}")
            w.places[variable.name] = f"%p{number}"
        w.head.append("  %carry = alloca i1")
        w.head.append("  store i1 false, ptr %carry")
        for variable in function.variables:
            w.declare(variable)
        for variable in [*function.returns, *function.takes]:
            if variable.space == "reg":
                raise w.fail(
                    f"parameter '{variable.name}' in a register is not supported, .param is"
                )
        for instruction in self.body:
            w.line = instruction.line
            if instruction.label:
                w.block(f"L.{instruction.label}")
            else:
                self._translate_guarded(instruction)
        w.emit("ret void")
        by_name = function.entry or function.visible or function.name.startswith(CALLABLE)
        linkage = "" if by_name else "internal "
        head = f'define {linkage}void @"{function.name}"({", ".join(takes)}) nounwind {{'
        entry = ['"entry":', *w.head, '  br label %"begin"', '"begin":']
        return "\n".join([head, *entry, *w.lines, "}"])

    def _translate_guarded(self, instruction: PtxInstruction) -> None:
        w = self.w
        base, words = split_opcode(instruction)
        if not instruction.guard:
            self._translate_plain(base, words, instruction)
            return
        guard = instruction.guard.removeprefix("!")
        truth = w.read(guard, "pred")
        if instruction.guard.startswith("!"):
            truth = w.value(f"xor i1 {truth}, true")
        yes, no = f"yes{len(w.lines)}", f"no{len(w.lines)}"
        if base == "bra":
            goal = f"L.{self._target_label(instruction)}"
            w.jump(f'br i1 {truth}, label %"{goal}", label %"{no}"')
            w.block(no)
            return
        w.jump(f'br i1 {truth}, label %"{yes}", label %"{no}"')
        w.block(yes)
        self._translate_plain(base, words, instruction)
        w.block(no)

    def _target_label(self, instruction: PtxInstruction) -> str:
        name = instruction.operands[0] if instruction.operands else ""
        if name not in self.labels:
            raise self.w.fail(f"there is no label '{name}'")
        return name

    def _translate_plain(self, base: str, words: list[str], instruction: PtxInstruction) -> None:
        """Translate an instruction without its guard."""
        w, operands = self.w, instruction.operands
        if base == "bra":
            w.jump(f'br label %"L.{self._target_label(instruction)}"')
        elif base == "brx":
            self._translate_switch(operands)
        elif base in ("ret", "exit", "trap"):
            w.jump("ret void")
        elif base == "call" or base in HANDLERS:
            w.soft = "ftz" in words and not (base in FLUSHED and w.module.flushes)
            try:
                if base == "call":
                    self._translate_call(operands)
                else:
                    HANDLERS[base](w, words, operands)
            except IndexError:
                raise w.fail(f"'{instruction.opcode}' has too few operands") from None
            w.soft = False
        else:
            raise w.fail(f"instruction '{instruction.opcode}' is not supported")

    def _translate_switch(self, operands: tuple[str, ...]) -> None:
        """Translate ``brx.idx index, list``: jump to one of the labels of a list."""
        w = self.w
        name = operands[1] if len(operands) > 1 else ""
        targets = w.function.tables.get(name)
        if not targets or not set(targets) <= self.labels:
            raise w.fail(f"there is no list of labels '{name}'")
        index = w.read(operands[0], "u32")
        cases = " ".join(f'i32 {i}, label %"L.{t}"' for i, t in enumerate(targets))
        w.jump(f'switch i32 {index}, label %"L.{targets[0]}" [{cases}]')

    def _translate_call(self, operands: tuple[str, ...]) -> None:
        """Translate a call of a device interface, of a function of the module or by address."""
        w = self.w
        returns, name, takes = split_call(operands)
        if not name:
            raise w.fail("a call names no procedure")
        for interface in self.interfaces:
            if interface.handles(name):
                interface.write(w, name, returns, takes)
                return
        target = w.module.functions.get(name)
        if w.register(name) is not None:  # the address of a callable program
            pointer = w.value(f"inttoptr i64 {w.read(name, 'u64')} to ptr")
            self._write_call(pointer, name, [*returns, *takes])
        elif target is None:
            if name.startswith("_"):
                raise w.fail(f"'{name}' is not supported")
            raise w.fail(f"there is no procedure '{name}'")
        elif target.body is None:
            if name != "vprintf":
                raise w.fail(f"procedure '{name}' is declared, but is not there")
            places = (self._parameter(takes[0], name), self._parameter(takes[1], name))
            loaded = [w.value(f"load i64, ptr {p}, align 1") for p in places]
            w.emit(f"call void @nau.printf(ptr {FRAME}, i64 {loaded[0]}, i64 {loaded[1]})")
        elif len(returns) + len(takes) != len(target.returns) + len(target.takes):
            raise w.fail(f"'{name}' takes another number of arguments")
        else:
            self._write_call(f'@"{name}"', name, [*returns, *takes])

    def _write_call(self, pointer: str, name: str, operands: list[str]) -> None:
        """Write a call with the addresses of results and arguments."""
        listed = (f"ptr {self._parameter(operand, name)}" for operand in operands)
        self.w.emit(f"call void {pointer}({', '.join([f'ptr {FRAME}', *listed])})")
        unwind(self.w)

    def _parameter(self, operand: str, name: str) -> str:
        found = self.w.place(operand)
        if found is None:
            raise self.w.fail(f"argument '{operand}' of '{name}' is no parameter")
        return found

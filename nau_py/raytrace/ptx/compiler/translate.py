"""A module as text of LLVM's language, function by function."""

from __future__ import annotations

from functools import partial

from nau_py.raytrace.ptx.compiler.arithmetic import ARITHMETIC
from nau_py.raytrace.ptx.compiler.bits import BITS
from nau_py.raytrace.ptx.compiler.data import global_text
from nau_py.raytrace.ptx.compiler.handler import Handler
from nau_py.raytrace.ptx.compiler.integer import INTEGER
from nau_py.raytrace.ptx.compiler.logic import LOGIC
from nau_py.raytrace.ptx.compiler.memory import MEMORY
from nau_py.raytrace.ptx.compiler.module import (
    FLUSHED,
    PtxError,
    PtxFunction,
    PtxInstruction,
    PtxModule,
    PtxVariable,
)
from nau_py.raytrace.ptx.compiler.reader import split_call
from nau_py.raytrace.ptx.compiler.writer import FRAME, FunctionWriter, split_opcode
from nau_py.raytrace.ptx.optix import optix6, optix7
from nau_py.raytrace.ptx.runtime.layout import unwind

HANDLERS: dict[str, Handler] = ARITHMETIC | LOGIC | BITS | INTEGER | MEMORY
PARAMETERS = "optixLaunchParams"
"""The variable that a launch fills."""
CALLABLE = ("__direct_callable__", "__continuation_callable__")
"""How names of callable programs begin."""
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


def compile_module(module: PtxModule) -> str:
    """LLVM's text. Raises :class:`PtxError` with the line of what is not supported."""
    found, errors = compile_all(module)
    if errors:
        raise errors[0]
    return found


def compile_all(
    module: PtxModule, layout: optix6.RecordLayout | None = None
) -> tuple[str, list[PtxError]]:
    """LLVM's text of every function that can be compiled, and what is wrong with the others.
    ``layout``: where variables of OptiX 6 lie; of this module alone where none is given."""
    errors: list[PtxError] = []
    try:
        if layout is None:
            layout = optix6.RecordLayout()
            layout.add(module)
        places = layout.bindings(module)
    except PtxError as error:
        return "", [error]
    address = {f.name: f'@"{f.name}"' for f in module.functions.values() if f.body is not None}
    own = {v.name: v for v in module.variables if v.name not in places}
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
        try:
            parts.append(_function(module, function, address, places))
        except PtxError as error:
            errors.append(error)
    return "\n".join(parts) + "\n" + _OVERFLOWS, errors


def _bound(places: dict[str, tuple[str, int]], w: FunctionWriter, name: str) -> str | None:
    return optix6.bound(w, *places[name]) if name in places else None


def _function(
    module: PtxModule,
    function: PtxFunction,
    address: dict[str, str],
    places: dict[str, tuple[str, int]],
) -> str:
    w = FunctionWriter(module, function, address, partial(_bound, places))
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
            _by_register(w, variable)
    body = function.body or []
    labels = {i.label for i in body if i.label}
    for instruction in body:
        w.line = instruction.line
        if instruction.label:
            w.block(f"L.{instruction.label}")
        else:
            _guarded(w, instruction, labels)
    w.emit("ret void")
    by_name = function.entry or function.visible or function.name.startswith(CALLABLE)
    linkage = "" if by_name else "internal "
    head = f'define {linkage}void @"{function.name}"({", ".join(takes)}) nounwind {{'
    entry = ['"entry":', *w.head, '  br label %"begin"', '"begin":']
    return "\n".join([head, *entry, *w.lines, "}"])


def _by_register(w: FunctionWriter, variable: PtxVariable) -> None:
    raise w.fail(f"parameter '{variable.name}' in a register is not supported, .param is")


def _guarded(w: FunctionWriter, instruction: PtxInstruction, labels: set[str]) -> None:
    base, words = split_opcode(instruction)
    if not instruction.guard:
        _plain(w, base, words, instruction, labels)
        return
    guard = instruction.guard.removeprefix("!")
    truth = w.read(guard, "pred")
    if instruction.guard.startswith("!"):
        truth = w.value(f"xor i1 {truth}, true")
    yes, no = f"yes{len(w.lines)}", f"no{len(w.lines)}"
    if base == "bra":
        goal = f"L.{_label(w, instruction, labels)}"
        w.jump(f'br i1 {truth}, label %"{goal}", label %"{no}"')
        w.block(no)
        return
    w.jump(f'br i1 {truth}, label %"{yes}", label %"{no}"')
    w.block(yes)
    _plain(w, base, words, instruction, labels)
    w.block(no)


def _label(w: FunctionWriter, instruction: PtxInstruction, labels: set[str]) -> str:
    name = instruction.operands[0] if instruction.operands else ""
    if name not in labels:
        raise w.fail(f"there is no label '{name}'")
    return name


def _plain(
    w: FunctionWriter, base: str, words: list[str], instruction: PtxInstruction, labels: set[str]
) -> None:
    operands = instruction.operands
    if base == "bra":
        w.jump(f'br label %"L.{_label(w, instruction, labels)}"')
    elif base == "brx":
        _choose(w, operands, labels)
    elif base in ("ret", "exit") or base == "trap":
        w.jump("ret void")
    elif base == "call" or base in HANDLERS:
        w.soft = "ftz" in words and not (base in FLUSHED and w.module.flushes)
        try:
            _call(w, operands) if base == "call" else HANDLERS[base](w, words, operands)
        except IndexError:
            raise w.fail(f"'{instruction.opcode}' has too few operands") from None
        w.soft = False
    else:
        raise w.fail(f"instruction '{instruction.opcode}' is not supported")


def _choose(w: FunctionWriter, operands: tuple[str, ...], labels: set[str]) -> None:
    """``brx.idx index, list``: to one of the labels of a list."""
    name = operands[1] if len(operands) > 1 else ""
    targets = w.function.tables.get(name)
    if not targets or not set(targets) <= labels:
        raise w.fail(f"there is no list of labels '{name}'")
    index = w.read(operands[0], "u32")
    cases = " ".join(f'i32 {i}, label %"L.{t}"' for i, t in enumerate(targets))
    w.jump(f'switch i32 {index}, label %"L.{targets[0]}" [{cases}]')


def _call(w: FunctionWriter, operands: tuple[str, ...]) -> None:
    returns, name, takes = split_call(operands)
    if not name:
        raise w.fail("a call names no procedure")
    for interface in (optix7, optix6):
        if interface.known(name):
            interface.call(w, name, returns, takes)
            return
    target = w.module.functions.get(name)
    if w.register(name) is not None:  # by its address: a callable program
        pointer = w.value(f"inttoptr i64 {w.read(name, 'u64')} to ptr")
        _enter(w, pointer, name, [*returns, *takes])
    elif target is None:
        if name.startswith("_"):
            raise w.fail(f"'{name}' is not supported")
        raise w.fail(f"there is no procedure '{name}'")
    elif target.body is None:
        if name != "vprintf":
            raise w.fail(f"procedure '{name}' is declared, but is not there")
        places = (_parameter(w, takes[0], name), _parameter(w, takes[1], name))
        loaded = [w.value(f"load i64, ptr {p}, align 1") for p in places]
        w.emit(f"call void @nau.printf(ptr {FRAME}, i64 {loaded[0]}, i64 {loaded[1]})")
    elif len(returns) + len(takes) != len(target.returns) + len(target.takes):
        raise w.fail(f"'{name}' takes another number of arguments")
    else:
        _enter(w, f'@"{name}"', name, [*returns, *takes])


def _enter(w: FunctionWriter, pointer: str, name: str, operands: list[str]) -> None:
    """A call with the addresses of results and arguments."""
    arguments = [f"ptr {FRAME}", *(f"ptr {_parameter(w, o, name)}" for o in operands)]
    w.emit(f"call void {pointer}({', '.join(arguments)})")
    unwind(w)


def _parameter(w: FunctionWriter, operand: str, name: str) -> str:
    found = w.place(operand)
    if found is None:
        raise w.fail(f"argument '{operand}' of '{name}' is no parameter")
    return found

"""A module as text of LLVM's language, function by function."""

from __future__ import annotations

import re

from nau_py.raytrace.ptx import optix7
from nau_py.raytrace.ptx.arithmetic import ARITHMETIC, Handler
from nau_py.raytrace.ptx.bits import BITS
from nau_py.raytrace.ptx.function import FRAME, Writer, integer, split
from nau_py.raytrace.ptx.memory import MEMORY
from nau_py.raytrace.ptx.reader import SIZES, Function, Instruction, Module, PtxError, Variable

HANDLERS: dict[str, Handler] = ARITHMETIC | BITS | MEMORY
PARAMETERS = "optixLaunchParams"
"""The variable that a launch fills."""
_OVERFLOWS = "".join(
    f"declare {{{t}, i1}} @llvm.u{how}.with.overflow.{t}({t}, {t})\n"
    for t in ("i16", "i32", "i64")
    for how in ("add", "sub")
)


def compile_module(module: Module) -> str:
    """LLVM's text. Raises :class:`PtxError` with the line of what is not supported."""
    found, errors = compile_all(module)
    if errors:
        raise errors[0]
    return found


def compile_all(module: Module) -> tuple[str, list[PtxError]]:
    """LLVM's text of every function that can be compiled, and what is wrong with the others."""
    address = {v.name: f'@"{v.name}"' for v in module.variables}
    errors: list[PtxError] = []
    parts: list[str] = []
    for variable in {v.name: v for v in module.variables}.values():
        try:
            parts.append(_global(variable))
        except PtxError as error:
            errors.append(error)
    parts.append("declare void @nau.trace(ptr, i64, float, float, float, float, float, float, "
                 "float, float, float, i32, i32, i32, i32, i32, ptr)")  # fmt: skip
    parts.append("declare void @nau.texture(i64, i32, float, float, float, ptr)")
    for function in module.functions.values():
        if function.body is None:
            continue
        try:
            parts.append(_function(module, function, address))
        except PtxError as error:
            errors.append(error)
    return "\n".join(parts) + "\n" + _OVERFLOWS, errors


def _global(variable: Variable) -> str:
    """Memory of a variable outside of functions."""
    size = max(variable.size, 1)
    name = f'@"{variable.name}"'
    data = _initial(variable)
    text = "zeroinitializer"
    if data is not None:
        filled = (data + bytes(size))[:size]
        text = "[" + ", ".join(f"i8 {byte}" for byte in filled) + "]"
    return f"{name} = global [{size} x i8] {text}, align {max(variable.align, 16)}"


def _initial(variable: Variable) -> bytes | None:
    if not variable.value:
        return None
    try:
        return _bytes(variable)
    except ValueError:
        said = f"'{variable.name}' has a value that is no number"
        raise PtxError(variable.line, said) from None


def _bytes(variable: Variable) -> bytes:
    width = SIZES[variable.type]
    words = re.findall(r"-?0[xX][0-9a-fA-F]+|-?0[fFdD][0-9a-fA-F]+|-?\d+", variable.value)
    data = b""
    for word in words:
        if re.match(r"0[fFdD]", word):
            data += int(word[2:], 16).to_bytes(width, "little")
        else:
            data += (integer(word) % (1 << 8 * width)).to_bytes(width, "little")
    return data


def _function(module: Module, function: Function, address: dict[str, str]) -> str:
    w = Writer(module, function, address)
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
    linkage = "" if function.entry else "internal "
    head = f'define {linkage}void @"{function.name}"({", ".join(takes)}) nounwind {{'
    entry = ['"entry":', *w.head, '  br label %"begin"', '"begin":']
    return "\n".join([head, *entry, *w.lines, "}"])


def _by_register(w: Writer, variable: Variable) -> None:
    raise w.fail(f"parameter '{variable.name}' in a register is not supported, .param is")


def _guarded(w: Writer, instruction: Instruction, labels: set[str]) -> None:
    base, words = split(instruction)
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


def _label(w: Writer, instruction: Instruction, labels: set[str]) -> str:
    name = instruction.operands[0] if instruction.operands else ""
    if name not in labels:
        raise w.fail(f"there is no label '{name}'")
    return name


def _plain(
    w: Writer, base: str, words: list[str], instruction: Instruction, labels: set[str]
) -> None:
    operands = instruction.operands
    if base == "bra":
        w.jump(f'br label %"L.{_label(w, instruction, labels)}"')
    elif base in ("ret", "exit") or base == "trap":
        w.jump("ret void")
    elif base == "call" or base in HANDLERS:
        try:
            _call(w, operands) if base == "call" else HANDLERS[base](w, words, operands)
        except IndexError:
            raise w.fail(f"'{instruction.opcode}' has too few operands") from None
    else:
        raise w.fail(f"instruction '{instruction.opcode}' is not supported")


def _call(w: Writer, operands: tuple[str, ...]) -> None:
    """``call (returns), name, (arguments)``: each list may be missing."""
    parts = list(operands)
    returns = _listed(parts.pop(0)) if parts and parts[0].startswith("(") else []
    if not parts:
        raise w.fail("a call names no procedure")
    name = parts.pop(0)
    takes = _listed(parts.pop(0)) if parts and parts[0].startswith("(") else []
    if name.startswith("_"):
        if not optix7.known(name) and name not in w.module.functions:
            raise w.fail(f"'{name}' is not supported")
        if optix7.known(name):
            optix7.call(w, name, returns, takes)
            return
    target = w.module.functions.get(name)
    if target is None:
        raise w.fail(f"there is no procedure '{name}'")
    if target.body is None:
        if name != "vprintf":
            raise w.fail(f"procedure '{name}' is declared, but is not there")
        return  # what programs print for people is left out
    arguments = [f"ptr {FRAME}"]
    for operand in [*returns, *takes]:
        found = w.place(operand)
        if found is None:
            raise w.fail(f"argument '{operand}' of '{name}' is no parameter")
        arguments.append(f"ptr {found}")
    if len(arguments) != 1 + len(target.returns) + len(target.takes):
        raise w.fail(f"'{name}' takes another number of arguments")
    w.emit(f'call void @"{name}"({", ".join(arguments)})')


def _listed(text: str) -> list[str]:
    return [part.strip() for part in text.strip("()").split(",") if part.strip()]

"""Loads, stores and textures (PTX ISA, 9.7.9.8 to 9.7.10). All memory spaces are one."""

from __future__ import annotations

from nau_py.raytrace.ptx.compiler.handler import Handler, type_in
from nau_py.raytrace.ptx.compiler.literals import llvm_type
from nau_py.raytrace.ptx.compiler.module import SIZES
from nau_py.raytrace.ptx.compiler.writer import FunctionWriter

_TEXTURES = {"1d": 1, "2d": 2, "3d": 3}


def write_ld(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    type_ = type_in(w, words)
    pointer = w.pointer(operands[1])
    for index, target in enumerate(w.vector(operands[0])):
        place = pointer
        if index:
            place = w.value(f"getelementptr i8, ptr {pointer}, i64 {index * SIZES[type_]}")
        volatile = "volatile " if "volatile" in words else ""
        value = w.value(f"load {volatile}{llvm_type(type_)}, ptr {place}, align 1")
        w.write(target, value, type_)


def write_st(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    type_ = type_in(w, words)
    pointer = w.pointer(operands[0])
    values = [w.read(part, type_) for part in w.vector(operands[1])]
    for index, value in enumerate(values):
        place = pointer
        if index:
            place = w.value(f"getelementptr i8, ptr {pointer}, i64 {index * SIZES[type_]}")
        volatile = "volatile " if "volatile" in words else ""
        w.emit(f"store {volatile}{llvm_type(type_)} {value}, ptr {place}, align 1")


def write_tex(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """Sample a texture: ``tex.2d.v4.f32.f32 {r,g,b,a}, [handle, {x, y}]``.

    Textures have one level, so a level or gradients change nothing.
    """
    if words[0] in ("base", "level", "grad"):
        words = words[1:]
    kind, coordinates = words[0], words[-1]
    if kind not in _TEXTURES or words[1:-1] != ["v4", "f32"] or coordinates not in ("f32", "s32"):
        raise w.fail("textures are read in 1, 2 or 3 dimensions, four floats by floats or integers")
    inside = operands[1].strip("[]")
    handle, _, place = (part.strip() for part in inside.partition(","))
    at = [w.read(p.strip(), coordinates) for p in place.strip("{}").split(",")]
    if coordinates == "s32":
        at = [w.value(f"sitofp i32 {value} to float") for value in at]
    at = [*at[: _TEXTURES[kind]], "0.0", "0.0"][:3]
    held = w.place(handle) if w.register(handle) is None else None  # a variable of OptiX 6
    number = w.read(handle, "u64") if held is None else w.value(f"load i64, ptr {held}")
    out = w.stack("float", 4)
    listed = ", ".join(f"float {value}" for value in at)
    w.emit(f"call void @nau.texture(i64 {number}, i32 {_TEXTURES[kind]}, {listed}, ptr {out})")
    for index, target in enumerate(w.vector(operands[0])):
        element = w.value(f"getelementptr float, ptr {out}, i64 {index}")
        w.write(target, w.value(f"load float, ptr {element}"), "f32")


def skip_instruction(w: FunctionWriter, words: list[str], operands: tuple[str, ...]) -> None:
    """Skip a hint or barrier: one thread runs one launch index."""


MEMORY: dict[str, Handler] = {
    "ld": write_ld,
    "ldu": write_ld,
    "st": write_st,
    "tex": write_tex,
    "prefetch": skip_instruction,
    "prefetchu": skip_instruction,
    "membar": skip_instruction,
    "fence": skip_instruction,
    "bar": skip_instruction,
    "barrier": skip_instruction,
}

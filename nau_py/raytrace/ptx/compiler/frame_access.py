"""Write accesses to the frame and the launch, and ends of a program, as LLVM's text."""

from __future__ import annotations

from nau_py.raytrace.ptx.compiler.literals import llvm_type
from nau_py.raytrace.ptx.compiler.writer import FRAME, FunctionWriter
from nau_py.raytrace.ptx.runtime.layout import FRAME_FIELDS, LAUNCH_FIELDS, TRACE_ARGUMENTS


def offset_pointer(w: FunctionWriter, base: str, offset: int) -> str:
    """Return the pointer ``offset`` bytes behind another."""
    return w.value(f"getelementptr i8, ptr {base}, i64 {offset}")


def read_frame(w: FunctionWriter, name: str) -> tuple[str, str]:
    """Read a field of the frame. Returns the value and its PTX type."""
    offset, type_ = FRAME_FIELDS[name]
    return w.value(f"load {llvm_type(type_)}, ptr {offset_pointer(w, FRAME, offset)}"), type_


def read_pointer(w: FunctionWriter, name: str) -> str:
    """Read an address in the frame as a pointer."""
    return w.value(f"inttoptr i64 {read_frame(w, name)[0]} to ptr")


def read_launch(w: FunctionWriter, name: str) -> tuple[str, str]:
    """Read a field of the launch. Returns the value and its PTX type."""
    offset, type_ = LAUNCH_FIELDS[name]
    return w.value(
        f"load {llvm_type(type_)}, ptr {offset_pointer(w, read_pointer(w, 'launch'), offset)}"
    ), type_


def unwind(w: FunctionWriter) -> None:
    """Return from the function if the function that it called threw an exception."""
    thrown, _ = read_launch(w, "thrown")
    out, on = w.label("thrown"), w.label("kept")
    test = w.value(f"icmp ne i32 {thrown}, 0")
    w.jump(f'br i1 {test}, label %"{out}", label %"{on}"')
    w.block(out)
    w.jump("ret void")
    w.block(on)


def end_any_hit(w: FunctionWriter, bit: int) -> None:
    """End an any-hit program and set a bit of ``status``: IGNORE or TERMINATE."""
    status, _ = read_frame(w, "status")
    value = w.value(f"or i32 {status}, {bit}")
    w.emit(f"store i32 {value}, ptr {offset_pointer(w, FRAME, FRAME_FIELDS['status'][0])}")
    w.jump("ret void")


def throw_exception(w: FunctionWriter, code: str, details: list[str]) -> None:
    """Throw an exception: the launch index ends with the exception program.

    ``code``, ``details``: LLVM values of 32 bits.
    """
    launch = read_pointer(w, "launch")
    for name, value in [("code", code), *((f"detail_{i}", d) for i, d in enumerate(details))]:
        w.emit(f"store i32 {value}, ptr {offset_pointer(w, launch, LAUNCH_FIELDS[name][0])}")
    w.emit(f"store i32 1, ptr {offset_pointer(w, launch, LAUNCH_FIELDS['thrown'][0])}")
    w.jump("ret void")


def trace_ray(w: FunctionWriter, values: dict[str, str], payload: str) -> None:
    """Trace a ray. ``values``: LLVM values by the names of :data:`TRACE_ARGUMENTS`."""
    listed = ", ".join(
        f"{llvm_type(type_)} {values[name]}" for name, type_ in TRACE_ARGUMENTS.items()
    )
    w.emit(f"call void @nau.trace(ptr {FRAME}, {listed}, ptr {payload})")
    unwind(w)

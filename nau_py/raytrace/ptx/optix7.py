"""The calls of OptiX 7's device interface, and the frame that they read (OptiX 7 headers).

A *frame* is what one program runs with: the launch, the ray, the hit, the payload. It lies on the
stack of whoever calls the program; places are offsets in bytes.
"""

from __future__ import annotations

import re

from nau_py.raytrace.ptx.function import FRAME, Writer, llvm

PLACES: dict[str, tuple[int, str]] = {
    "launch": (0, "u64"),
    "payload": (8, "u64"),
    "record": (16, "u64"),
    "primitive": (24, "u32"),
    "u": (28, "f32"),
    "v": (32, "f32"),
    "origin_x": (36, "f32"),
    "origin_y": (40, "f32"),
    "origin_z": (44, "f32"),
    "direction_x": (48, "f32"),
    "direction_y": (52, "f32"),
    "direction_z": (56, "f32"),
    "tmin": (60, "f32"),
    "tmax": (64, "f32"),
    "time": (68, "f32"),
    "flags": (72, "u32"),
    "mask": (76, "u32"),
    "hit_kind": (80, "u32"),
    "depth": (84, "u32"),
    "status": (88, "u32"),
    "index_x": (92, "u32"),
    "index_y": (96, "u32"),
    "index_z": (100, "u32"),
    "group": (104, "u32"),
}
"""Name to offset and type. ``record``: the address of the record's data."""
FRAME_BYTES = 112
IGNORE, TERMINATE = 1, 2
"""Bits of ``status`` that any-hit programs set."""
LAUNCH: dict[str, tuple[int, str]] = {
    "scene": (0, "u64"),
    "hit_records": (8, "u64"),
    "miss_records": (16, "u64"),
    "width": (24, "u32"),
    "height": (28, "u32"),
    "layers": (32, "u32"),
    "max_depth": (36, "u32"),
    "hit_count": (40, "u32"),
    "miss_count": (44, "u32"),
    "rays": (48, "u64"),
    "raygen_record": (56, "u64"),
    "flush": (64, "u32"),
    "mark": (72, "u64"),
}
"""Of the launch. ``rays``: the address of a thread's counters; ``flush``: denormals are zero;
``mark``: the address of the launch index that a thread works at."""
LAUNCH_BYTES = 80
_READS = {
    "_optix_get_sbt_data_ptr_64": ("record",),
    "_optix_read_primitive_idx": ("primitive",),
    "_optix_get_triangle_barycentrics": ("u", "v"),
    "_optix_get_ray_tmin": ("tmin",),
    "_optix_get_ray_tmax": ("tmax",),
    "_optix_get_ray_time": ("time",),
    "_optix_get_ray_flags": ("flags",),
    "_optix_get_ray_visibility_mask": ("mask",),
    "_optix_get_hit_kind": ("hit_kind",),
    "_optix_read_sbt_gas_idx": ("group",),
}
for _axis in "xyz":
    for _space in ("world", "object"):
        for _what in ("origin", "direction"):
            _READS[f"_optix_get_{_space}_ray_{_what}_{_axis}"] = (f"{_what}_{_axis}",)
    _READS[f"_optix_get_launch_index_{_axis}"] = (f"index_{_axis}",)
_DIMENSIONS = {
    f"_optix_get_launch_dimension_{axis}": size
    for axis, size in (("x", "width"), ("y", "height"), ("z", "layers"))
}
_CONSTANT = {
    "_optix_read_instance_id": "0",
    "_optix_read_instance_idx": "0",
    "_optix_get_transform_list_size": "0",
}
MOST_PAYLOAD = 8
_TRACE = re.compile(r"_optix_trace_([0-8])$")
_PAYLOAD = re.compile(r"_optix_(get|set)_payload_([0-7])$")


def place(w: Writer, base: str, offset: int) -> str:
    return w.value(f"getelementptr i8, ptr {base}, i64 {offset}")


def read(w: Writer, name: str) -> tuple[str, str]:
    """A value of the frame, and its type."""
    offset, type_ = PLACES[name]
    return w.value(f"load {llvm(type_)}, ptr {place(w, FRAME, offset)}"), type_


def known(name: str) -> bool:
    """Whether a call is one of these."""
    return (
        name in _READS
        or name in _CONSTANT
        or name in ("_optix_ignore_intersection", "_optix_terminate_ray")
        or name in _DIMENSIONS
        or bool(_TRACE.match(name) or _PAYLOAD.match(name))
    )


def call(w: Writer, name: str, returns: list[str], takes: list[str]) -> None:
    """One call. ``returns``: registers, ``takes``: operands."""
    if name in _READS:
        for register, what in zip(returns, _READS[name]):
            w.write(register, *read(w, what))
    elif name in _CONSTANT:
        w.write(returns[0], _CONSTANT[name], "u32")
    elif name in _DIMENSIONS:
        offset, type_ = LAUNCH[_DIMENSIONS[name]]
        launch = w.value(f"inttoptr i64 {read(w, 'launch')[0]} to ptr")
        w.write(returns[0], w.value(f"load i32, ptr {place(w, launch, offset)}"), type_)
    elif name in ("_optix_ignore_intersection", "_optix_terminate_ray"):
        bit = IGNORE if "ignore" in name else TERMINATE
        status, _ = read(w, "status")
        value = w.value(f"or i32 {status}, {bit}")
        w.emit(f"store i32 {value}, ptr {place(w, FRAME, PLACES['status'][0])}")
        w.jump("ret void")  # the program ends there
    elif found := _PAYLOAD.match(name):
        payload = w.value(f"inttoptr i64 {read(w, 'payload')[0]} to ptr")
        word = place(w, payload, 4 * int(found[2]))
        if found[1] == "get":
            w.write(returns[0], w.value(f"load i32, ptr {word}"), "u32")
        else:
            w.emit(f"store i32 {w.read(takes[0], 'u32')}, ptr {word}")
    else:
        trace(w, returns, takes)


def trace(w: Writer, returns: list[str], takes: list[str]) -> None:
    """``(payload …) = _optix_trace_N(handle, origin, direction, tmin, tmax, time, mask, flags,
    SBT offset, SBT stride, miss index, payload …)``."""
    types = ["u64", *["f32"] * 9, *["u32"] * 5]
    if len(takes) < len(types):
        raise w.fail("a trace call has too few arguments")
    values = [w.read(operand, type_) for operand, type_ in zip(takes, types)]
    payload = w.stack("i32", MOST_PAYLOAD)
    for index, operand in enumerate(takes[len(types) :]):
        word = place(w, payload, 4 * index)
        w.emit(f"store i32 {w.read(operand, 'u32')}, ptr {word}")
    listed = ", ".join(f"{llvm(t)} {v}" for t, v in zip(types, values))
    w.emit(f"call void @nau.trace(ptr {FRAME}, {listed}, ptr {payload})")
    for index, register in enumerate(returns):
        w.write(register, w.value(f"load i32, ptr {place(w, payload, 4 * index)}"), "u32")

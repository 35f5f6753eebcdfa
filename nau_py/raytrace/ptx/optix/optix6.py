"""Calls of the device interface of OptiX 3 to 6 (``optix_device.h``)."""

from __future__ import annotations

from nau_py.raytrace.ptx.compiler.frame_access import (
    end_any_hit,
    offset_pointer,
    read_frame,
    read_launch,
    throw_exception,
    trace_ray,
    unwind,
)
from nau_py.raytrace.ptx.compiler.writer import FRAME, FunctionWriter
from nau_py.raytrace.ptx.runtime.layout import IGNORE, TERMINATE, TRACE_ARGUMENTS

STACK_OVERFLOW = 0x3FC
"""RT_EXCEPTION_STACK_OVERFLOW."""
_TRACES = {
    "_rt_trace": ("tmin", "tmax"),
    "_rt_trace_with_time": ("tmin", "tmax", "time"),
    "_rt_trace_mask_flags": ("tmin", "tmax", "mask", "flags"),
    "_rt_trace_time_mask_flags": ("tmin", "tmax", "time", "mask", "flags"),
}
_READS = {
    "_rt_get_primitive_index": ("primitive",),
    "_rt_get_exception_code": ("code",),
    "_rt_get_ray_flags": ("flags",),
    "_rt_get_ray_mask": ("mask",),
    "_rt_get_triangle_barycentrics": ("u", "v"),
    "_rt_get_lowest_group_child_index": ("group",),
}
_CONSTANT = {
    "_rt_get_entry_point_index": "0",
    "_rt_print_active": "1",
    "_rt_is_triangle_hit": "0",
    "_rt_is_triangle_hit_back_face": "0",
    "_rt_is_triangle_hit_front_face": "0",
}
"""Results of calls that are always the same: there is one entry point, and the project's own
intersection program finds hits of triangles."""
_OTHERS = (
    "_rt_buffer_get",
    "_rt_buffer_get_size",
    "_rt_potential_intersection",
    "_rt_report_intersection",
    "_rt_ignore_intersection",
    "_rt_terminate_ray",
    "_rt_transform_tuple",
    "_rt_get_transform",
    "_rt_throw",
    "_rt_print_start",
    "_rt_print_write32",
)


def _short_name(name: str) -> str:
    return name.removesuffix("_64")


def handles_call(name: str) -> bool:
    """Return True if a function is one of this interface."""
    short = _short_name(name)
    return any(short in names for names in (_TRACES, _READS, _CONSTANT, _OTHERS))


def write_call(w: FunctionWriter, name: str, returns: list[str], takes: list[str]) -> None:
    """Write one call. ``returns``: registers of the results, ``takes``: operands."""
    short = _short_name(name)
    if short in _TRACES:
        _write_trace(w, _TRACES[short], takes)
    elif short in _READS:
        for register, what in zip(returns, _READS[short]):
            w.write(register, *read_frame(w, what))
    elif short in _CONSTANT:
        w.write(returns[0], _CONSTANT[short], "u32")
    elif short == "_rt_buffer_get":
        _write_buffer_access(w, returns, takes)
    elif short == "_rt_buffer_get_size":
        buffer = w.value(f"inttoptr i64 {w.read(takes[0], 'u64')} to ptr")
        for axis, register in enumerate(returns[:3]):
            size = w.value(f"load i64, ptr {offset_pointer(w, buffer, 8 + 8 * axis)}")
            w.write(register, size, "u64")
        for register in returns[3:]:
            w.write(register, "0", "u64")
    elif short == "_rt_potential_intersection":
        distance = w.read(takes[0], "f32")
        possible = w.value(f"call i32 @nau.potential(ptr {FRAME}, float {distance})")
        w.write(returns[0], possible, "u32")
    elif short == "_rt_report_intersection":
        taken = w.value(f"call i32 @nau.report(ptr {FRAME})")
        unwind(w)
        w.write(returns[0], taken, "u32")
    elif short in ("_rt_ignore_intersection", "_rt_terminate_ray"):
        end_any_hit(w, IGNORE if "ignore" in short else TERMINATE)
    elif short == "_rt_transform_tuple":  # there are no transforms: object space is world space
        for register, operand in zip(returns, takes[1:]):
            w.write(register, w.read(operand, "f32"), "f32")
    elif short == "_rt_get_transform":
        for index, register in enumerate(returns):
            w.write(register, "1.0" if index % 5 == 0 else "0.0", "f32")
    elif short == "_rt_throw":
        throw_exception(w, w.read(takes[0], "u32"), [])
    elif short == "_rt_print_start":
        text = w.read(takes[0], "u64")
        w.emit(f"call void @nau.print_start(ptr {FRAME}, i64 {text})")
        w.write(returns[0], "4", "u32")
    else:
        value, at = w.read(takes[0], "u32"), w.read(takes[1], "u32")
        w.emit(f"call void @nau.print_write(ptr {FRAME}, i32 {value}, i32 {at})")


def _write_trace(w: FunctionWriter, limits: tuple[str, ...], takes: list[str]) -> None:
    """Write ``trace(object, origin, direction, ray type, tmin, tmax …, payload, its bytes)``."""
    names = [*list(TRACE_ARGUMENTS)[:7], "offset", *limits]
    if len(takes) < len(names) + 1:
        raise w.fail("a trace call has too few arguments")
    values = {"time": "0.0", "mask": "255", "flags": "0"}
    values |= {name: w.read(operand, TRACE_ARGUMENTS[name]) for name, operand in zip(names, takes)}
    values["stride"], _ = read_launch(w, "types")
    values["miss"] = values["offset"]
    payload = w.value(f"inttoptr i64 {w.read(takes[len(names)], 'u64')} to ptr")
    trace_ray(w, values, payload)


def _write_buffer_access(w: FunctionWriter, returns: list[str], takes: list[str]) -> None:
    """Write ``(address) = buffer_get(buffer, dimensions, bytes, i, j, k, l)``."""
    buffer, size = w.read(takes[0], "u64"), w.read(takes[2], "u32")
    at = ", ".join(f"i64 {w.read(operand, 'u64')}" for operand in takes[3:6])
    found = w.value(f"call i64 @nau.element(ptr {FRAME}, i64 {buffer}, i32 {size}, {at})")
    unwind(w)
    w.write(returns[0], found, "u64")

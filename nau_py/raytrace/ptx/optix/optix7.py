"""Calls of the device interface of OptiX 7 and 8 (``optix_device.h``)."""

from __future__ import annotations

import re

from nau_py.raytrace.ptx.compiler.frame_access import (
    end_any_hit,
    offset_pointer,
    read_frame,
    read_launch,
    read_pointer,
    throw_exception,
    trace_ray,
    unwind,
)
from nau_py.raytrace.ptx.compiler.writer import FRAME, FunctionWriter
from nau_py.raytrace.ptx.runtime.layout import DETAILS, IGNORE, TERMINATE, TRACE_ARGUMENTS

_READS = {
    "get_sbt_data_ptr_64": ("record",),
    "read_primitive_idx": ("primitive",),
    "get_triangle_barycentrics": ("u", "v"),
    "get_ray_tmin": ("tmin",),
    "get_ray_tmax": ("tmax",),
    "get_ray_time": ("time",),
    "get_ray_flags": ("flags",),
    "get_ray_visibility_mask": ("mask",),
    "get_hit_kind": ("hit_kind",),
    "read_sbt_gas_idx": ("group",),
    "get_exception_code": ("code",),
}
for _axis in "xyz":
    for _space in ("world", "object"):  # equal, as there are no instances
        for _what in ("origin", "direction"):
            _READS[f"get_{_space}_ray_{_what}_{_axis}"] = (f"{_what}_{_axis}",)
    _READS[f"get_launch_index_{_axis}"] = (f"index_{_axis}",)
_LAUNCHED = {
    "get_launch_dimension_x": "width",
    "get_launch_dimension_y": "height",
    "get_launch_dimension_z": "layers",
}
_CONSTANT = {
    "read_instance_id": "-1",
    "read_instance_idx": "0",
    "get_transform_list_size": "0",
    "get_transform_list_handle": "0",
    "get_transform_type_from_handle": "0",
    "get_instance_id_from_handle": "0",
    "get_instance_child_from_handle": "0",
    "get_instance_transform_from_handle": "0",
    "get_instance_inverse_transform_from_handle": "0",
    "get_static_transform_from_handle": "0",
    "get_matrix_motion_transform_from_handle": "0",
    "get_srt_motion_transform_from_handle": "0",
    "get_gas_traversable_handle": "1",
    "get_gas_motion_step_count": "0",
    "get_gas_motion_time_begin": "0",
    "get_gas_motion_time_end": "0",
    "get_exception_line_info": "0",
    "undef_value": "0",
}
"""Results of calls without instances, as OptiX 9 returned them on an H200 (``tests/raytrace/ptx``).
Its documentation gives 0 as the instance id. The list of transforms is empty, so no program reads
one."""
_TRIANGLE, _CUSTOM = 0x2531, 0x2500
"""OPTIX_PRIMITIVE_TYPE_TRIANGLE and _CUSTOM (optix_types.h)."""
MOST_PAYLOAD = 32
_TRACE = re.compile(r"trace_([0-8])$")
_PAYLOAD = re.compile(r"(get|set)_payload_([0-7])$")
_ATTRIBUTE = re.compile(r"get_attribute_([0-7])$")
_REPORT = re.compile(r"report_intersection_([0-8])$")
_THROW = re.compile(r"throw_exception_([0-8])$")
_DETAIL = re.compile(r"get_exception_detail_([0-7])$")
_VERTICES = re.compile(r"get_triangle_vertex_data(_current_hit|_from_handle)?$")
_PATTERNS = (_TRACE, _PAYLOAD, _ATTRIBUTE, _REPORT, _THROW, _DETAIL, _VERTICES)
_OTHERS = {
    "ignore_intersection",
    "terminate_ray",
    "trace_typed_32",
    "get_payload",
    "set_payload",
    "set_payload_types",
    "call_direct_callable",
    "call_continuation_callable",
    "get_remaining_trace_depth",
    "get_backface_from_hit_kind",
    "get_primitive_type_from_hit_kind",
}
_PREFIX = "_optix_"


def handles_call(name: str) -> bool:
    """Return True if a function is one of this interface."""
    if not name.startswith(_PREFIX):
        return False
    short = name.removeprefix(_PREFIX)
    return (
        short in _READS
        or short in _LAUNCHED
        or short in _CONSTANT
        or short in _OTHERS
        or any(pattern.match(short) for pattern in _PATTERNS)
    )


def write_call(w: FunctionWriter, name: str, returns: list[str], takes: list[str]) -> None:
    """Write one call. ``returns``: registers of the results, ``takes``: operands."""
    short = name.removeprefix(_PREFIX)
    if short in _READS:
        for register, what in zip(returns, _READS[short]):
            w.write(register, *read_frame(w, what))
    elif short in _CONSTANT:
        for register in returns:
            w.write(register, _CONSTANT[short], "u64")
    elif short in _LAUNCHED:
        w.write(returns[0], *read_launch(w, _LAUNCHED[short]))
    elif short in ("ignore_intersection", "terminate_ray"):
        end_any_hit(w, IGNORE if "ignore" in short else TERMINATE)
    elif short == "set_payload_types":
        pass  # the type divides a payload; ours is not divided
    elif short in ("get_payload", "set_payload") or _PAYLOAD.match(short):
        _write_payload(w, short, returns, takes)
    elif short == "trace_typed_32":
        if len(takes) < 17:
            raise w.fail("a trace call has too few arguments")
        _write_trace(w, returns, takes[1:16], takes[17:])
    elif _TRACE.match(short):
        _write_trace(w, returns, takes[: len(TRACE_ARGUMENTS)], takes[len(TRACE_ARGUMENTS) :])
    elif found := _ATTRIBUTE.match(short):
        out = w.value(f"call i32 @nau.attribute(ptr {FRAME}, i32 {found[1]})")
        w.write(returns[0], out, "u32")
    elif _REPORT.match(short):
        _write_report(w, returns, takes)
    elif _THROW.match(short):
        details = [w.read(operand, "u32") for operand in takes[1:]]
        throw_exception(w, w.read(takes[0], "u32"), details[:DETAILS])
    elif found := _DETAIL.match(short):
        w.write(returns[0], *read_launch(w, f"detail_{found[1]}"))
    elif match := _VERTICES.match(short):
        _write_vertices(w, returns, [] if match[1] == "_current_hit" else takes)
    else:
        _write_query(w, short, returns, takes)


def _write_query(w: FunctionWriter, short: str, returns: list[str], takes: list[str]) -> None:
    """Write a call that returns one word."""
    if short == "get_remaining_trace_depth":
        most, depth = read_launch(w, "max_depth")[0], read_frame(w, "depth")[0]
        w.write(returns[0], w.value(f"sub i32 {most}, {depth}"), "u32")
    elif short == "get_backface_from_hit_kind":
        back = w.value(f"icmp eq i32 {w.read(takes[0], 'u32')}, 255")
        w.write(returns[0], w.value(f"zext i1 {back} to i32"), "u32")
    elif short == "get_primitive_type_from_hit_kind":
        own = w.value(f"icmp ult i32 {w.read(takes[0], 'u32')}, 128")
        what = w.value(f"select i1 {own}, i32 {_CUSTOM}, i32 {_TRIANGLE}")
        w.write(returns[0], what, "u32")
    else:  # the address of a callable program, or an exception
        index = w.read(takes[0], "u32")
        found = w.value(f"call i64 @nau.callable(ptr {FRAME}, i32 {index})")
        unwind(w)
        w.write(returns[0], found, "u64")


def _write_payload(w: FunctionWriter, short: str, returns: list[str], takes: list[str]) -> None:
    """Write ``get_payload_0`` of OptiX 7.0, or ``get_payload, (0)`` of later versions."""
    found = _PAYLOAD.match(short)
    number, values = (found[2], takes) if found else (takes[0], takes[1:])
    index = w.read(number, "u32")
    wide = w.value(f"zext i32 {index} to i64")
    word = w.value(f"getelementptr i32, ptr {read_pointer(w, 'payload')}, i64 {wide}")
    if short.startswith("get"):
        w.write(returns[0], w.value(f"load i32, ptr {word}"), "u32")
    else:
        w.emit(f"store i32 {w.read(values[0], 'u32')}, ptr {word}")


def _write_trace(
    w: FunctionWriter, returns: list[str], takes: list[str], payload: list[str]
) -> None:
    """Write a trace call, whose results are the payload.

    ``(payload …) = trace_N(handle, origin, direction, tmin, tmax, time, mask, flags, SBT offset,
    SBT stride, miss index, payload …)``.
    """
    if len(takes) < len(TRACE_ARGUMENTS):
        raise w.fail("a trace call has too few arguments")
    values = {n: w.read(o, t) for o, (n, t) in zip(takes, TRACE_ARGUMENTS.items())}
    words = w.stack("i32", MOST_PAYLOAD)
    for index, operand in enumerate(payload[:MOST_PAYLOAD]):
        w.emit(f"store i32 {w.read(operand, 'u32')}, ptr {offset_pointer(w, words, 4 * index)}")
    trace_ray(w, values, words)
    for index, register in enumerate(returns[:MOST_PAYLOAD]):
        w.write(register, w.value(f"load i32, ptr {offset_pointer(w, words, 4 * index)}"), "u32")


def _write_report(w: FunctionWriter, returns: list[str], takes: list[str]) -> None:
    """Write ``(taken) = report_intersection_N(distance, kind, attribute …)``."""
    distance, kind = w.read(takes[0], "f32"), w.read(takes[1], "u32")
    words = w.stack("i32", 8)
    for index, operand in enumerate(takes[2:10]):
        w.emit(f"store i32 {w.read(operand, 'u32')}, ptr {offset_pointer(w, words, 4 * index)}")
    count = max(len(takes) - 2, 0)
    taken = w.value(
        f"call i32 @nau.report7(ptr {FRAME}, float {distance}, i32 {kind}, ptr {words}, "
        f"i64 {4 * count})"
    )
    unwind(w)
    w.write(returns[0], taken, "u32")


def _write_vertices(w: FunctionWriter, returns: list[str], takes: list[str]) -> None:
    """Write ``(nine floats) = get_triangle_vertex_data(handle, primitive, SBT index, time)``."""
    primitive = w.read(takes[1], "u32") if takes else read_frame(w, "primitive")[0]
    group = w.read(takes[2], "u32") if takes else read_frame(w, "group")[0]
    out = w.stack("float", 9)
    w.emit(f"call void @nau.vertices(ptr {FRAME}, i32 {primitive}, i32 {group}, ptr {out})")
    for index, register in enumerate(returns):
        w.write(register, w.value(f"load float, ptr {offset_pointer(w, out, 4 * index)}"), "f32")

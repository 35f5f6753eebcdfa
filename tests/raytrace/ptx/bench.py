"""Runs single PTX instructions over arrays: each launch index computes one element."""

from __future__ import annotations

from typing import Any

import numpy as np

from nau_py.raytrace.ptx.compiler.module import SIZES
from nau_py.raytrace.ptx.compiler.reader import read_ptx
from nau_py.raytrace.ptx.optix.compile import compile_module
from nau_py.raytrace.ptx.runtime.launch import PtxLaunch, record_table, run_launch
from nau_py.raytrace.ptx.runtime.native import NativeModule

Array = np.ndarray[Any, Any]
TYPES = {
    "u16": np.uint16, "s16": np.int16, "u32": np.uint32, "s32": np.int32, "b32": np.uint32,
    "u64": np.uint64, "s64": np.int64, "b64": np.uint64, "f32": np.float32, "f64": np.float64,
    "u8": np.uint8, "s8": np.int8, "b16": np.uint16,
}  # fmt: skip
HEAD = ".version 6.4\n.target sm_30\n.address_size 64\n.const .align 8 .b8 optixLaunchParams[96];\n"


def register(type_: str) -> str:
    size = max(8 * SIZES[type_], 16)
    return type_ if type_ in ("f32", "f64") else f"b{size}"


def source(body: str, inputs: list[str], output: str) -> str:
    """Return a module whose entry ``run`` has element x of each input in %a0, %a1 …, and stores %d.

    Registers for ``body``: %p0-%p3, %i0-%i7 (b32), %l0-%l7 (b64), %f0-%f7, %g0-%g7 (f64).
    """
    lines = [HEAD, ".visible .entry run()\n{"]
    lines += [
        "\t.reg .pred %p<4>;",
        "\t.reg .b32 %i<8>;",
        "\t.reg .b64 %l<8>;",
        "\t.reg .b16 %h<8>;",
    ]
    lines += ["\t.reg .f32 %f<8>;", "\t.reg .f64 %g<8>;", "\t.reg .b32 %x;", "\t.reg .b64 %at<9>;"]
    lines += [f"\t.reg .{register(t)} %a{i};" for i, t in enumerate(inputs)]
    lines += [f"\t.reg .{register(output)} %d;", "\tcall (%x), _optix_get_launch_index_x, ();"]
    for index, type_ in enumerate([*inputs, output]):
        at = f"%at{index}"
        lines += [
            f"\tld.const.u64 {at}, [optixLaunchParams+{8 * index}];",
            f"\tmad.wide.u32 {at}, %x, {SIZES[type_]}, {at};",
        ]
        if index < len(inputs):
            lines.append(f"\tld.{type_} %a{index}, [{at}];")
    lines += ["\t" + body, f"\tst.{output} [%at{len(inputs)}], %d;", "\tret;", "}"]
    return "\n".join(lines) + "\n"


def run(body: str, inputs: dict[str, Array] | list[tuple[str, Array]], output: str) -> Array:
    """Return the outputs of ``body`` for each element of the inputs, (type, values)."""
    listed = list(inputs.items()) if isinstance(inputs, dict) else inputs
    module = read_ptx(source(body, [t for t, _ in listed], output))
    native = NativeModule(compile_module(module))
    arrays = [np.ascontiguousarray(values, TYPES[type_]) for type_, values in listed]
    count = len(arrays[0])
    out = np.zeros(count, TYPES[output])
    pointers = np.array([a.ctypes.data for a in [*arrays, out]], np.uint64)
    native.set_variable("optixLaunchParams", pointers.tobytes())
    nothing = record_table(1, 16)
    launch = PtxLaunch(
        (native, native.address("run")),
        0,
        nothing,
        nothing,
        nothing,
        (count, 1),
        flush=module.flushes,
    )
    run_launch(launch, [native], threads=1)
    return out

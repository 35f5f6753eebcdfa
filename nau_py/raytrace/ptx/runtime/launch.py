"""Launches of compiled programs: tiles of launch indices over threads."""

from __future__ import annotations

import ctypes
import os
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.kernels.geometry.cuda_texture import sampler_address
from nau_py.raytrace.ptx.runtime.layout import (
    FRAME_BYTES,
    FRAME_FIELDS,
    LAUNCH_BYTES,
    LAUNCH_FIELDS,
    RECORD_FIELDS,
    RECORD_HEADER,
)
from nau_py.raytrace.ptx.runtime.native import NativeModule
from nau_py.raytrace.ptx.runtime.printing import CALLBACK, PrintedTexts, format_text

TRACE_DEPTH = 20
"""Greatest depth of rays that trace rays, as in Nau."""
TRACE_DEPTH_EXCEEDED = (1 << 32) - 2
"""OPTIX_EXCEPTION_CODE_TRACE_DEPTH_EXCEEDED."""
TYPES = 16
"""Ray types with a counter of their own."""
_TILE = 4096
"""Launch indices of a tile, which one thread runs."""
_MOST_TEXTS = 1000
"""PrintedTexts texts in the result of a launch."""


def record_table(count: int, data_bytes: int) -> NDArray[np.uint8]:
    """Return records of zeros, uint8 (count, bytes): a header and data, a multiple of 16 bytes."""
    width = RECORD_HEADER + -(-data_bytes // 16) * 16
    return np.zeros((max(count, 1), width), np.uint8)


def set_program(record: NDArray[np.uint8], kind: str, address: int) -> None:
    """Write the address of a program into a record. ``kind``: closest, any, intersect."""
    at = RECORD_FIELDS[kind][0]
    record[at : at + 8] = np.frombuffer(np.uint64(address).tobytes(), np.uint8)


@dataclass(slots=True)
class PtxLaunch:
    """Programs, geometry and records of a launch.

    ``generate``: module and address of the ray generation program; ``scene``: handle of Embree's
    structure, 0 for none; ``hits`` and ``misses``: records (:func:`record_table`) of one width;
    ``context``: the record of ray generation and exception; ``size``: width and height in launch
    indices; ``indices``: int64, the selected launch indices, None for all; ``flush``: denormals are
    zero; ``marks``: int64, receives the launch indices in work, -1 for none
    (``runtime.guarded``).
    """

    generate: tuple[NativeModule, int]
    scene: int
    hits: NDArray[np.uint8]
    misses: NDArray[np.uint8]
    context: NDArray[np.uint8]
    size: tuple[int, int]
    types: int = 1
    exception: int = 0
    overflow: int = TRACE_DEPTH_EXCEEDED
    attribute_bytes: int = 32
    callables: NDArray[np.uint64] = field(default_factory=lambda: np.zeros(0, np.uint64))
    indices: NDArray[np.int64] | None = None
    max_depth: int = TRACE_DEPTH
    flush: bool = True
    marks: NDArray[np.int64] | None = None


@dataclass(slots=True)
class PtxLaunchResult:
    """Outcome of a launch.

    ``rays``: traced rays by ray type; ``thrown``: launch indices that ended with an exception,
    ``first`` and ``code``: the first of them and its code; ``printed``: texts by launch index.
    """

    rays: NDArray[np.uint64]
    thrown: int = 0
    first: int = 0
    code: int = 0
    printed: PrintedTexts = field(default_factory=list)


def make_launch_block(launch: PtxLaunch, rays: NDArray[np.uint64], mark: int) -> NDArray[np.uint8]:
    """Return the memory of a launch that programs and runtime read (``layout.LAUNCH_FIELDS``).

    ``rays``: uint64 (TYPES), receives the counts; ``mark``: address of the launch index in work.
    """
    width, height = launch.size
    values = {
        "scene": launch.scene,
        "hit_records": launch.hits.ctypes.data,
        "miss_records": launch.misses.ctypes.data,
        "rays": rays.ctypes.data,
        "raygen_record": launch.context.ctypes.data + RECORD_HEADER,
        "mark": mark,
        "exception": launch.exception,
        "indices": launch.indices.ctypes.data if launch.indices is not None else 0,
        "callables": launch.callables.ctypes.data,
        "width": width,
        "height": height,
        "layers": 1,
        "max_depth": launch.max_depth,
        "hit_count": len(launch.hits),
        "miss_count": len(launch.misses),
        "record_bytes": launch.hits.shape[1],
        "attribute_bytes": launch.attribute_bytes,
        "types": launch.types,
        "callable_count": len(launch.callables),
        "flush": launch.flush,
        "overflow": launch.overflow,
    }
    block = np.zeros(LAUNCH_BYTES, np.uint8)
    for name, value in values.items():
        _write_field(block, name, value)
    return block


def _write_field(block: NDArray[np.uint8], name: str, value: int) -> None:
    offset, type_ = LAUNCH_FIELDS[name]
    data = (np.uint64 if type_ == "u64" else np.uint32)(value).tobytes()
    block[offset : offset + len(data)] = np.frombuffer(data, np.uint8)


def _read_field(block: NDArray[np.uint8], name: str) -> int:
    offset, type_ = LAUNCH_FIELDS[name]
    return int.from_bytes(block[offset : offset + (8 if type_ == "u64" else 4)].tobytes(), "little")


def make_frame(block: NDArray[np.uint8], record: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return a frame, to run a program with a record outside of a launch.

    ``block``: memory of a launch (:func:`make_launch_block`).
    """
    frame = np.zeros(FRAME_BYTES, np.uint8)
    for name, value in (
        ("launch", block.ctypes.data),
        ("record", record.ctypes.data + RECORD_HEADER),
    ):
        at = FRAME_FIELDS[name][0]
        frame[at : at + 8] = np.frombuffer(np.uint64(value).tobytes(), np.uint8)
    return frame


def bind_host(natives: list[NativeModule], printed: PrintedTexts) -> Any:
    """Set the texture sampler and the printer of modules.

    ``printed`` receives the texts. Returns an object to keep until the launch ends.
    """
    lock = threading.Lock()

    def add_text(index: int, form: int, values: int, typed: int) -> None:
        text = format_text(form, values, bool(typed))
        with lock:
            printed.append((index, text))

    callback = CALLBACK(add_text)
    place = ctypes.cast(callback, ctypes.c_void_p).value or 0
    for native in natives:
        native.set_variable("nau.sampler", sampler_address().to_bytes(8, "little"))
        native.set_variable("nau.printer", place.to_bytes(8, "little"))
    return callback


def run_launch(
    launch: PtxLaunch,
    natives: list[NativeModule],
    threads: int = 0,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> PtxLaunchResult:
    """Run the ray generation program for every selected launch index.

    ``natives``: all modules of the programs; ``threads``: 0 for one per core; ``progress(done,
    total)`` is called after each tile. Results do not depend on the number of threads.
    """
    width, height = launch.size
    total = width * height if launch.indices is None else len(launch.indices)
    marks = np.full(1, -1, np.int64) if launch.marks is None else launch.marks
    found = PtxLaunchResult(np.zeros(TYPES, np.uint64))
    kept = bind_host(natives, found.printed)
    native, program = launch.generate
    run = ctypes.CFUNCTYPE(
        None, ctypes.c_uint64, ctypes.c_uint64, ctypes.c_uint64, ctypes.c_uint64
    )(native.address("nau.launch"))

    def run_tile(begin: int) -> tuple[NDArray[np.uint64], NDArray[np.uint8]]:
        rays = np.zeros(TYPES, np.uint64)
        own = np.full(1, -1, np.int64)
        slot = begin // _TILE % len(marks)
        mark = (marks[slot:] if launch.marks is not None else own).ctypes.data
        block = make_launch_block(launch, rays, mark)
        run(program, block.ctypes.data, begin, min(begin + _TILE, total))
        marks[slot] = -1
        return rays, block

    done = 0
    with ThreadPoolExecutor(threads or os.cpu_count() or 1) as pool:
        jobs = [pool.submit(run_tile, begin) for begin in range(0, total, _TILE)]
        try:
            for job in jobs:
                rays, block = job.result()
                found.rays += rays
                thrown = _read_field(block, "thrown_count")
                if thrown and not found.thrown:
                    found.first, found.code = (
                        _read_field(block, "first_thrown"),
                        _read_field(block, "first_code"),
                    )
                found.thrown += thrown
                done = min(done + _TILE, total)
                progress(done, total)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    del kept
    found.printed = sorted(found.printed, key=lambda line: line[0])[:_MOST_TEXTS]
    return found

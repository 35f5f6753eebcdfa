"""Calls of OptiX 7 and 8 that Nau's own programs do not use; ``data/new.cu`` has the programs.

``data/optix9.npz``: results of real OptiX 9 for the same launches on an NVIDIA H200, words of 32
bits. The remaining depth was not read there and is 0 in the file.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nau_py.raytrace.ptx.compiler.reader import read_ptx
from nau_py.raytrace.ptx.optix.compile import compile_module
from nau_py.raytrace.ptx.optix.records import DATA, RecordMaterial, RtScene, TriangleGroup
from nau_py.raytrace.ptx.runtime.launch import (
    TYPES,
    PtxLaunch,
    PtxLaunchResult,
    make_frame,
    make_launch_block,
    record_table,
    run_launch,
    set_program,
)
from nau_py.raytrace.ptx.runtime.native import NativeModule
from nau_py.raytrace.tracing.accelerator import CustomGeometry, build_groups

COUNT = 33
X = np.arange(COUNT) / 16 - 1
"""x of the rays' intersections with the plane z = 0, at y = 0.25, by launch index."""
POSITIONS = np.array(
    [(-0.5, -0.5, 0, 1), (0.5, -0.5, 0, 1), (0.5, 0.5, 0, 1), (-0.5, 0.5, 0, 1)], np.float32
)
TRIANGLES = np.array([(0, 1, 2), (2, 0, 3)], np.uint32)
"""A square; the second triangle is wound so that rays along -z see its back."""
INSIDE = np.abs(X) < 0.49
FIRST = INSIDE & (X > 0.26)
SECOND = INSIDE & (X < 0.24)
Array = np.ndarray[Any, Any]


@pytest.fixture(scope="module")
def native() -> NativeModule:
    text = (Path(__file__).parent.parent / "data" / "new.ptx").read_text()
    return NativeModule(compile_module(read_ptx(text)))


def launch(
    native: NativeModule,
    generate: str,
    closest: str,
    miss: str = "",
    exception: str = "",
    callables: tuple[str, ...] = (),
) -> tuple[Array, PtxLaunchResult]:
    """Return the output of each launch index, float32 (n, 4), for a square in the plane z = 0."""
    scene = RtScene([TriangleGroup("m", {"position": POSITIONS}, TRIANGLES)])
    hits = scene.make_records([[(native.address(closest), 0)]], [RecordMaterial()], ["position"])
    return _run(native, generate, scene.handle, hits, miss, exception, callables)


def _run(
    native: NativeModule,
    generate: str,
    handle: int,
    hits: Array,
    miss: str = "",
    exception: str = "",
    callables: tuple[str, ...] = (),
) -> tuple[Array, PtxLaunchResult]:
    misses, context = record_table(1, DATA.itemsize), record_table(1, 16)
    set_program(misses[0], "closest", native.address(miss) if miss else 0)
    out = np.zeros((COUNT, 4), np.float32)
    parameters = np.array([out.ctypes.data, 1], np.uint64)
    native.set_variable("optixLaunchParams", parameters.tobytes())
    done = run_launch(
        PtxLaunch(
            (native, native.address(generate)),
            handle,
            hits,
            misses,
            context,
            (COUNT, 1),
            exception=native.address(exception) if exception else 0,
            callables=np.array([native.address(c) for c in callables], np.uint64),
        ),
        [native],
        threads=1,
    )
    return out, done


def test_typed_payloads_of_32_words(native: NativeModule) -> None:
    """Words go down with the ray and come back; front and back faces differ."""
    out, done = launch(native, "__raygen__typed", "__closesthit__typed", "__miss__typed")
    np.testing.assert_array_equal(
        out[FIRST], np.tile([100 + 254, 200, 300 + 19 - 1, 20], (FIRST.sum(), 1))
    )
    np.testing.assert_array_equal(
        out[SECOND], np.tile([100 + 255, 201, 318, 20], (SECOND.sum(), 1))
    )
    beyond = np.abs(X) > 0.51
    np.testing.assert_array_equal(out[beyond], np.tile([7, 200, 300, 20], (beyond.sum(), 1)))
    assert done.thrown == 0


def test_corners_and_attributes_of_triangles(native: NativeModule) -> None:
    """Barycentric coordinates weight the corners; they are the first two attributes."""
    out, _ = launch(native, "__raygen__corners", "__closesthit__corners")
    np.testing.assert_allclose(out[INSIDE][:, 0], X[INSIDE], atol=1e-6)
    np.testing.assert_allclose(out[INSIDE][:, 1], 0.25, atol=1e-6)
    np.testing.assert_array_equal(out[INSIDE][:, 2], 1)


def real(name: str) -> Array:
    with np.load(Path(__file__).parent.parent / "data" / "optix9.npz") as found:
        return np.asarray(found[name])


SURE = (np.abs(np.abs(X) - 0.5) > 0.01) & (np.abs(X - 0.25) > 0.01)
"""Excludes the edges of the triangles, where either triangle may be hit."""


@pytest.mark.parametrize(
    "name, programs",
    [
        ("typed", ("__raygen__typed", "__closesthit__typed", "__miss__typed")),
        ("corners", ("__raygen__corners", "__closesthit__corners", "__miss__typed")),
        (
            "throws",
            ("__raygen__typed", "__closesthit__throws", "__miss__typed", "__exception__caught"),
        ),
    ],
)
def test_as_real_optix(native: NativeModule, name: str, programs: tuple[str, ...]) -> None:
    """Bits are equal, except for the remaining depth, and for points made of Embree's barycentrics:
    their last bits depend on the processor's instruction set, those of OptiX on the card."""
    out, _ = launch(native, *programs)
    expected = real(name)
    if name == "corners":
        points = expected[:, :2].view(np.float32)[INSIDE & SURE]
        ulp = np.spacing(np.float32(0.5))  # of the largest coordinate
        np.testing.assert_allclose(out[INSIDE & SURE, :2], points, rtol=0, atol=2 * ulp)
        out.view(np.uint32)[INSIDE, :2] = expected[INSIDE, :2]
    else:
        hit = SURE & INSIDE & (name == "typed")
        out[hit, 2] -= 19
        out[SURE & (out[:, 0] != -1), 3] -= 20
    np.testing.assert_array_equal(out.view(np.uint32)[SURE], expected[SURE])


def test_exceptions_unwind_to_their_program(native: NativeModule) -> None:
    out, done = launch(
        native, "__raygen__typed", "__closesthit__throws", exception="__exception__caught"
    )
    np.testing.assert_array_equal(out[FIRST], np.tile([-1, 42, 1000, 0], (FIRST.sum(), 1)))
    np.testing.assert_array_equal(out[SECOND], np.tile([-1, 42, 1001, 0], (SECOND.sum(), 1)))
    hit = np.flatnonzero(out[:, 0] == -1)
    assert (done.thrown, done.first, done.code) == (len(hit), hit[0], 42)
    without, done = launch(native, "__raygen__typed", "__closesthit__throws")
    np.testing.assert_array_equal(without[hit], 0)  # their work ended there
    assert done.thrown == len(hit)


def test_callable_programs(native: NativeModule) -> None:
    names = ("__direct_callable__add", "__continuation_callable__times")
    out, done = launch(native, "__raygen__calls", "__closesthit__typed", callables=names)
    x = np.arange(COUNT)
    np.testing.assert_array_equal(out[:, 0], x + 3)
    np.testing.assert_array_equal(out[:, 1], x * 0.5)
    np.testing.assert_array_equal(out.view(np.uint32), real("calls"))
    assert done.thrown == 0
    for exception in ("", "__exception__caught"):
        out, done = launch(
            native, "__raygen__calls_nothing", "__closesthit__typed", "", exception, names
        )
        np.testing.assert_array_equal(out[:, 0], -1 if exception else 1)
        assert done.thrown == COUNT


def test_intersection_programs_report_kind_and_attributes(native: NativeModule) -> None:
    """The program describes a square. Its any-hit program ignores the right half, where rays hit a
    second square behind."""
    hits = record_table(1, DATA.itemsize)
    for kind, name in (
        ("closest", "__closesthit__square"),
        ("any", "__anyhit__left"),
        ("intersect", "__intersection__square"),
    ):
        set_program(hits[0], kind, native.address(name))
    nothing = record_table(1, DATA.itemsize)
    rays, mark = np.zeros(TYPES, np.uint64), np.zeros(1, np.int64)
    described = PtxLaunch((native, 0), 0, hits, nothing, nothing, (1, 1))
    block = make_launch_block(described, rays, mark.ctypes.data)
    frame = make_frame(block, hits[0])
    user = np.array([native.address("box"), frame.ctypes.data], np.uint64)
    places = (native.address("nau.bounds"), native.address("nau.user"))
    handle, kept = build_groups([CustomGeometry(1, *places, user.ctypes.data)])
    out, _ = _run(native, "__raygen__corners", handle, hits, "__miss__typed")
    left = X[1:] <= 0  # the first ray passes along the box's side
    np.testing.assert_array_equal(out[1:][left][:, 0], X[1:][left].astype(np.float32))
    words = out[1:][left][:, 1].view(np.uint32)
    np.testing.assert_array_equal(words, 9 + 100 * 11)
    np.testing.assert_array_equal(out[1:][left][:, 2], 1)
    right = (X > 0) & (X < 1)
    np.testing.assert_array_equal(out[right][:, 0], 0)
    np.testing.assert_array_equal(out[right][:, 2], 0)  # at another distance
    words = out.view(np.uint32)[1:-1]
    same = [0, 2, 3]  # of one attribute the others are anything
    np.testing.assert_array_equal(words[:, same], real("square")[1:-1][:, same])
    np.testing.assert_array_equal(words[left[:-1]], real("square")[1:-1][left[:-1]])
    assert kept is not None

"""Arithmetic as nvcc compiles it, against results of an NVIDIA H200 for the same PTX.

``data/instructions.cu`` has one kernel per expression; ``on_gpu.py`` ran them and wrote
``h200.npz``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nau_py.raytrace.ptx.compiler.module import PtxModule
from nau_py.raytrace.ptx.compiler.reader import read_ptx
from nau_py.raytrace.ptx.optix.compile import compile_module
from nau_py.raytrace.ptx.runtime.launch import PtxLaunch, record_table, run_launch
from nau_py.raytrace.ptx.runtime.native import NativeModule
from tests.raytrace.ptx.on_gpu import COUNT, ORDER, OUTPUTS, inputs

DATA = Path(__file__).parent.parent / "data"
MODULE = read_ptx((DATA / "instructions.ptx").read_text())
NAMES = [function.name for function in MODULE.functions.values() if function.entry]
APPROXIMATE = (
    "sinh", "exp2", "rsqrt", "tanh", "tan", "asin", "acos", "atan", "exp", "cbrt", "cosh", "erf",
    "lgamma", "tgamma",
)  # fmt: skip
"""Approximate functions, which are exact here, with a tolerance in units in the last place."""
ULPS = 3
Array = np.ndarray[Any, Any]


@pytest.fixture(scope="module")
def module() -> tuple[PtxModule, NativeModule]:
    return MODULE, NativeModule(compile_module(MODULE))


@pytest.fixture(scope="module")
def card() -> dict[str, Array]:
    with np.load(DATA / "h200.npz") as found:
        return dict(found)


def test_all_kernels_ran_on_the_card(card: dict[str, Array]) -> None:
    assert set(NAMES) == set(card)
    assert len(NAMES) > 150


@pytest.mark.parametrize("name", NAMES)
def test_as_on_the_card(
    module: tuple[PtxModule, NativeModule], card: dict[str, Array], name: str
) -> None:
    """Bits are equal except for approximate functions; NaN where the card has NaN."""
    text, native = module
    given = inputs()
    written = {letter: np.zeros(COUNT, type_) for letter, type_ in OUTPUTS.items()}
    places = np.array([(given | written)[m].ctypes.data for m in ORDER], np.uint64)
    native.set_variable("optixLaunchParams", places.tobytes())
    none = record_table(1, 16)
    generate = (native, native.address(name))
    launch = PtxLaunch(generate, 0, none, none, none, (COUNT, 1), flush=text.flushes)
    run_launch(launch, [native], threads=1)
    found, wanted = written[name[0]], card[name]
    if name[2:] not in APPROXIMATE:
        np.testing.assert_array_equal(found, wanted)
        if found.dtype.kind == "f":
            number = ~np.isnan(wanted)
            np.testing.assert_array_equal(np.signbit(found[number]), np.signbit(wanted[number]))
        return
    assert (np.isnan(found) == np.isnan(wanted)).all()
    finite = np.isfinite(wanted)
    np.testing.assert_array_equal(found[np.isinf(wanted)], wanted[np.isinf(wanted)])
    unit = np.spacing(np.maximum(np.abs(wanted[finite]), np.finfo(wanted.dtype).tiny))
    assert (np.abs(found[finite] - wanted[finite]) <= ULPS * unit).all()

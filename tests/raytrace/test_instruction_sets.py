"""Embree held to other instruction sets: a stated tolerance across machines (docs/performance.md)."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import nau_py
from nau_py.raytrace.tracing.accelerator import ISA_VARIABLE, read_isa_limit
from tests.conftest import PROJECTS

SIZE, SAMPLES = 64, 4
PROJECT = PROJECTS / "mirror" / "project.xml"
WITHOUT_ISA = "cannot run Embree with the instruction set"


def run(isa: str, output: Path) -> subprocess.CompletedProcess[str]:
    """Render a sample in a process whose Embree is held to ``isa``."""
    command = Path(sys.executable).parent / "nau-run"
    words = [str(command), str(PROJECT), "-o", str(output), "--quiet"]
    words += ["--size", f"{SIZE}x{SIZE}", "--spp", str(SAMPLES)]
    environment = os.environ | {"NAU_EMBREE_ISA": isa}
    return subprocess.run(words, env=environment, capture_output=True, text=True)


@pytest.mark.parametrize("isa", ["sse4.2", pytest.param("avx2", marks=pytest.mark.slow)])
def test_instruction_sets_agree_within_the_stated_tolerance(isa: str, tmp_path: Path) -> None:
    """At most 1 of 255 a channel, in at most 1 % of the pixels."""
    file = tmp_path / "picture.npy"
    done = run(isa, file)
    if WITHOUT_ISA in done.stderr:
        pytest.skip(f"this processor has no {isa}")
    assert done.returncode == 0, done.stderr
    options = nau_py.RunOptions(samples=SAMPLES)
    own = nau_py.Renderer(nau_py.load(PROJECT), size=(SIZE, SIZE), options=options).render().image
    other = np.load(file)
    difference = np.abs(own.astype(int) - other.astype(int)).max(axis=2)
    assert difference.max() <= 1
    assert (difference > 0).mean() <= 0.01


def test_an_unknown_instruction_set_is_an_error_with_the_valid_names(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv(ISA_VARIABLE, "avx-2")
    with pytest.raises(nau_py.DeviceError) as found:
        read_isa_limit()
    assert str(found.value.diagnostics[0]) == (
        "error[D102]: NAU_EMBREE_ISA is 'avx-2'; one of sse4.2, avx, avx2, avx512 is expected "
        "(did you mean 'avx2'?)"
    )

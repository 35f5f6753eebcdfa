"""The estimated error of a run against the true one."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import nau_py
from nau_py.accuracy.ranking import Ranking
from nau_py.accuracy.statistics import find_t95
from tests.conftest import Folder
from tests.raytrace.studio import colour, program, square, studio

SEEDS, SAMPLES = 20, 64
BATCHES = 16
TURN = '<ROTATE x="1" y="0" z="0" w="90" />'
PANEL = (
    '<light name="Lamp"><POSITION x="0" y="4" z="0" /><SHAPE value="RECTANGLE" />'
    '<EDGE_U x="1.5" y="0" z="0" /><EDGE_V x="0" y="0" z="1.5" /></light>'
)


def shadow(folder: Folder, settings: str) -> nau_py.Project:
    """A penumbra down the middle."""
    return studio(
        folder,
        square("floor", "White", [9, 1, 9], [0, 0, 0])
        + square("card", "White", [5, 1, 9], [-5, 2, 0]),
        {"White": colour("DIFFUSE", 1.0, 1.0, 1.0, 1.0)},
        program("White", "direct"),
        lights=PANEL,
        camera='<POSITION x="0" y="1.5" z="0" /><VIEW x="0" y="-1" z="0" /><UP x="0" y="0" z="-1" />',
        size=(32, 24),
        spp=SAMPLES,
        settings=settings,
    )


def corner(folder: Folder, settings: str) -> nau_py.Project:
    """Ambient occlusion of a floor and a wall."""
    return studio(
        folder,
        square("floor", "White", [3, 1, 3], [0, -1, 0])
        + square("wall", "White", [3, 1, 3], [0, 0, -1], TURN),
        {"White": colour("DIFFUSE", 1.0, 1.0, 1.0, 1.0)},
        program("White", "ambient_occlusion"),
        size=(32, 24),
        spp=SAMPLES,
        settings=settings,
    )


def render(project: nau_py.Project, seed: int, samples: int) -> nau_py.Frame:
    options = nau_py.RunOptions(samples=samples, seed=seed)
    return nau_py.Renderer(project, options=options).render()


@pytest.mark.parametrize(
    "scene, sampler",
    [
        (shadow, "SOBOL"),
        pytest.param(corner, "RANDOM", marks=pytest.mark.slow),
        pytest.param(shadow, "RANDOM", marks=pytest.mark.slow),
        pytest.param(corner, "SOBOL", marks=pytest.mark.slow),
    ],
)
def test_the_interval_covers_the_truth(folder: Folder, scene: object, sampler: str) -> None:
    """The 95 % interval (Student's t of 16 batches) holds the true colour in 90 to 99 % of the
    pixels that have noise, over 20 seeds; the truth is the mean of 16,384 other samples."""
    assert callable(scene)
    project = scene(folder, f'<SAMPLER value="{sampler}" />')
    truth = np.mean(
        [render(project, 1000 + k, 2048).targets["L::out"][..., :3] for k in range(8)],
        axis=0,
        dtype=np.float64,
    )
    held, noisy = [], []
    for seed in range(SEEDS):
        frame = render(project, seed, SAMPLES)
        assert frame.error is not None
        difference = np.sqrt(((frame.targets["L::out"][..., :3] - truth) ** 2).mean(axis=-1))
        held.append(difference <= find_t95(BATCHES - 1) * frame.error + 1e-6)
        noisy.append(frame.error > 1e-5)
    where = np.array(noisy).mean(axis=0) > 0.5
    assert where.sum() > 200
    coverage = np.array(held)[:, where].mean()
    assert 0.90 <= coverage <= 0.99


def test_the_estimate_errs_on_the_safe_side(folder: Folder) -> None:
    """Root mean square over the picture: low-discrepancy points are better than their batches tell,
    by up to three times here, and never worse than report_part."""
    project = shadow(folder, "")
    truth = render(project, 1000, 8192).targets["L::out"][..., :3].astype(np.float64)
    frame = render(project, 1, SAMPLES)
    true = np.sqrt(((frame.targets["L::out"][..., :3] - truth) ** 2).mean())
    estimate = frame.report["frames"][0]["passes"][0]["est_error"]
    assert true < estimate < 3 * true


def test_seeds_that_change_nothing_are_told() -> None:
    """Two renders with other seeds that agree to the bit give no interval."""
    for own, count in ((0.0, 1), (1e-4, 0)):
        ranking = Ranking("rmse", "picture", SimpleNamespace(own_mse=lambda region, v=own: v), [])
        said = [note for note in ranking.list_notes() if "seeds change nothing" in note]
        assert len(said) == count

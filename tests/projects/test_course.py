"""The fourteen steps of the course: each runs, and adds its effect to the step before."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
import pytest

import nau_py
from nau_py.model.node import Setting
from tests.conftest import PROJECTS

STEPS = {int(p.name[:2]): p for p in sorted((PROJECTS / "course").glob("*.xml"))}
KINDS = {
    4: {"shadow"},
    5: {"shadow", "continuation"},
    6: {"shadow", "refraction", "continuation"},
    7: {"shadow", "reflection", "refraction", "continuation"},
    10: {"shadow", "reflection"},
    11: {"occlusion", "continuation"},
    13: {"shadow", "indirect", "reflection", "refraction", "continuation"},
}
SIZE = (96, 96)


@lru_cache(maxsize=32)
def traced(step: int, samples: int | None = None) -> nau_py.Frame:
    project = nau_py.load(STEPS[step])
    options = nau_py.RunOptions(samples=samples, check_numerics=True)
    return nau_py.Renderer(project, size=SIZE, options=options, keep_targets=True).render()


def radiance(step: int, samples: int | None = None) -> np.ndarray[Any, np.dtype[np.float32]]:
    """Return the traced colours, (height, width, 3)."""
    return np.asarray(traced(step, samples).targets["Studio::radiance"][..., :3])


def test_there_are_fourteen_steps_with_a_section_each() -> None:
    assert list(STEPS) == list(range(1, 15))
    page = (PROJECTS / "course" / "README.md").read_text()
    for step, file in STEPS.items():
        assert f"\n## {step}. " in page
        assert f"](#{step}-" in page
        assert f"projects/course/{file.name} " in page


@pytest.mark.parametrize("step", list(range(1, 15)))
def test_a_step_has_no_finding_and_a_picture(step: int) -> None:
    project = nau_py.load(STEPS[step])
    assert [str(d) for d in nau_py.lint(project)] == []
    frame = traced(step, 1)
    assert frame.report["nonfinite"] == 0
    assert frame.image[..., :3].std() > 10
    assert set(frame.report["totals"]["rays"]) >= KINDS.get(step, set()) | {"primary"}


def test_step_1_shows_the_colours_of_the_materials() -> None:
    """White except for glass, dark stone and other materials without a texture; above, the sky."""
    found = radiance(1)
    colours = {tuple(np.round(c, 4)) for c in found.reshape(-1, 3).tolist()}
    assert (1.0, 1.0, 1.0) in colours
    assert (0.03, 0.04, 0.05) in colours  # Kd of Vidro
    white = (found == 1).all(axis=-1).mean()
    assert 0.3 < white < 0.9


def test_shadows_only_take_light_away() -> None:
    lit, shadowed = radiance(3), radiance(4)
    assert (shadowed <= lit + 1e-6).all()
    assert (shadowed < lit - 0.05).any(axis=-1).mean() > 0.02
    assert np.isclose(shadowed, lit).all(axis=-1).mean() > 0.3


def test_holes_let_light_through() -> None:
    """Grilles differ from cards: holes show the background, shadows get lighter."""
    cards, grilles = radiance(4), radiance(5)
    changed = (np.abs(cards - grilles) > 1e-3).any(axis=-1)
    assert 0.005 < changed.mean() < 0.3


@pytest.mark.parametrize("step", [8, 9])
def test_more_samples_have_the_same_mean(step: int) -> None:
    """Anti-aliasing, and a small sun, move light about; they add none."""
    one, many = radiance(5), radiance(step, 16)
    assert abs(one.mean() - many.mean()) < 0.01
    assert np.abs(np.diff(many, axis=1)).mean() < np.abs(np.diff(one, axis=1)).mean()


def test_occlusion_is_a_part_of_the_colour() -> None:
    colour, occluded = radiance(2), radiance(11, 1)
    # where the sample at the pixel's centre and the jittered one meet the same colour
    assert ((occluded >= 0) & (occluded <= 1)).all()
    assert 0.3 < occluded.mean() / colour.mean() < 0.95


def through_lens(radius: float) -> np.ndarray[Any, np.dtype[np.float32]]:
    project = nau_py.load(STEPS[12])
    project.pipelines[0].passes[0].settings["LENS"] = Setting((radius,))
    options = nau_py.RunOptions(samples=16)
    renderer = nau_py.Renderer(project, size=SIZE, options=options, keep_targets=True)
    return np.asarray(renderer.render().targets["Studio::radiance"][..., :3])


def test_a_wider_lens_softens_edges_and_none_leaves_them() -> None:
    """A lens of radius 0 is a pinhole, the same picture as step 8; of 0.3, what is 8 units behind
    the sharp plane is spread over five pixels."""
    sharp, pinhole, wide = radiance(8, 16), through_lens(0.0), through_lens(0.3)
    steps = [
        np.percentile(np.abs(np.diff(p, axis=1)).max(axis=-1), 98) for p in (sharp, pinhole, wide)
    ]
    np.testing.assert_allclose(pinhole, sharp, atol=0.06)
    assert np.abs(pinhole - sharp).mean() < 1e-3
    assert steps[2] < 0.75 * steps[0]
    assert abs(sharp.mean() - wide.mean()) < 0.02


def test_four_suns_bring_four_times_the_sunlight() -> None:
    """Same paths, so that the radiance is linear in the sun: sky + 0.8 s and sky + 3.2 s."""
    weak, strong = radiance(13, 4).astype(float), radiance(14, 4).astype(float)
    assert (strong >= weak - 1e-5).all()
    sky = weak - (strong - weak) / 3
    assert (sky > -1e-4).all()
    assert sky.mean() > 0.1


def test_tone_mapping_keeps_the_order_of_brightness_and_burns_little() -> None:
    frame = traced(14, 4)
    bright = radiance(14, 4) @ np.array([0.2126, 0.7152, 0.0722])
    assert (bright > 1).mean() > 0.05
    assert (frame.image[..., :3].min(axis=-1) == 255).mean() < 0.02

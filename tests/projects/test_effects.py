"""The sample project of every effect: clean, finite, and what it is there to show."""

from __future__ import annotations

import numpy as np
import pytest

import nau_py
from nau_py.model.node import Setting
from nau_py.model.raytrace import RaytracePass
from tests.conftest import PROJECTS

EFFECTS = {
    "mirror": "reflection",
    "refraction": "refraction",
    "transparency": "continuation",
    "soft_shadows": "shadow",
    "ambient_occlusion": "occlusion",
    "depth_of_field": "shadow",
    "indirect": "indirect",
    "caustics": "refraction",
    "fluorescence": "indirect",
}


@pytest.mark.parametrize("name", sorted(EFFECTS))
def test_effect_project(name: str) -> None:
    """No finding, the kind of ray that it is about, a picture with no value out of bounds."""
    project = nau_py.load(PROJECTS / name / "project.xml")
    assert [str(d) for d in nau_py.lint(project)] == []
    options = nau_py.RunOptions(samples=1, check_numerics=True)
    frame = nau_py.Renderer(project, options=options).render()
    assert frame.report["totals"]["rays"][EFFECTS[name]] > 1000
    assert frame.report["nonfinite"] == 0
    radiance = next(iter(frame.targets.values()))
    assert np.isfinite(radiance).all()
    assert (radiance >= 0).all()
    assert frame.image[..., :3].std() > 10
    assert (PROJECTS / name / "README.md").is_file()


def penumbra(mask: bool) -> nau_py.Frame:
    """The penumbra project with one ray a pixel, through its centre, and 16 shadow rays."""
    project = nau_py.load(PROJECTS / "penumbra" / "project.xml")
    for pipeline in project.pipelines:
        for pass_ in pipeline.passes:
            if isinstance(pass_, RaytracePass):
                pass_.settings["LIGHT_SAMPLES"] = Setting((16,))
                pass_.rtInput = pass_.rtInput if mask else []
    options = nau_py.RunOptions(samples=1)
    return nau_py.Renderer(project, size=(192, 192), options=options).render()


def test_penumbra_at_the_border_only() -> None:
    """Rays at shadow borders give the picture that rays everywhere give, for a part of the cost."""
    hybrid, full = penumbra(mask=True), penumbra(mask=False)
    weight = hybrid.targets["Hybrid::weight"]
    chosen, seen = weight[..., 3] > 0, weight[..., :3].any(axis=-1)
    assert 0.02 < chosen.mean() < 0.2
    traced = full.targets["Hybrid::radiance"][..., :3]
    np.testing.assert_array_equal(traced[chosen], hybrid.targets["Hybrid::radiance"][chosen, :3])
    raster = hybrid.targets["Hybrid::color"][..., :3].astype(float) / 255
    wrong = np.abs(raster - np.clip(traced, 0, 1)).max(axis=-1) > 0.15
    # what is left to rasterisation is right but for textures' and cards' edges (no mip levels in
    # rays); where rays go, rasterisation would have been wrong far more often
    rest = wrong[seen & ~chosen].mean()
    assert rest < 0.04
    assert wrong[chosen].mean() > 4 * rest

"""Adaptive sampling, accumulation over frames, and values that are not finite."""

from __future__ import annotations

import numpy as np
import pytest

import nau_py
from nau_py.raytrace.tracing.adaptive import dilate
from tests.conftest import Folder
from tests.raytrace.studio import colour, picture, program, square, studio

LAMP = (
    '<light name="Lamp"><POSITION x="0" y="4" z="0" /><SHAPE value="RECTANGLE" />'
    '<EDGE_U x="1.5" y="0" z="0" /><EDGE_V x="0" y="0" z="1.5" /></light>'
)
DOWN = '<POSITION x="0" y="1.5" z="0" /><VIEW x="0" y="-1" z="0" /><UP x="0" y="0" z="-1" />'


def penumbra(folder: Folder, settings: str = "", spp: int = 64) -> nau_py.Project:
    """A soft shadow edge down the middle of the picture."""
    return studio(
        folder,
        square("floor", "White", [9, 1, 9], [0, 0, 0])
        + square("card", "White", [5, 1, 9], [-5, 2, 0]),
        {"White": colour("DIFFUSE", 1.0, 1.0, 1.0, 1.0)},
        program("White", "direct"),
        lights=LAMP,
        camera=DOWN,
        size=(48, 32),
        spp=spp,
        settings=settings,
    )


def test_spread_reaches_the_eight_neighbours() -> None:
    grid = np.zeros((5, 6), bool)
    grid[0, 0] = grid[3, 4] = True
    found = dilate(grid)
    expected = np.zeros((5, 6), bool)
    expected[0:2, 0:2] = expected[2:5, 3:6] = True
    np.testing.assert_array_equal(found, expected)


def test_adaptive_sampling_stops_where_it_may(folder: Folder) -> None:
    """Fewer rays than the full number, spent at the penumbra, and the target met on average."""
    target = 0.01
    project = penumbra(folder, f'<TARGET_ERROR value="{target}" />', spp=1024)
    frame = nau_py.Renderer(project).render()
    report = frame.report["frames"][0]["passes"][0]
    assert 16 * 48 * 32 < report["rays"]["primary"] < 0.7 * 1024 * 48 * 32
    assert report["rays"]["primary"] + report["rays_avoided"] == 1024 * 48 * 32
    assert report["est_error"] <= target
    reference = picture(penumbra(folder, spp=4096), seed=5)[..., 0]
    difference = frame.targets["L::out"][..., 0] - reference
    assert np.sqrt((difference**2).mean()) <= target


def test_adaptive_sampling_does_not_depend_on_threads_and_tiles(folder: Folder) -> None:
    project = penumbra(folder, '<TARGET_ERROR value="0.02" />', spp=256)
    first = picture(project, threads=1, tile=1000)
    np.testing.assert_array_equal(picture(project, threads=4, tile=1 << 20), first)


def test_frames_accumulate_while_nothing_moves(folder: Folder) -> None:
    """Four frames of 16 samples are one of 64, to the rounding of the sums."""
    renderer = nau_py.Renderer(penumbra(folder, '<ACCUMULATE value="true" />', spp=16))
    errors = []
    for index in range(4):
        frame = renderer.render(index)
        errors.append(frame.report["frames"][0]["passes"][0]["est_error"])
    whole = picture(penumbra(folder, spp=64))
    np.testing.assert_allclose(frame.targets["L::out"], whole, atol=1e-6)
    assert errors[3] < 0.7 * errors[0]


def test_a_target_error_of_nothing_takes_every_sample(folder: Folder) -> None:
    adaptive = penumbra(folder, '<TARGET_ERROR value="1e-9" />', spp=64)
    found = picture(adaptive)
    # pixels without variance stop early, with the same value
    np.testing.assert_allclose(found, picture(penumbra(folder, spp=64)), atol=1e-6)


NAN = """\
<rtDefaultMaterial><rayType name="Radiance">
<rtProgram type="CLOSEST_HIT" file="prog.py" proc="shade" />
</rayType></rtDefaultMaterial>
"""


def test_values_that_are_not_finite_are_traced_to_their_program(
    folder: Folder, ray_project: object
) -> None:
    folder.mtl("scene", {"Wall": {"Kd": "1 0 0"}})
    folder.obj("scene", [("Wall", [(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)])])
    folder.write(
        "prog.py",
        "import numpy as np\n\n\ndef shade(hits):\n    value = np.ones((len(hits), 3))\n"
        "    value[hits.rays.pixel == 64 * 2 + 5] = np.nan\n    return value\n",
    )
    project = ray_project(NAN, size=(64, 48))  # type: ignore[operator]
    renderer = nau_py.Renderer(project)
    frame = renderer.render()
    assert np.isfinite(frame.targets["L::out"]).all()
    assert frame.report["nonfinite"] == 1
    expected = (
        "pass 'trace': 1 samples or rays were not finite; the first at pixel (5, 2) from project "
        "'Rays', pass 'trace'"
    )
    messages = [d.message for d in renderer.diagnostics if d.rule == "T014"]
    assert [m[: len(expected)] for m in messages] == [expected]
    assert "material 'Wall', CLOSEST_HIT program 'shade'" in messages[0]
    strict = nau_py.Renderer(project, options=nau_py.RunOptions(check_numerics=True))
    with pytest.raises(nau_py.NauError, match="1 samples or rays were not finite"):
        strict.render()

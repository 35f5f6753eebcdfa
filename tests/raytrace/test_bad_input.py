"""Bad input has a defined result, or a diagnostic that names it."""

from __future__ import annotations

import numpy as np
import pytest

import nau_py
from tests.conftest import Folder
from tests.raytrace.studio import colour, picture, program, sphere, square, studio

FLOOR = square("floor", "White", [9, 1, 9], [0, -1, 0])


def lint(folder: Folder, material: str = "", **options: object) -> list[str]:
    project = studio(folder, FLOOR, {"White": material}, **options)  # type: ignore[arg-type]
    return [f"{d.rule} {d.message}" for d in nau_py.lint(project)]


@pytest.mark.parametrize(
    "material, expected",
    [
        (colour("DIFFUSE", float("nan"), 1.0, 1.0, 1.0), "V007 <DIFFUSE> of <color> is 'nan'"),
        (
            '<DIFFUSE r="1e999" g="1" b="1" a="1" />',
            "Q003 material 'White': DIFFUSE is inf, 1, 1, 1; numbers are expected",
        ),
        (
            colour("SPECULAR", -0.5, 0.0, 0.0, 1.0),
            "Q004 material 'White': SPECULAR has the negative value -0.5",
        ),
        (
            colour("ABSORPTION", 0.0, -2.0, 0.0, 1.0),
            "Q004 material 'White': ABSORPTION has the negative value -2",
        ),
        (colour("SHININESS", -3.0), "Q004 material 'White': SHININESS has the negative value -3"),
        (colour("ROUGHNESS", 1.5), "V006 <ROUGHNESS> of <color> is 1.5; it must be from 0 to 1"),
        (
            colour("DIFFUSE", 0.0, 0.0, 0.8, 1.0)
            + colour("FLUORESCENCE_BLUE", 0.25, 0.25, 0.0, 1.0),
            "Q005 material 'White': of blue light it reflects 0.8 and re-emits 0.5, together 1.3; "
            "at most 1 is possible",
        ),
    ],
)
def test_materials(folder: Folder, material: str, expected: str) -> None:
    found = lint(folder, material)
    assert any(line.startswith(expected) for line in found), found


@pytest.mark.parametrize(
    "options, expected",
    [
        ({"spp": 0}, "RAYS_PER_PIXEL"),
        ({"spp": -4}, "RAYS_PER_PIXEL"),
        ({"depth": 0}, "MAX_DEPTH"),
        (
            {"camera": '<POSITION x="0" y="0" z="3" /><APERTURE value="-1" />'},
            "Q006 APERTURE of camera 'C' is -1; it must be at least 0",
        ),
        (
            {"camera": '<FOCUS_DISTANCE value="0" />'},
            "Q006 FOCUS_DISTANCE of camera 'C' is 0; it must be greater than 0",
        ),
        (
            {"lights": '<light name="L"><SHAPE value="SPHERE" /><RADIUS value="0" /></light>'},
            "Q002 light 'L': a SPHERE of RADIUS 0 has no area; it acts as a point",
        ),
        (
            {
                "lights": '<light name="L"><SHAPE value="RECTANGLE" /><EDGE_V x="2" y="0" z="0" /></light>'
            },
            "Q002 light 'L': EDGE_U and EDGE_V of its RECTANGLE span no area",
        ),
    ],
)
def test_passes_cameras_and_lights(
    folder: Folder, options: dict[str, object], expected: str
) -> None:
    found = lint(folder, colour("DIFFUSE", 1.0, 1.0, 1.0, 1.0), **options)
    assert any(expected in line for line in found), found


def test_a_scene_without_triangles_shows_the_background(folder: Folder) -> None:
    project = studio(
        folder, '<geometry name="axis" type="AXIS" />', {}, clear=(0.25, 0.5, 0.75), size=(8, 8)
    )
    np.testing.assert_allclose(picture(project)[..., :3], np.tile([0.25, 0.5, 0.75], (8, 8, 1)))


def test_a_light_inside_geometry_lights_the_inside_only(folder: Folder) -> None:
    project = studio(
        folder,
        FLOOR + sphere("shell", "White", 0.5, [0, 0, 0], 32),
        {"White": colour("DIFFUSE", 1.0, 1.0, 1.0, 1.0)},
        program("White", "direct"),
        lights='<light name="L"><POSITION x="0" y="0" z="0" /><SHAPE value="POINT" /></light>',
        size=(16, 16),
    )
    found = picture(project)
    assert np.isfinite(found).all()
    assert found[..., :3].max() == 0


def test_an_interrupt_ends_a_render_at_once(folder: Folder) -> None:
    """Ctrl-C in the middle: tiles that wait are never begun, and nothing is kept of the frame."""
    project = studio(
        folder,
        FLOOR,
        {"White": colour("DIFFUSE", 1.0, 1.0, 1.0, 1.0)},
        program("White", "direct"),
        size=(64, 64),
        spp=64,
    )
    seen: list[int] = []

    def interrupt(name: str, done: int, total: int) -> None:
        seen.append(done)
        raise KeyboardInterrupt

    options = nau_py.RunOptions(threads=1, tile=1024)
    with pytest.raises(KeyboardInterrupt):
        nau_py.Renderer(project, options=options, progress=interrupt).render()
    assert len(seen) == 1

"""Objects that move between frames."""

from __future__ import annotations

import numpy as np
import pytest

import nau_py
from tests.conftest import Folder
from tests.raytrace.studio import box, colour, program, sphere, square, studio


def scene(folder: Folder) -> nau_py.Project:
    studio(
        folder,
        square("floor", "White", [9, 1, 9], [0, -1, 0])
        + box("box", "White", [0.4, 0.4, 0.4], [-0.8, -0.3, 0])
        + sphere("ball", "Mirror", 0.5, [0.6, 0, 0], 32),
        {
            "White": colour("DIFFUSE", 1.0, 0.8, 0.6, 1.0),
            "Mirror": colour("SPECULAR", 0.9, 0.9, 0.9, 1.0),
        },
        program("White", "direct") + program("Mirror", "mirror"),
        lights='<light name="L"><DIRECTION x="-0.4" y="-1" z="-0.3" /></light>',
        clear=(0.3, 0.4, 0.6),
    )
    text = (folder.path / "project.xml").read_text()
    folder.write("project.xml", text.replace('<scene name="S">', '<scene name="S" type="Scene">'))
    return folder.load()


def placed(x: float, turn: float) -> np.ndarray:  # type: ignore[type-arg]
    c, s = np.cos(turn), np.sin(turn)
    matrix = np.array([[c, 0, s, x], [0, 1, 0, -0.2], [-s, 0, c, 0.3], [0, 0, 0, 1]])
    matrix[:3, :3] *= 0.4
    return matrix


def test_a_moved_object_is_built_anew_alone(folder: Folder) -> None:
    """Frame by frame the bits of a renderer that builds everything afresh; what stands is kept."""
    project = scene(folder)
    renderer = nau_py.Renderer(project)
    first = renderer.render(0).targets["L::out"]
    standing = []
    for index in range(1, 4):
        renderer.move("box", placed(-0.8 + 0.3 * index, 0.4 * index))
        found = renderer.render(index).targets["L::out"]
        standing.append(renderer.session.states["trace"].accelerator.scene)
        fresh = nau_py.Renderer(project)
        fresh.move("box", placed(-0.8 + 0.3 * index, 0.4 * index))
        np.testing.assert_array_equal(found, fresh.render(0).targets["L::out"])
        assert (found != first).any()
    assert len(set(standing)) == 1


def test_moving_is_the_same_as_having_been_there(folder: Folder) -> None:
    """One scene or two: the same picture where no two surfaces are equally near."""
    project = scene(folder)
    still = nau_py.Renderer(project).render().targets["L::out"]
    renderer = nau_py.Renderer(project)
    ball = np.diag([0.5, 0.5, 0.5, 1.0])
    ball[0, 3] = 0.6
    renderer.move("ball", ball)
    np.testing.assert_allclose(renderer.render().targets["L::out"], still, atol=1e-6)


def test_moving_nothing_says_what_there_is(folder: Folder) -> None:
    renderer = nau_py.Renderer(scene(folder))
    with pytest.raises(
        ValueError, match="no object is called 'bal'; there is 'ball', 'box', 'floor'"
    ):
        renderer.move("bal", np.eye(4))
    with pytest.raises(ValueError, match="object 'ball': a finite matrix of shape"):
        renderer.move("ball", np.full((4, 4), np.nan))

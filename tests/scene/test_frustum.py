"""A camera's hidden scene: where its frustum's corners are."""

from __future__ import annotations

import numpy as np
import pytest

from nau_py.scene.world import World
from tests.conftest import Folder

PROJECT = """\
<project name="P" width="40" height="20"><assets>
 <cameras><camera name="C"><projection {kind} NEAR="1" FAR="7"/><POSITION x="1" y="2" z="3"/>
  <VIEW x="1" y="0.5" z="-2"/></camera></cameras></assets>
 <pipelines><pipeline name="Q"><pass name="p"><scenes><scene name="C"/></scenes></pass></pipeline>
 </pipelines></project>
"""


@pytest.mark.parametrize(
    "kind",
    [
        'TYPE="PERSPECTIVE" FOV="50"',
        'TYPE="ORTHO" LEFT="-3" RIGHT="2" BOTTOM="-1" TOP="4"',
    ],
)
def test_a_frustums_corners_are_the_corners_of_clip_space(folder: Folder, kind: str) -> None:
    folder.write("project.xml", PROJECT.format(kind=kind))
    world = World(folder.load(), (40, 20))
    (found,) = world.objects(["C"])
    camera = world.camera("C")
    points = found.mesh.positions.astype(float) @ found.matrix.T
    clip = points @ (camera.projection_matrix(2.0) @ camera.view_matrix()).T
    ndc = clip[:, :3] / clip[:, 3:]
    corners = [(-1, 1), (1, 1), (1, -1), (-1, -1)]
    expected = [(x, y, z) for z in (-1, 1) for x, y in corners]
    np.testing.assert_allclose(ndc, expected, atol=1e-6)
    assert found.mesh.primitive == "LINES"
    assert [len(g.indices) for g in found.mesh.groups] == [8, 4]


def test_a_frustum_follows_its_camera(folder: Folder) -> None:
    folder.write("project.xml", PROJECT.format(kind='TYPE="PERSPECTIVE" FOV="50"'))
    world = World(folder.load(), (40, 20))
    before = world.objects(["C"])[0].mesh.version
    world.camera("C").values["FAR"] = 9.0
    (found,) = world.objects(["C"])
    assert found.mesh.version == before + 1
    assert found.mesh.positions[:, 2].min() == -9

"""Models that Assimp reads (docs/format.md, 10.3)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import nau_py
from nau_py.scene.readers.assimp import load_assimp
from nau_py.scene.readers.model_error import ModelError
from nau_py.scene.world import World
from tests.conftest import Folder

PLY = """\
ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
0 0 0
2 0 0
2 3 0
0 3 0
4 0 1 2 3
"""
STL = """\
solid s
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 1 5
endloop
endfacet
endsolid s
"""


def triangles(
    path: Path, swap_yz: bool = False
) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Corners of every triangle, (m, 3, 3), sorted so that vertex order does not matter."""
    objects, _ = load_assimp(path, swap_yz)
    found = []
    for item in objects:
        points = item.mesh.positions.astype(np.float64) @ item.matrix.T
        found += [points[g.indices][:, :, :3] for g in item.mesh.groups]
    return np.sort(np.concatenate(found), axis=1)


def test_polygons_are_triangulated(folder: Folder) -> None:
    found = triangles(folder.write("a.ply", PLY))
    assert found.shape == (2, 3, 3)
    assert found.min(axis=(0, 1)).tolist() == [0, 0, 0]
    assert found.max(axis=(0, 1)).tolist() == [2, 3, 0]


def test_swap_yz_turns_the_axes(folder: Folder) -> None:
    """(x, y, z) → (x, -z, y)."""
    path = folder.write("a.stl", STL)
    plain, turned = triangles(path), triangles(path, swap_yz=True)
    assert plain.max(axis=(0, 1)).tolist() == [1, 1, 5]
    assert turned.min(axis=(0, 1)).tolist() == [0, -5, 0]
    assert turned.max(axis=(0, 1)).tolist() == [1, 0, 1]


def test_vertices_have_normals_and_materials_are_named(folder: Folder) -> None:
    objects, materials = load_assimp(folder.write("a.stl", STL), False)
    mesh = objects[0].mesh
    assert mesh.attributes["position"][:, 3].tolist() == [1, 1, 1]
    assert mesh.attributes["normal"].shape == (3, 4)
    assert mesh.groups[0].material in {m.name for m in materials}


@pytest.mark.parametrize(
    "name, text", [("a.ply", "ply\nnothing"), ("a.stl", ""), ("a.dae", "<x/>")]
)
def test_files_that_do_not_parse_are_diagnostics(folder: Folder, name: str, text: str) -> None:
    path = folder.write(name, text)
    with pytest.raises(ModelError):
        load_assimp(path, False)
    folder.write(
        "project.xml",
        f'<project name="P"><assets><scenes><scene name="S"><file name="{name}"/></scene></scenes>'
        '</assets><pipelines><pipeline name="Q"><pass name="a"/></pipeline></pipelines></project>',
    )
    (found,) = World(folder.load(), (8, 8)).diagnostics
    assert found.rule == "M001"
    assert f"model '{name}'" in found.message
    assert found.location.line == 1


def test_a_model_of_assimp_is_drawn(folder: Folder) -> None:
    folder.write("a.ply", PLY)
    folder.write(
        "project.xml",
        '<project name="P" width="32" height="32"><assets><scenes><scene name="S" param="UNITIZE">'
        '<file name="a.ply"/></scene></scenes><cameras><camera name="C"><POSITION x="0" y="0" z="3"/>'
        '</camera></cameras></assets><pipelines><pipeline name="Q"><pass name="a"><camera name="C"/>'
        '<scenes><scene name="S"/></scenes></pass></pipeline></pipelines></project>',
    )
    image = nau_py.Renderer(folder.load()).render().image
    assert image[16, 16, 3] == 255
    assert image[0, 0, 3] == 0

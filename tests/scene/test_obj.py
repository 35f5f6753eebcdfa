"""OBJ and MTL by Nau's rules (docs/format.md, 10.2)."""

from __future__ import annotations

import numpy as np
import pytest

from nau_py.scene.readers.model_error import ModelError
from nau_py.scene.readers.obj import load_obj
from tests.conftest import Folder


def test_polygons_shared_corners_and_negative_indices(folder: Folder) -> None:
    path = folder.write(
        "a.obj",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\n"
        "f 1//1 2//1 3//1 4//1\nf -4//-1 -2//-1 -1//-1\n",
    )
    mesh, materials = load_obj(path)
    assert materials == []
    assert [g.material for g in mesh.groups] == ["DefaultOBJMaterial"]
    assert mesh.vertex_count == 4
    corners = mesh.positions[mesh.groups[0].indices][:, :, :3]
    expected = [
        [(0, 0, 0), (1, 0, 0), (1, 1, 0)],
        [(0, 0, 0), (1, 1, 0), (0, 1, 0)],
        [(0, 0, 0), (1, 1, 0), (0, 1, 0)],
    ]
    assert corners.tolist() == np.array(expected, float).tolist()
    assert mesh.positions[:, 3].tolist() == [1, 1, 1, 1]
    assert mesh.attributes["normal"][0].tolist() == [0, 0, 1, 0]


def test_groups_are_keyed_in_byte_order_and_joined_by_material(folder: Folder) -> None:
    folder.write("a.mtl", "newmtl red\nnewmtl blue\n")
    path = folder.write(
        "a.obj",
        "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"
        "g z\nusemtl red\nf 1 2 3\ng a\nusemtl blue\nf 1 2 3\n"
        "g m\nusemtl red\nf 3 2 1\n",
    )
    mesh, _ = load_obj(path)
    assert [(g.material, len(g.indices)) for g in mesh.groups] == [("blue", 1), ("red", 2)]


def test_materials(folder: Folder) -> None:
    folder.write(
        "a.mtl",
        "newmtl m\nKd .1 .2 .3\nKs 1 1 1\nKa 0 0 0\nKe 2 0 0\nNs 500\n"
        "map_Kd a.png\nmap_Ks s.png\nbump b.png\nmap_d d.png\nd 0.5\nnewmtl r\nPr 0.5\n",
    )
    path = folder.write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n")
    _, (m, r) = load_obj(path)
    assert m.colours["DIFFUSE"] == (0.1, 0.2, 0.3, 1.0)
    assert m.colours["EMISSION"] == (2.0, 0.0, 0.0, 1.0)
    assert m.colours["SHININESS"] == (64.0,)
    assert {unit: p.name for unit, p in m.textures.items()} == {
        0: "a.png",
        1: "b.png",
        4: "s.png",
        5: "d.png",
    }
    assert r.colours["SHININESS"] == (6.0,)


def test_normals_are_smoothed_below_the_crease_angle(folder: Folder) -> None:
    # two faces at 90° keep their own normals, two at about 53° share the mean
    for height, smooth in ((None, False), (1.0, True)):
        third = "v 0 1 1" if height is None else "v 0 2 -1"
        path = folder.write(
            "a.obj",
            f"v 0 0 0\nv 1 0 0\n{third}\nv 0 -1 0\nf 1 2 3\nf 2 1 4\n"
            if smooth
            else "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 2 1 4\n",
        )
        mesh, _ = load_obj(path)
        p = mesh.positions[:, :3].astype(float)
        t = mesh.groups[0].indices
        facets = np.cross(p[t[:, 1]] - p[t[:, 0]], p[t[:, 2]] - p[t[:, 0]])
        facets /= np.linalg.norm(facets, axis=1, keepdims=True)
        normal = mesh.attributes["normal"][t[0, 0], :3]
        mean = facets.sum(axis=0) / np.linalg.norm(facets.sum(axis=0))
        np.testing.assert_allclose(normal, mean if smooth else facets[0], atol=1e-6)


def test_tangents_run_along_u(folder: Folder) -> None:
    path = folder.write(
        "a.obj", "v 0 0 0\nv 2 0 0\nv 0 2 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n"
    )
    mesh, _ = load_obj(path)
    np.testing.assert_allclose(mesh.attributes["tangent"], [[1, 0, 0, 0]] * 3, atol=1e-7)


@pytest.mark.parametrize(
    "text, message, line",
    [
        ("v 0 0 0\n", "holds no face", 0),
        ("v 0 0 0\nv 1 0 0\nf 1 2 3\n", "face corner '3' names vertex 3 of 2", 3),
        ("v 0 0 0\nf 1 x 1\n", "face corner 'x' is no index", 2),
        ("v 0 0 zero\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "a 'v' line holds something", 0),
        ("mtllib no.mtl\n", "names the material library 'no.mtl', which does not exist", 0),
    ],
)
def test_bad_files(folder: Folder, text: str, message: str, line: int) -> None:
    with pytest.raises(ModelError, match=message) as caught:
        load_obj(folder.write("a.obj", text))
    assert caught.value.line == line

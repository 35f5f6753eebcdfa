"""NBO, Ogre meshes, patches and terrain: small files written by hand, and what they must become."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from nau_py.scene.mesh import Mesh, SceneObject
from nau_py.scene.readers.loading import read_model
from nau_py.scene.readers.model_error import ModelError
from nau_py.scene.readers.nbo import load_nbo
from nau_py.scene.readers.ogre import load_ogre
from nau_py.scene.readers.patch import load_patch
from nau_py.scene.readers.registry import READERS, Model, register_reader
from nau_py.scene.readers.terrain import load_terrain
from tests.conftest import Folder


def text(value: str) -> bytes:
    return struct.pack("<I", len(value)) + value.encode() + b"\0"


def nbo(indices: list[int], points: list[list[float]]) -> bytes:
    """One object 'o' with one mesh 'm' of material 'Red', moved by (1, 2, 3)."""
    material = text("Red") + struct.pack("<16f", *[0.1] * 4, *[0.2] * 4, 1, 0, 0, 1, *[0.0] * 4)
    material += struct.pack("<f", 32.0) + text("wood.png") + 7 * text("<no texture>")
    data = struct.pack("<I", 1) + material + text("Scene") + struct.pack("<I", 1)
    data += text("SimpleObject") + text("o") + text("BoundingBox") + struct.pack("<I", 0)
    matrix = np.eye(4)
    matrix[:3, 3] = (1, 2, 3)
    data += matrix.T.astype("<f4").tobytes() + text("m") + text("Mesh")
    data += struct.pack("<I", 1) + text("position") + struct.pack("<I", len(points))
    data += np.array(points, "<f4").tobytes() + struct.pack("<I", 0)
    data += struct.pack("<I", 1) + text("Red") + struct.pack("<II", 0, len(indices))
    return data + np.array(indices, "<u4").tobytes()


POINTS = [[0.0, 0, 0, 1], [1, 0, 0, 1], [0, 1, 0, 1]]


def test_nbo(tmp_path: Path) -> None:
    file = tmp_path / "a.nbo"
    file.write_bytes(nbo([0, 1, 2], POINTS))
    (tmp_path / "wood.png").write_bytes(b"")
    objects, materials = load_nbo(file)
    (found,), (material,) = objects, materials
    assert (found.name, found.mesh.groups[0].material) == ("o", "Red")
    np.testing.assert_array_equal(found.matrix[:3, 3], [1, 2, 3])
    np.testing.assert_array_equal(found.mesh.positions, POINTS)
    assert found.mesh.groups[0].indices.tolist() == [[0, 1, 2]]
    assert material.colours["DIFFUSE"] == (1, 0, 0, 1)
    assert material.colours["SHININESS"] == (32,)
    assert material.textures == {0: tmp_path / "wood.png"}


def test_a_cut_or_wrong_nbo_says_what_is_wrong(tmp_path: Path) -> None:
    """Every prefix of a file, and random bytes: an error of the reader, never another one."""
    whole = nbo([0, 1, 2], POINTS)
    file = tmp_path / "a.nbo"
    for size in range(len(whole) - 1):
        file.write_bytes(whole[:size])
        with pytest.raises(ModelError):
            load_nbo(file)
    file.write_bytes(nbo([0, 1, 7], POINTS))
    with pytest.raises(ModelError, match="object 'o': index 7 of 3 vertices"):
        load_nbo(file)
    file.write_bytes(np.random.default_rng(1).bytes(500))
    with pytest.raises(ModelError):
        load_nbo(file)


OGRE = """\
<mesh><submeshes>
 <submesh material="A" usesharedvertices="false" operationtype="triangle_strip">
  <faces count="2"><face v1="0" v2="1" v3="2"/><face v1="3"/></faces>
  <geometry vertexcount="4"><vertexbuffer positions="true" texture_coords="1">
   <vertex><position x="0" y="0" z="0"/><texcoord u="0" v="0"/></vertex>
   <vertex><position x="1" y="0" z="0"/><texcoord u="1" v="0"/></vertex>
   <vertex><position x="0" y="1" z="0"/><texcoord u="0" v="1"/></vertex>
   <vertex><position x="1" y="1" z="0"/><texcoord u="1" v="1"/></vertex>
  </vertexbuffer></geometry></submesh></submeshes>
 <poses><pose target="submesh" index="0" name="up"><poseoffset index="2" x="0" y="0" z="4"/></pose>
 </poses>
 <animations><animation name="a" length="2"><tracks><track target="submesh" index="0" type="pose">
  <keyframes><keyframe time="0"><poseref poseindex="0" influence="0"/></keyframe>
  <keyframe time="2"><poseref poseindex="0" influence="1"/></keyframe></keyframes>
 </track></tracks></animation></animations></mesh>
"""


def test_ogre_strips_and_poses(tmp_path: Path) -> None:
    file = tmp_path / "a.mesh.xml"
    file.write_text(OGRE)
    (found,), _ = load_ogre(file)
    assert found.mesh.groups[0].material == "A"
    assert found.mesh.groups[0].indices.tolist() == [[0, 1, 2], [1, 3, 2]]
    np.testing.assert_array_equal(found.mesh.attributes["texCoord0"][3], [1, 1, 0, 1])
    poses = found.mesh.poses
    assert poses is not None
    assert poses.length == 2
    # a quarter of the way: a quarter of the offset, of vertex 2 alone
    moved = poses.offset(0.5)
    np.testing.assert_allclose(moved, [[0, 0, 0], [0, 0, 0], [0, 0, 1], [0, 0, 0]])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (('v1="3"', 'v1="9"'), "a face has vertex 9 of 4"),
        (('x="1" y="1"', 'x="one" y="1"'), "<position> has x='one', which is no number"),
        (("<mesh>", "<model>"), "mismatch|tag"),
        (('positions="true"', ""), "a geometry has no positions"),
    ],
)
def test_wrong_ogre_files(tmp_path: Path, change: tuple[str, str], message: str) -> None:
    file = tmp_path / "a.mesh.xml"
    file.write_text(OGRE.replace(*change, 1))
    with pytest.raises(ModelError, match=message):
        load_ogre(file)


def test_ogre_reads_no_other_file(tmp_path: Path) -> None:
    (tmp_path / "secret").write_text("4")
    file = tmp_path / "a.mesh.xml"
    entity = '<!DOCTYPE mesh [<!ENTITY x SYSTEM "secret">]>'
    file.write_text(entity + OGRE.replace('x="1" y="1" z="0"', 'x="&x;" y="1" z="0"'))
    with pytest.raises(ModelError):
        load_ogre(file)


def test_patch(tmp_path: Path) -> None:
    file = tmp_path / "a.patch"
    file.write_text("4\n1\ny\n1,2,3,4\n4\n0, 0, 0\n1, 0, 0\n0, 1, 0\n1, 1, 0.5\n")
    mesh = load_patch(file)
    assert mesh.primitive == "PATCHES"
    assert mesh.groups[0].indices.tolist() == [[0, 1, 2, 3]]
    np.testing.assert_array_equal(mesh.positions[3], [1, 1, 0.5, 1])
    file.write_text("4\n1\ny\n1,2,3,4\n4\n0, 0, 0\n")
    with pytest.raises(ModelError, match="ends early"):
        load_patch(file)


def test_terrain(folder: Folder) -> None:
    """A ramp of 0, 1, 2, 3 fifths along x: heights, and the slope's normal inside."""
    row = np.array([0, 51, 102, 153], np.uint8)
    folder.image("ramp.png", np.tile(row, (3, 1)))
    mesh = load_terrain(folder.path / "ramp.png", "Ground")
    np.testing.assert_allclose(mesh.positions[:4, 1], [0, 0.2, 0.4, 0.6], atol=1e-6)
    np.testing.assert_allclose(mesh.positions[0], [-2, 0, -1.5, 1])
    slope = np.array([-2 * 0.4, 4, 0]) / np.hypot(0.8, 4)
    np.testing.assert_allclose(mesh.attributes["normal"][5, :3], slope, atol=1e-6)
    np.testing.assert_allclose(mesh.attributes["normal"][4, :3], [0, 1, 0])  # at the border
    assert mesh.triangle_count == 3 * 2 * 2


def test_built_in_readers_and_others_register_by_the_same_call(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(READERS, ".dots", READERS[".obj"])
    del READERS[".dots"]  # restored, that is removed again, after the test

    @register_reader(".dots", ".obj")
    def read_dots(path: Path) -> Model:
        return [SceneObject(path.stem, Mesh({"position": np.zeros((2, 4), np.float32)}, []))], []

    (found,), _ = read_model(tmp_path / "two.DOTS", swap_yz=True)
    assert (found.name, found.mesh.vertex_count) == ("two", 2)
    with pytest.raises(ModelError, match="cannot be read"):
        read_model(tmp_path / "no.obj", swap_yz=False)  # the built-in reader stays
    with pytest.raises(ModelError, match=r"'\.x' is not supported \(supported: \.obj, \.nbo, "):
        read_model(tmp_path / "no.x", swap_yz=False)

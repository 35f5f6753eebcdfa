"""Primitives, transforms and cameras against their definitions."""

from __future__ import annotations

import numpy as np
import pytest

from nau_py.scene import primitives
from nau_py.scene.mesh import Mesh
from nau_py.scene.transforms import perspective, rotation
from nau_py.scene.world import World
from tests.conftest import Folder

WRAP = '<project name="P"><assets>{}</assets></project>'


@pytest.mark.parametrize(
    "mesh, area, volume",
    [
        (primitives.make_box("m"), 24.0, 8.0),
        (primitives.make_sphere(256, 256, "m"), 4 * np.pi, 4 / 3 * np.pi),
        (primitives.make_square("m"), 4.0, None),
        (primitives.make_grid(7, 3.0, "m"), 9.0, None),
    ],
)
def test_primitives_have_their_area_and_face_outwards(
    mesh: Mesh, area: float, volume: float | None
) -> None:
    p = mesh.positions[:, :3].astype(float)
    a, b, c = (p[mesh.groups[0].indices[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    assert np.linalg.norm(cross, axis=1).sum() / 2 == pytest.approx(area, rel=1e-3)
    if volume is not None:  # divergence theorem: negative if wound inwards
        assert np.einsum("ij,ij->i", a, cross).sum() / 6 == pytest.approx(volume, rel=1e-3)
    n = mesh.attributes["normal"][mesh.groups[0].indices[:, 0], :3]
    assert (np.einsum("ij,ij->i", n, cross) >= -1e-9).all()


def test_rotation_is_right_handed() -> None:
    turned = rotation((0, 0, 2, 90)) @ [1, 0, 0, 1]
    np.testing.assert_allclose(turned, [0, 1, 0, 1], atol=1e-15)
    np.testing.assert_array_equal(rotation((0, 0, 0, 90)), np.eye(4))


def test_perspective_maps_the_frustum_to_the_cube() -> None:
    matrix = perspective(90, 2.0, 1.0, 10.0)
    for point, expected in (((2, 1, -1), (1, 1, -1)), ((-20, -10, -10), (-1, -1, 1))):
        clip = matrix @ [*point, 1]
        np.testing.assert_allclose(clip[:3] / clip[3], expected, atol=1e-12)


@pytest.mark.parametrize(
    "tags, view",
    [
        ("<POSITION x=1 y=2 z=3/><LOOK_AT_POINT x=0 y=0 z=0/>", (-1, -2, -3)),
        ("<LOOK_AT_POINT x=0 y=0 z=-5/><POSITION x=1 y=2 z=3/>", (0, 0, -5)),
        ("<ZX_ANGLE value=0/>", (0, 0, 1)),
        ("<ZX_ANGLE value=1.5707963267948966/>", (1, 0, 0)),
    ],
)
def test_camera_tags_apply_in_order(folder: Folder, tags: str, view: tuple[float, ...]) -> None:
    folder.write("project.xml", WRAP.format(f"<cameras><camera name='C'>{tags}</camera></cameras>"))
    camera = World(folder.load(), (64, 64)).camera("C")
    np.testing.assert_allclose(camera.view, view, atol=1e-12)


def test_default_scenes_merge_and_bake(folder: Folder) -> None:
    folder.write(
        "project.xml",
        WRAP.format(
            "<scenes><scene name='S'><geometry name='a' type='BOX'><TRANSLATE x=5 y=0 z=0/>"
            "<SCALE x=2 y=1 z=1/></geometry><geometry name='b' type='BOX'/></scene>"
            "<scene name='T' type='Scene'><geometry name='c' type='BOX'><TRANSLATE x=5 y=0 z=0/>"
            "</geometry><geometry name='d' type='BOX'/><TRANSLATE x=0 y=1 z=0/></scene></scenes>"
        ),
    )
    world = World(folder.load(), (64, 64))
    (merged,) = world.scenes["S"]
    assert merged.mesh.triangle_count == 24
    assert merged.mesh.positions[:, 0].min() == -1
    assert merged.mesh.positions[:, 0].max() == 7
    first, second = world.scenes["T"]
    np.testing.assert_array_equal(first.matrix[:3, 3], [5, 1, 0])
    np.testing.assert_array_equal(second.matrix[:3, 3], [0, 1, 0])


def test_unitize_spans_the_cube(folder: Folder) -> None:
    folder.write("a.obj", "v 10 0 0\nv 14 0 0\nv 10 2 0\nf 1 2 3\n")
    folder.write(
        "project.xml",
        WRAP.format(
            "<scenes><scene name='S' param='UNITIZE'><file name='a.obj'/></scene></scenes>"
        ),
    )
    (item,) = World(folder.load(), (8, 8)).scenes["S"]
    points = item.mesh.positions[:, :3]
    np.testing.assert_allclose(points.min(axis=0), [-1, -0.5, 0], atol=1e-6)
    np.testing.assert_allclose(points.max(axis=0), [1, 0.5, 0], atol=1e-6)


def test_unitize_of_a_merged_scene_leaves_its_transform_alone(folder: Folder) -> None:
    """The scene is made of unit size, then moved: as the real Nau draws the barrel project."""
    folder.write("a.obj", "v 10 0 0\nv 14 0 0\nv 10 2 0\nf 1 2 3\n")
    folder.write(
        "project.xml",
        WRAP.format(
            "<scenes><scene name='S' param='UNITIZE'><file name='a.obj'/>"
            "<TRANSLATE x='0' y='1' z='0'/></scene></scenes>"
        ),
    )
    (item,) = World(folder.load(), (8, 8)).scenes["S"]
    points = (item.mesh.positions.astype(float) @ item.matrix.T)[:, :3]
    np.testing.assert_allclose(points.min(axis=0), [-1, 0.5, 0], atol=1e-6)
    np.testing.assert_allclose(points.max(axis=0), [1, 1.5, 0], atol=1e-6)


def test_vertices_that_are_not_finite_take_their_faces_along(folder: Folder) -> None:
    folder.write("a.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n")
    folder.write(
        "project.xml", WRAP.format("<scenes><scene name='S'><file name='a.obj'/></scene></scenes>")
    )
    world = World(folder.load(), (8, 8))
    assert world.scenes["S"][0].mesh.triangle_count == 1
    (found,) = world.diagnostics
    assert found.rule == "M003"
    assert "model 'a.obj': 1 vertices are not finite" in found.message


def test_first_material_definition_wins_and_maps_override(folder: Folder) -> None:
    for name, red in (("a", 1), ("b", 0.5)):
        folder.write(f"{name}.mtl", f"newmtl m\nKd {red} 0 0\n")
        folder.write(
            f"{name}.obj", f"mtllib {name}.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n"
        )
    folder.write(
        "l.mlib",
        "<materialLib name='L'><states><state name='s'><ORDER value=3/></state>"
        "</states><materials><material name='x'/></materials></materialLib>",
    )
    folder.write(
        "project.xml",
        "<project name='P'><assets><scenes><scene name='S'>"
        "<file name='a.obj'/><file name='b.obj'/></scene></scenes><materialLibs>"
        "<materialLib filename='l.mlib'/></materialLibs></assets><pipelines>"
        "<pipeline name='Q'><pass name='one'><injectionMaps><map toMaterial='*'>"
        "<state name='s' fromLibrary='L'/></map></injectionMaps></pass>"
        "<pass name='two'><materialMaps><map fromMaterial='m' toLibrary='L' "
        "toMaterial='x'/></materialMaps></pass></pipeline></pipelines></project>",
    )
    project = folder.load()
    world = World(project, (8, 8))
    one, two = (world.materials.for_pass(p, "Q") for p in project.pipelines[0].passes)
    injected, mapped = one["m"], two["m"]
    assert injected is not None
    assert mapped is not None
    assert injected.colours["DIFFUSE"] == (1.0, 0.0, 0.0, 1.0)
    assert (injected.library, injected.order) == ("Q#one", 3)
    assert (mapped.library, mapped.name) == ("L", "x")
    assert world.materials.get("__nau_material_lib", "m").order == 0  # type: ignore[union-attr]

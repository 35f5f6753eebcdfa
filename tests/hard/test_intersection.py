"""Hard cases 3 to 18: geometry, offsets, lights and cameras at their limits."""

from __future__ import annotations

import numpy as np
import pytest

import nau_py
from nau_py.raytrace.tracing.accelerator import Accelerator
from nau_py.raytrace.tracing.geometry import gather_triangles
from nau_py.scene.mesh import Group, Mesh, SceneObject, pad4
from tests.conftest import Folder
from tests.hard.test_geometry import geometry, surface
from tests.raytrace.studio import box, colour, picture, program, sphere, square, studio

TURN = '<ROTATE x="1" y="0" z="0" w="90" />'
WHITE = {"White": colour("DIFFUSE", 1.0, 1.0, 1.0, 1.0)}


def mesh(vertices: list[tuple[float, float, float]], faces: list[tuple[int, int, int]]) -> Mesh:
    points = pad4(np.array(vertices, float), 1.0)
    return Mesh({"position": points}, [Group("m", np.array(faces, np.uint32))])


def test_origin_1e7(folder: Folder) -> None:
    """A scene at 1e7 shows what it shows at 0: it is moved to the origin before Embree sees it."""
    pictures = []
    for x in (0.0, 1e7):
        project = studio(
            folder,
            square("wall", "Wall", [2, 1, 2], [x, 0, -1], TURN)
            + box("box", "White", [0.5, 0.5, 0.5], [x + 0.25, 0.25, 0.5]),
            WHITE | {"Wall": colour("EMISSION", 0.5, 0.25, 1.0, 1.0)},
            program("White", "direct"),
            lights='<light name="L"><DIRECTION x="-1" y="-1" z="-1" /></light>',
            camera=f'<POSITION x="{x}" y="0" z="4" />',
            size=(64, 64),
        )
        pictures.append(picture(project))
    # mesh positions are float32: at 1e7 the box lies on a grid of one unit
    assert (np.abs(pictures[0] - pictures[1]).max(axis=-1) > 1e-3).mean() < 0.25
    assert np.isfinite(pictures[1]).all()
    made = gather_triangles(
        [SceneObject("o", mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]), translated(1e7))]
    )
    np.testing.assert_array_equal(made.vertices, [[-0.5, -0.5, 0], [0.5, -0.5, 0], [-0.5, 0.5, 0]])
    np.testing.assert_array_equal(made.centre, [1e7 + 0.5, 0.5, 0])


def translated(x: float) -> np.ndarray:  # type: ignore[type-arg]
    matrix = np.eye(4)
    matrix[0, 3] = x
    return matrix


@pytest.mark.parametrize("cosine", [1e-3, 1e-5, 1e-7])
def test_grazing(cosine: float) -> None:
    """Fresnel tends to 1 within [0, 1]; a ray that leaves at such an angle meets nothing."""
    from nau_py.raytrace.kernels.shading.bsdf import evaluate_fresnel

    for eta in (1.5, 1 / 1.5, 1.0001):
        share, behind = evaluate_fresnel.py_func(cosine, eta)  # type: ignore[attr-defined]
        assert 0.0 <= share <= 1.0
        assert 0.0 <= behind <= 1.0
    assert evaluate_fresnel.py_func(cosine, 1.5)[0] > 1 - 10 * cosine  # type: ignore[attr-defined]
    plane = geometry(np.array([[-1, 0.1, -1], [1, -0.1, -1], [1, 0.2, 1]]), [[0, 1, 2]])
    rng = np.random.default_rng(3)
    u, v = rng.uniform(0, 0.5, (2, 50_000)).astype(np.float32)
    position, normal, bound = surface(plane, np.zeros(len(u), int), u, v)
    across = np.cross(normal, rng.standard_normal((len(u), 3)))
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    direction = (across + cosine * normal).astype(np.float32)
    from nau_py.raytrace.kernels.path.hit_arrays import spawn_rays

    origin, unit = np.empty((2, len(u), 3), np.float32)
    spawn_rays(position, normal, bound, direction, origin, unit)
    assert not Accelerator(plane).find_occluded(origin, unit).any()


def test_watertight_offset() -> None:
    """Embree's own case: a sphere about (148376, 1234, -223423), rays from inside: no miss."""
    from nau_py.scene import primitives

    ball = primitives.make_sphere(64, 32, "m")
    matrix = np.eye(4)
    matrix[:3, 3] = (148376, 1234, -223423)
    made = gather_triangles([SceneObject("o", ball, matrix)])
    rng = np.random.default_rng(1)
    direction = rng.standard_normal((200_000, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    origin = np.broadcast_to((matrix[:3, 3] - made.centre).astype(np.float32), direction.shape)
    found = Accelerator(made).intersect(origin, direction.astype(np.float32))
    assert (found.triangle >= 0).all()


def test_degenerate() -> None:
    """Faces without area are left out and counted with the first one's place; others stay."""
    made = gather_triangles(
        [
            SceneObject(
                "thing",
                mesh(
                    [(0, 0, 0), (1, 0, 0), (0, 1, 0), (2, 0, 0)],
                    [(0, 1, 2), (0, 1, 3), (1, 1, 2)],
                ),
            )
        ]
    )
    assert made.triangles.tolist() == [[0, 1, 2]]
    assert made.dropped.counts == {"without area": 2}
    assert made.dropped.first == {"without area": ("thing", 1)}


def test_nan_inf_vertex(folder: Folder) -> None:
    """A NaN vertex is reported with model and vertex; its faces are left out, the picture stays."""
    folder.mtl("m", {"Wall": {"Ke": "1 1 1"}})
    folder.write(
        "m.obj",
        "mtllib m.mtl\nusemtl Wall\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv nan 0 0\nf 1 2 3\nf 1 2 4\n",
    )
    project = studio(folder, '<file name="m.obj" />', {})
    renderer = nau_py.Renderer(project)
    found = renderer.render().targets["L::out"]
    assert np.isfinite(found).all()
    assert found[..., 0].max() == 1
    assert any("m.obj" in d.message and "not finite" in d.message for d in renderer.diagnostics)


def test_huge_coord() -> None:
    """Beyond 1.844e18 a face is left out; below, what is found is finite."""
    for scale, kept in ((1e12, 1), (1e18, 1), (1e19, 0)):
        made = gather_triangles(
            [SceneObject("o", mesh([(0, 0, 0), (scale, 0, 0), (0, scale, 0)], [(0, 1, 2)]))]
        )
        assert len(made.triangles) == kept
        assert made.dropped.counts == ({} if kept else {"too large": 1})
        if kept:
            direction = np.array([[0, 0, -1]], np.float32)
            origin = np.array([[scale / 4, scale / 4, scale]], np.float32)
            found = Accelerator(made).intersect(origin - made.centre.astype(np.float32), direction)
            assert (found.triangle == 0).all() or scale == 1e18  # its distance overflows
            assert np.isfinite(found.t).all()


def test_coplanar_duplicate() -> None:
    """Two faces in one place: the last one is there, however it is wound."""
    vertices = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    for second in ((0, 1, 2), (0, 2, 1), (1, 2, 0)):
        first = SceneObject("a", mesh(vertices, [(0, 1, 2)]))
        other = SceneObject("b", mesh(vertices, [second]))
        made = gather_triangles([first, other])
        assert len(made.triangles) == 1
        assert made.item.tolist() == [1]
        assert made.dropped.counts == {"the same as another": 1}


@pytest.mark.parametrize("gap", [1e-6, 1e-4])
def test_near_coplanar(folder: Folder, gap: float) -> None:
    """Two blended cards so close (unit size; twice the spawn offset is 7e-7): both count."""
    project = studio(
        folder,
        square("a", "A", [0.5, 1, 0.5], [0, 0, 0], TURN)
        + square("b", "B", [0.5, 1, 0.5], [0, 0, -gap], TURN),
        {name: colour("DIFFUSE", 0.0, 0.0, 0.0, 0.5) for name in "AB"},
        program("A", "emission", "transparency") + program("B", "emission", "transparency"),
        clear=(1, 1, 1),
        size=(16, 16),
        fov=15,
    )
    np.testing.assert_allclose(picture(project)[..., 0], 0.25, atol=1e-6)


def test_thin_wall(folder: Folder) -> None:
    """No light leaks through a wall of 1e-4 of the scene."""
    project = studio(
        folder,
        square("floor", "White", [5, 1, 5], [0, 0, 0])
        + box("wall", "White", [5e-4, 2, 5], [0, 1, 0])
        + square("roof", "White", [2.5, 1, 5], [2.5, 3, 0])
        + square("end", "White", [5, 1, 5], [0, 0, -5], TURN),
        WHITE,
        program("White", "direct"),
        lights='<light name="L"><POSITION x="-1" y="1" z="0" /><SHAPE value="POINT" /></light>',
        camera='<POSITION x="2" y="1" z="4" /><LOOK_AT_POINT x="1" y="0" z="0" />',
        size=(64, 64),
    )
    found = picture(project)
    # the right half of the picture lies behind the wall
    assert found[40:, 40:, 0].max() == 0


def test_on_light(folder: Folder) -> None:
    """A lamp that is a diffuse surface too: its own light is counted once, all finite."""
    project = studio(
        folder,
        square("lamp", "Lamp", [1, 1, 1], [0, 0, 0], TURN),
        {"Lamp": colour("EMISSION", 2.0, 2.0, 2.0, 1.0) + colour("DIFFUSE", 1.0, 1.0, 1.0, 1.0)},
        program("Lamp", "path"),
        size=(16, 16),
        fov=20,
        spp=16,
    )
    np.testing.assert_allclose(picture(project)[..., :3], 2.0)


@pytest.mark.parametrize("at", [(0.0, 0.0, 0.0), (0.0, 1e-20, 0.0), (0.0, 0.0, 3.0)])
def test_light_at_point_and_light_at_camera(folder: Folder, at: tuple[float, ...]) -> None:
    """A point light on the surface, next to it, or at the eye: finite, whatever the attenuation."""
    project = studio(
        folder,
        square("wall", "White", [9, 1, 9], [0, 0, 0], TURN),
        WHITE,
        program("White", "direct"),
        lights=f'<light name="L"><POSITION x="{at[0]}" y="{at[1]}" z="{at[2]}" />'
        '<SHAPE value="POINT" /><CONSTANT_ATT value="0" /><QUADRATIC_ATT value="1" /></light>',
        size=(17, 17),
    )
    frame = nau_py.Renderer(project).render()
    assert np.isfinite(frame.targets["L::out"]).all()
    assert frame.report["nonfinite"] == 0


@pytest.mark.parametrize("size", [0.0, 1e-30])
def test_zero_area_light(folder: Folder, size: float) -> None:
    """A lamp without area gives no light, and no division by zero."""
    project = studio(
        folder,
        square("floor", "White", [9, 1, 9], [0, -1, 0])
        + square("lamp", "Lamp", [size, 1, size], [0, 2, 0]),
        WHITE | {"Lamp": colour("EMISSION", 9.0, 9.0, 9.0, 1.0)},
        program("White", "path") + program("Lamp", "path"),
        size=(16, 16),
        spp=4,
    )
    frame = nau_py.Renderer(project).render()
    found = frame.targets["L::out"]
    assert np.isfinite(found).all()
    assert found[..., :3].max() < 1e-6


def test_camera_inside_geometry(folder: Folder) -> None:
    """An eye inside a glass ball in a white world sees white: what it leaves was its medium."""
    project = studio(
        folder,
        sphere("ball", "Glass", 1.0, [0, 0, 0], 64),
        {"Glass": colour("INDEX_OF_REFRACTION", 1.5)},
        program("Glass", "dielectric"),
        camera='<POSITION x="0.2" y="0.1" z="0.3" />',
        clear=(1, 1, 1),
        size=(24, 24),
        spp=16,
        depth=30,
        near=0.001,
    )
    np.testing.assert_allclose(picture(project)[..., 0], 1.0, atol=0.02)


@pytest.mark.parametrize("near", [0.0, -1.0])
def test_near_zero(folder: Folder, near: float) -> None:
    """NEAR at or below 0 is an error at its place, with the legal range."""
    project = studio(folder, square("a", "White", [1, 1, 1], [0, 0, 0]), WHITE, near=near)
    found = [d for d in nau_py.lint(project) if d.rule == "Q001"]
    assert [d.severity for d in found] == ["error"]
    assert f"NEAR of camera 'C' is {near:g}; it must be greater than 0" in found[0].message

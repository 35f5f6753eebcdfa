"""Hard cases of ../shared/hard-cases.md that this version meets, under their names."""

from __future__ import annotations

import numpy as np
import pytest

import nau_py
from nau_py.raytrace.kernels.core.tables import SCENE
from nau_py.raytrace.kernels.path.hit_arrays import compute_surface_points, spawn_rays
from nau_py.raytrace.tracing.accelerator import Accelerator
from nau_py.raytrace.tracing.arrays import F32
from nau_py.raytrace.tracing.geometry import RayGeometry
from tests.conftest import LAMBERT, Folder, RayProject

RAYS = 100_000


def geometry(vertices: np.ndarray, triangles: list[list[int]]) -> RayGeometry:  # type: ignore[type-arg]
    return RayGeometry(
        vertices.astype(np.float32),
        np.array(triangles, np.int32),
        np.zeros(len(triangles), np.int32),
        ["m"],
    )


def surface(
    made: RayGeometry,
    triangle: np.ndarray,
    u: F32,
    v: F32,  # type: ignore[type-arg]
) -> tuple[F32, F32, F32]:
    """Positions, face normals and error bounds at barycentrics."""
    record = np.zeros(1, SCENE.dtype)
    record["vertices"], record["triangles"] = made.vertices.ctypes.data, made.triangles.ctypes.data
    position, normal = np.empty((2, len(u), 3), np.float32)
    bound = np.empty(len(u), np.float32)
    compute_surface_points(record, triangle.astype(np.int32), u, v, position, normal, bound)
    return position, normal, bound


def normalize(v: np.ndarray) -> np.ndarray:  # type: ignore[type-arg]
    return np.asarray(v / np.linalg.norm(v, axis=1, keepdims=True))


def self_hits(made: RayGeometry, seed: int) -> tuple[int, F32]:
    """Rays that leave random points of random triangles and meet the same plane again; offsets."""
    rng = np.random.default_rng(seed)
    chosen = rng.integers(0, len(made.triangles), RAYS)
    u, v = rng.random((2, RAYS)).astype(np.float32)
    over = u + v > 1
    u, v = np.where(over, 1 - u, u), np.where(over, 1 - v, v)
    position, normal, bound = surface(made, chosen, u, v)
    direction = normalize(rng.standard_normal((RAYS, 3))).astype(np.float32)
    side = np.sign((direction * normal).sum(axis=1))
    direction *= np.where(side == 0, 1, side)[:, None]
    origin, unit = np.empty((2, RAYS, 3), np.float32)
    spawn_rays(position, normal, bound, direction, origin, unit)
    hits = Accelerator(made).intersect(origin, direction).triangle >= 0
    return int(hits.sum()), np.linalg.norm(origin - position, axis=1).astype(np.float32)


PLANE = np.array([[-1, 0.1, -1], [1, -0.1, -1], [1, 0.2, 1], [-1, 0.3, 1]])


@pytest.mark.parametrize("scale", [1e-6, 1e-3, 1.0, 1e3, 1e6])
def test_self_hit_scale(scale: float) -> None:
    hits, offset = self_hits(geometry(PLANE * scale, [[0, 1, 2]]), 1)
    assert hits == 0
    assert offset.max() <= 1e-5 * scale


@pytest.mark.parametrize("distance", [1e2, 1e4, 1e6])
def test_self_hit_far(distance: float) -> None:
    hits, offset = self_hits(geometry(PLANE + distance, [[0, 1, 2]]), 2)
    assert hits == 0
    assert offset.max() <= 8 * np.spacing(np.float32(distance))


def test_axis_aligned_plane() -> None:
    """The plane z = 0, hit exactly: no self-hit."""
    square = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], float)
    assert self_hits(geometry(square, [[0, 1, 2], [0, 2, 3]]), 3)[0] == 0


def test_shared_edge_vertex() -> None:
    """Rays at edges and vertices of a closed mesh miss nothing."""
    from nau_py.scene import primitives

    mesh = primitives.make_sphere(24, 16, "m")
    made = geometry(mesh.positions[:, :3], mesh.groups[0].indices.tolist())
    rng = np.random.default_rng(4)
    edges = made.triangles[:, [0, 1]][rng.integers(0, len(made.triangles), RAYS)]
    weight = rng.random((RAYS, 1))
    weight[: RAYS // 2] = 0  # the first half aims at vertices
    aim = made.vertices[edges[:, 0]] * (1 - weight) + made.vertices[edges[:, 1]] * weight
    origin = np.zeros((RAYS, 3), np.float32)
    direction = normalize(aim).astype(np.float32)
    assert (Accelerator(made).intersect(origin, direction).triangle >= 0).all()


def test_sliver() -> None:
    """Needles of aspect 1e6 and three nearly collinear points: hit or miss, never NaN."""
    vertices = np.array(
        [
            [0, 0, 0],
            [1, 0, 0],
            [0.5, 1e-6, 0],
            [-1113.45459, -79.049614, -56.2431908],
            [-1113.45459, -87.0922699, -56.2431908],
            [-1113.45459, -79.2090149, -56.2431908],
        ]
    )
    u = np.full(2, 0.3, np.float32)
    values = surface(geometry(vertices, [[0, 1, 2], [3, 4, 5]]), np.arange(2), u, u)
    assert all(np.isfinite(a).all() for a in values)


def test_nonfinite_ray(folder: Folder, ray_project: RayProject) -> None:
    """NaN, infinite and null directions are filtered before Embree, counted, and bring 0."""
    folder.mtl("scene", {"Wall": {"Ke": "1 1 1"}})
    folder.obj("scene", [("Wall", [(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)])])
    folder.write(
        "prog.py",
        (
            "import numpy as np\n\n\n"
            "def camera(launch):\n"
            "    origin, direction = launch.camera_rays(launch.x + 0.5, launch.y + 0.5)\n"
            "    direction[launch.x == 0] = np.nan\n"
            "    direction[launch.x == 1] = np.inf\n"
            "    direction[launch.x == 2] = 0\n"
            "    return launch.trace('Radiance', origin, direction)\n"
        ),
    )
    programs = LAMBERT.replace("lambert", "emission")
    project = ray_project(programs)
    text = (folder.path / "project.xml").read_text()
    folder.write(
        "project.xml",
        text.replace(
            '<rayGen file="builtin" proc="pinhole" />', '<rayGen file="prog.py" proc="camera" />'
        ),
    )
    project = folder.load()
    frame = nau_py.Renderer(project).render()
    out = frame.targets["L::out"]
    np.testing.assert_array_equal(out[:, :3], 0)
    np.testing.assert_array_equal(out[:, 3:], 1)
    assert frame.report["nonfinite"] == 3 * 48
    assert frame.report["totals"]["rays"] == {"primary": 61 * 48}


def test_alpha_stack_100(folder: Folder, ray_project: RayProject) -> None:
    """Rays pass a hundred transparent cards and see the wall: no layer stops or doubles them."""
    texels = np.zeros((2, 2, 4), np.uint8)
    folder.image("clear.png", texels)
    folder.mtl("scene", {"Card": {"map_Kd": "clear.png"}, "Wall": {"Ke": "0 1 0"}})
    cards = [
        ("Card", [(-9, -9, -k * 1e-3), (9, -9, -k * 1e-3), (9, 9, -k * 1e-3), (-9, 9, -k * 1e-3)])
        for k in range(100)
    ]
    folder.obj("scene", [*cards, ("Wall", [(-9, -9, -2), (9, -9, -2), (9, 9, -2), (-9, 9, -2)])])
    programs = (
        '<rtDefaultMaterial><rayType name="R"><rtProgram type="CLOSEST_HIT" file="builtin" '
        'proc="emission"/><rtProgram type="ANY_HIT" file="builtin" proc="alpha_test"/>'
        '</rayType></rtDefaultMaterial><rtMaterialMap><rtMap to="Wall"><rayType name="R">'
        '<rtProgram type="CLOSEST_HIT" file="builtin" proc="emission"/></rayType></rtMap>'
        "</rtMaterialMap>"
    )
    frame = nau_py.Renderer(ray_project(programs, size=(16, 12))).render()
    np.testing.assert_array_equal(frame.targets["L::out"][..., 1], 1)
    rays = frame.report["totals"]["rays"]
    assert rays == {"primary": 192, "continuation": 100 * 192}


def test_mirror_corridor(folder: Folder, ray_project: RayProject) -> None:
    """Between two mirrors of reflectance 0.9 the depth limit gives 0, one light gives 0.9^n."""
    folder.mtl(
        "scene", {"Front": {"Ks": "0.9 0.9 0.9"}, "Back": {"Ke": "1 1 1", "Ks": "0.9 0.9 0.9"}}
    )
    folder.obj(
        "scene",
        [
            ("Front", [(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)]),
            ("Back", [(-9, -9, 4), (-9, 9, 4), (9, 9, 4), (9, -9, 4)]),
        ],
    )
    programs = (
        '<rtDefaultMaterial><rayType name="R"><rtProgram type="CLOSEST_HIT" file="builtin" '
        'proc="mirror"/></rayType></rtDefaultMaterial><rtMaterialMap><rtMap to="Back">'
        '<rayType name="R"><rtProgram type="CLOSEST_HIT" file="builtin" proc="{}"/></rayType>'
        "</rtMap></rtMaterialMap>"
    )
    lit = nau_py.Renderer(ray_project(programs.format("emission"), size=(8, 8))).render()
    np.testing.assert_allclose(lit.targets["L::out"][..., 0], 0.9, rtol=1e-6)
    dark = nau_py.Renderer(ray_project(programs.format("mirror"), size=(8, 8))).render()
    np.testing.assert_array_equal(dark.targets["L::out"][..., 0], 0)
    assert dark.report["totals"]["rays"] == {"primary": 64, "reflection": 2 * 64}  # MAX_DEPTH 3


MASKED = """\
<pass name="mask" class="quad"><renderTarget name="select" fromLibrary="M" />
<material name="m" fromLibrary="M" /></pass>
"""


@pytest.mark.parametrize(
    "value, traced",
    [
        ("0.0", 0),
        ("1.0", 64 * 48),
        ("0.5", 64 * 48),
        ("gl_FragCoord.x < 10.0 ? 1.0 : 0.0", 10 * 48),
    ],
)
def test_mask_empty_and_mask_full(
    folder: Folder, ray_project: RayProject, value: str, traced: int
) -> None:
    """An empty mask costs no ray; a full one gives the pure ray image, to the bit."""
    folder.mtl("scene", {"Wall": {"Kd": "1 1 1"}})
    folder.obj("scene", [("Wall", [(-2, -1, 0), (1, -1, 0), (1, 1, 0), (-2, 1, 0)])])
    pure = nau_py.Renderer(ray_project(spp=4)).render()
    folder.write(
        "m.vert", "#version 330\nin vec4 position;\nvoid main() { gl_Position = position; }\n"
    )
    folder.write(
        "m.frag", f"#version 330\nout vec4 c;\nvoid main() {{ c = vec4(0, 0, 0, {value}); }}\n"
    )
    folder.write(
        "m.mlib",
        '<materialLib name="M"><renderTargets><renderTarget name="select">'
        '<SIZE width="64" height="48"/><colors><color name="mask" internalFormat="RGBA32F"/>'
        '</colors></renderTarget></renderTargets><shaders><shader name="s" vs="m.vert" '
        'ps="m.frag"/></shaders><materials><material name="m"><shader name="s"/></material>'
        "</materials></materialLib>",
    )
    text = (folder.path / "project.xml").read_text()
    text = text.replace("</materialLibs>", '<materialLib filename="m.mlib" /></materialLibs>')
    text = text.replace('<pass name="trace"', MASKED + '<pass name="trace"')
    text = text.replace(
        "<rtEntryPoint>", '<rtInput><buffer var="mask" texture="M::mask" /></rtInput><rtEntryPoint>'
    )
    folder.write("project.xml", text)
    frame = nau_py.Renderer(folder.load()).render()
    out = frame.targets["L::out"]
    trace = frame.report["frames"][0]["passes"][1]
    assert trace["pixels"] == traced
    assert trace["rays"].get("primary", 0) == traced * 4
    columns = traced // 48
    np.testing.assert_array_equal(out[:, :columns], pure.targets["L::out"][:, :columns])
    np.testing.assert_array_equal(
        out[:, columns:], np.broadcast_to([0, 0, 0.25, 0], (48, 64 - columns, 4))
    )

"""The two hybrid demos: what they trace, where, and that ray and raster agree."""

from __future__ import annotations

import runpy
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import nau_py
from nau_py.raytrace.tracing.accelerator import Accelerator
from nau_py.raytrace.tracing.camera_rays import make_camera_rays
from nau_py.raytrace.tracing.geometry import gather_triangles
from nau_py.scene.world import World
from tests.conftest import PROJECTS

SIZE = (192, 192)


def passes(frame: nau_py.Frame) -> dict[str, dict[str, Any]]:
    return {p["name"]: p for p in frame.report["frames"][0]["passes"]}


def mask(frame: nau_py.Frame) -> NDArray[np.bool_]:
    return np.asarray(frame.targets["Hybrid::position"][..., 3] > 0)


@pytest.mark.parametrize("name", ["half", "selective"])
def test_yaml_and_xml_give_the_same_picture(name: str, request: pytest.FixtureRequest) -> None:
    project = nau_py.load(PROJECTS / name / "project.yaml")
    yaml = nau_py.Renderer(project, size=SIZE).render()
    xml = request.getfixturevalue(name)
    np.testing.assert_array_equal(yaml.image, xml.image)
    for target, values in xml.targets.items():
        np.testing.assert_array_equal(yaml.targets[target], values)


def test_selective_traces_only_masked_pixels(selective: nau_py.Frame) -> None:
    """16 primary rays a masked pixel, none elsewhere."""
    traced = passes(selective)["trace"]
    count = int(mask(selective).sum())
    assert 0.02 < count / mask(selective).size < 0.3
    assert traced["pixels"] == count
    assert traced["rays"]["primary"] == count * 16
    assert traced["rays_avoided"] == (mask(selective).size - count) * 16
    assert 0 < traced["est_error"] < 0.1


def test_selective_leaves_the_rest_rasterised(selective: nau_py.Frame) -> None:
    outside = ~mask(selective)
    raster = selective.targets["Hybrid::color"]
    np.testing.assert_array_equal(selective.image[outside][:, :3], raster[outside][:, :3])
    clear = np.array([0.62, 0.77, 0.93, 0], np.float32)
    radiance = selective.targets["Hybrid::radiance"]
    np.testing.assert_array_equal(radiance[outside], np.tile(clear, (int(outside.sum()), 1)))


def test_no_seam_of_black_at_mask_borders(selective: nau_py.Frame) -> None:
    """Masked pixels are rasterised black; none of that black may reach the picture."""
    inside = mask(selective)
    raster = selective.targets["Hybrid::color"][inside][:, :3]
    assert (raster == 0).all()
    assert (selective.image[inside][:, :3].max(axis=1) > 0).all()


def materials_seen(name: str) -> NDArray[np.str_]:
    """The material that the ray through each pixel centre hits first, or ``sky``."""
    world = World(nau_py.load(PROJECTS / name / "project.xml"), SIZE)
    geometry = gather_triangles(world.objects(["Plaza"]))
    x, y = np.meshgrid(np.arange(SIZE[0]) + 0.5, np.arange(SIZE[1])[::-1] + 0.5)
    rays = make_camera_rays(world.camera("Eye"), world.viewport("Window"))
    found = Accelerator(geometry).intersect(
        *rays(x.reshape(-1).astype(np.float32), y.reshape(-1).astype(np.float32))
    )
    names = np.array([*geometry.materials, "sky"])
    index = np.where(found.triangle >= 0, geometry.material[found.triangle], len(names) - 1)
    return names[index].reshape(x.shape)


def test_materials_behind_the_mask(selective: nau_py.Frame) -> None:
    """The mask is exactly where the first triangle hit belongs to glass or a grille."""
    chosen = np.isin(materials_seen("selective"), ["Vidro", "GradeVaranda", "GradePortao"])
    # back faces are culled by the rasteriser only, and edges may fall either way
    assert (chosen != mask(selective)).mean() < 0.005


@pytest.mark.parametrize("name", ["half", "selective"])
def test_ray_and_raster_agree(name: str, request: pytest.FixtureRequest) -> None:
    """In a 3 x 3 neighbourhood of one triangle, both hit the same point to 1e-4 of the scene's
    size."""
    frame: nau_py.Frame = request.getfixturevalue(name)
    project = nau_py.load(PROJECTS / name / "project.xml")
    world = World(project, SIZE)
    geometry = gather_triangles(world.objects(["Plaza"]))
    x, y = np.meshgrid(np.arange(SIZE[0]) + 0.5, np.arange(SIZE[1])[::-1] + 0.5)
    rays = make_camera_rays(world.camera("Eye"), world.viewport("Window"))
    origin, direction = rays(x.reshape(-1).astype(np.float32), y.reshape(-1).astype(np.float32))
    found = Accelerator(geometry).intersect(origin, direction)
    triangle = found.triangle.reshape(x.shape)
    same = triangle >= 0
    for dy in (-1, 0, 1):
        for dx in (-1, 0, 1):
            same &= np.roll(triangle, (dy, dx), (0, 1)) == triangle
    same[[0, -1]] = same[:, [0, -1]] = False
    t = np.where(found.triangle >= 0, found.t, 0)
    points = (origin + direction * t[:, None]).reshape(*x.shape, 3)
    raster = frame.targets["Hybrid::position"]
    # the rasteriser culls faces that are seen from behind
    corners = geometry.vertices[geometry.triangles[found.triangle]]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    facing = (np.einsum("ij,ij->i", normal, direction) < 0).reshape(x.shape)
    checked = same & facing
    size = float(np.ptp(geometry.vertices, axis=0).max())
    distance = np.linalg.norm(points - raster[..., :3], axis=-1)[checked]
    assert checked.sum() > 5000
    assert distance.max() < 1e-4 * size


def test_half_is_traced_below_the_line_only(half: nau_py.Frame) -> None:
    drawn = mask(half)
    assert not drawn[: SIZE[1] // 2].any()
    assert drawn[SIZE[1] // 2 :].mean() > 0.95
    rays = passes(half)["trace"]["rays"]
    assert rays["primary"] == int(drawn.sum())
    assert rays["reflection"] > 100


def test_half_reflects_below_the_line_only(half: nau_py.Frame) -> None:
    """Rasterised glass is one dark colour; traced glass shows the square."""
    glass = materials_seen("half") == "Vidro"
    for step in (-1, 1):
        glass &= np.roll(glass, step, 0) & np.roll(glass, step, 1)
    upper, lower = glass.copy(), glass.copy()
    upper[SIZE[1] // 2 :] = False
    lower[: SIZE[1] // 2] = False
    assert upper.sum() > 50
    assert lower.sum() > 50
    assert half.image[upper].std(axis=0).max() < 2.0
    assert half.image[lower].std(axis=0).max() > 8.0


def test_raster_pipelines_trace_nothing() -> None:
    for name in ("half", "selective"):
        project = nau_py.load(PROJECTS / name / "project.xml")
        frame = nau_py.Renderer(project, "Raster", size=(64, 64)).render()
        assert frame.report["totals"]["rays"] == {}
        assert len(np.unique(frame.image.reshape(-1, 4), axis=0)) > 200


@pytest.mark.parametrize("options", [{"threads": 1}, {"threads": 4, "tile": 1024}, {"tile": 10**7}])
def test_the_same_picture_whatever_threads_and_tiles(
    options: dict[str, int], selective: nau_py.Frame
) -> None:
    project = nau_py.load(PROJECTS / "selective" / "project.xml")
    frame = nau_py.Renderer(project, size=SIZE, options=nau_py.RunOptions(**options)).render()  # type: ignore[arg-type]
    np.testing.assert_array_equal(
        frame.targets["Hybrid::radiance"], selective.targets["Hybrid::radiance"]
    )
    error = passes(frame)["trace"]["est_error"]
    assert error == passes(selective)["trace"]["est_error"]


def test_another_seed_is_another_picture_of_the_same_scene(selective: nau_py.Frame) -> None:
    project = nau_py.load(PROJECTS / "selective" / "project.xml")
    other = nau_py.Renderer(project, size=SIZE, options=nau_py.RunOptions(seed=1)).render()
    a, b = other.targets["Hybrid::radiance"], selective.targets["Hybrid::radiance"]
    chosen = mask(selective)
    assert (a[chosen] != b[chosen]).any()
    # each colour is off by est_error, so their difference by the square root of two of it
    expected = np.sqrt(2) * passes(selective)["trace"]["est_error"]
    rms = np.sqrt(((a[chosen][:, :3] - b[chosen][:, :3]) ** 2).mean())
    assert rms < 1.3 * expected


def test_the_twin_that_traces_everything_agrees_inside_the_mask(selective: nau_py.Frame) -> None:
    """Samples are keyed by pixel: what the mask selects has the same bits, so the same error."""
    project = nau_py.load(PROJECTS / "selective" / "full.xml")
    full = nau_py.Renderer(project, size=SIZE).render().targets["Hybrid::radiance"]
    chosen = mask(selective)
    np.testing.assert_array_equal(full[chosen], selective.targets["Hybrid::radiance"][chosen])


class Camera:
    """Launch that a ray generation program receives; ``trace`` returns the image points."""

    def __init__(self, samples: int) -> None:
        self.samples = samples
        self.sample = np.arange(samples * 4000) % samples
        self.x = self.y = np.zeros(len(self.sample))
        self._random = np.random.default_rng(samples)

    def __len__(self) -> int:
        return len(self.sample)

    def random(self, dimension: int) -> NDArray[Any]:
        return self._random.random(len(self))

    def camera_rays(self, x: NDArray[Any], y: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
        return x, y

    def trace(self, name: str, x: NDArray[Any], y: NDArray[Any]) -> tuple[NDArray[Any], ...]:
        return x, y


@pytest.mark.parametrize("samples", [1, 2, 8, 11, 13, 16])
@pytest.mark.parametrize("file", ["selective/programs/hybrid.py", "course/08_anti_aliasing.py"])
def test_samples_fill_the_pixel(file: str, samples: int) -> None:
    """Their mean is the middle of the pixel for numbers without a grid, too: nau-cost showed a bias
    at 8, 11 and 13."""
    names: dict[str, Any] = runpy.run_path(str(PROJECTS / file))
    program = names["pinhole_camera" if "pinhole_camera" in names else "camera"]
    for values in program(Camera(samples)):
        assert values.min() >= 0
        assert values.max() <= 1
        assert abs(values.mean() - 0.5) < 5 * 0.29 / np.sqrt(len(values))

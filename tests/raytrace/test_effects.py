"""Each effect against an answer from outside: analytic, or float64 NumPy of another method."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import nau_py
from tests.conftest import PROJECTS, ROOT, Folder, pixel_rays
from tests.raytrace.studio import box, colour, picture, program, sphere, square, studio

WHITE = (1.0, 1.0, 1.0)


@pytest.mark.parametrize("roughness", [0.2, 0.5, 0.8])  # the extremes: tests/hard
def test_glossy_white_furnace(folder: Folder, roughness: float) -> None:
    """SPECULAR 1 in a white world shows 1: no energy is lost to masking or gained."""
    material = colour("SPECULAR", 1.0, 1.0, 1.0, 1.0) + colour("ROUGHNESS", roughness)
    project = studio(
        folder,
        sphere("ball", "Ball", 1.0, [0, 0, 0], 64),
        {"Ball": material},
        program("Ball", "glossy"),
        camera='<POSITION x="0" y="0" z="2.2" />',
        size=(24, 24),
        spp=64,
        fov=40,
        clear=WHITE,
    )
    found = picture(project)[..., 0]
    assert np.isfinite(found).all()
    assert found.mean() == pytest.approx(1.0, abs=0.01)


def test_glossy_keeps_its_colour(folder: Folder) -> None:
    """A rough surface of reflectance 0.5 keeps 0.25 to 0.5 of white light: what is scattered twice
    is coloured twice."""
    material = colour("SPECULAR", 0.5, 0.5, 0.5, 1.0) + colour("ROUGHNESS", 0.9)
    project = studio(
        folder,
        square("floor", "Floor", [9, 1, 9], [0, -1, 0]),
        {"Floor": material},
        program("Floor", "glossy"),
        camera='<POSITION x="0" y="3" z="0" /><VIEW x="0" y="-1" z="0" /><UP x="0" y="0" z="-1" />',
        size=(16, 16),
        spp=64,
        clear=WHITE,
    )
    assert 0.25 < picture(project)[..., 0].mean() < 0.5


@pytest.mark.parametrize("shape", ["box", "sphere"])
def test_glass_white_furnace(folder: Folder, shape: str) -> None:
    """Clear glass in a white world is not seen: reflection and refraction add up to one."""
    solid = (
        box("solid", "Glass", [1, 1, 1], [0, 0, 0])
        if shape == "box"
        else sphere("solid", "Glass", 1.0, [0, 0, 0], 64)
    )
    project = studio(
        folder,
        solid,
        {"Glass": colour("INDEX_OF_REFRACTION", 1.5)},
        program("Glass", "dielectric"),
        camera='<POSITION x="1.5" y="2" z="2.5" /><LOOK_AT_POINT x="0" y="0" z="0" />',
        size=(24, 24),
        spp=16,
        depth=30,
        clear=WHITE,
    )
    found = picture(project)[..., 0]
    np.testing.assert_allclose(found, 1.0, atol=0.05)  # light caught inside ends at depth 30
    assert found.mean() == pytest.approx(1.0, abs=1e-3)


def test_slab_at_normal_incidence(folder: Folder) -> None:
    """A slab sums its inner reflections: T = (1-R)² a / (1 - R² a²), a = exp(-absorption d)."""
    absorption, thickness = 0.7, 0.4
    project = studio(
        folder,
        box("slab", "Glass", [9, 9, thickness / 2], [0, 0, 0])
        + square("wall", "Wall", [9, 1, 9], [0, 0, -3], '<ROTATE x="1" y="0" z="0" w="90" />'),
        {
            "Glass": colour("INDEX_OF_REFRACTION", 1.5)
            + colour("ABSORPTION", absorption, 0.0, 0.0, 1.0),
            "Wall": colour("EMISSION", 1.0, 1.0, 1.0, 1.0),
        },
        program("Glass", "dielectric"),
        camera='<POSITION x="0" y="0" z="500" />',
        fov=0.11,
        size=(8, 8),
        depth=20,
    )
    found = picture(project)[..., :3].mean(axis=(0, 1))
    r = ((1.5 - 1) / (1.5 + 1)) ** 2
    expected = [
        (1 - r) ** 2 * a / (1 - r**2 * a**2) for a in (np.exp(-absorption * thickness), 1.0, 1.0)
    ]
    np.testing.assert_allclose(found, expected, atol=2e-4)


def through_sphere(
    origin: np.ndarray,
    direction: np.ndarray,
    radius: float,
    eta: float,  # type: ignore[type-arg]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:  # type: ignore[type-arg]
    """Return the rays that meet a sphere about 0, and the points and directions in which they leave
    it, float64, by Snell's law."""
    d = direction / np.linalg.norm(direction, axis=-1, keepdims=True)
    b = (origin * d).sum(axis=-1)
    disc = b**2 - (origin**2).sum(axis=-1) + radius**2
    meets = disc > 0
    p = origin + d * (-b - np.sqrt(np.maximum(disc, 0)))[..., None]

    def refract(d: np.ndarray, n: np.ndarray, k: float) -> np.ndarray:  # type: ignore[type-arg]
        cosine = -(d * n).sum(axis=-1, keepdims=True)
        sine2 = k**2 * (1 - cosine**2)
        return np.asarray(k * d + (k * cosine - np.sqrt(np.maximum(1 - sine2, 0))) * n)

    inside = refract(d, p / radius, 1 / eta)
    q = p - 2 * (p * inside).sum(axis=-1, keepdims=True) * inside
    return meets, q, refract(inside, -q / radius, eta)


def test_image_through_a_glass_sphere(folder: Folder) -> None:
    """The refracted image of a wall with a bright half, against Snell on the exact sphere."""
    size = (64, 64)
    wall = '<ROTATE x="1" y="0" z="0" w="90" />'
    project = studio(
        folder,
        sphere("ball", "Glass", 1.0, [0, 0, 0], 512)
        + square("left", "Red", [50, 1, 100], [-50, 0, -4], wall)
        + square("right", "Green", [50, 1, 100], [50, 0, -4], wall),
        {
            "Glass": colour("INDEX_OF_REFRACTION", 1.5),
            "Red": colour("EMISSION", 1.0, 0.0, 0.0, 1.0),
            "Green": colour("EMISSION", 0.0, 1.0, 0.0, 1.0),
        },
        program("Glass", "dielectric"),
        camera='<POSITION x="0.3" y="0.1" z="5" />',
        size=size,
        fov=30,
        depth=3,
    )
    found = picture(project)
    origin, direction = pixel_rays(size, (0.3, 0.1, 5), 30)
    meets, q, out = through_sphere(origin, direction, 1.0, 1.5)
    with np.errstate(divide="ignore", invalid="ignore"):
        x = q[..., 0] + out[..., 0] / out[..., 2] * (-4 - q[..., 2])
    # not at the rim, where the reflection outshines what is refracted
    sees_wall = meets & (out[..., 2] < -0.6) & (np.abs(x) > 0.05)
    red = found[..., 0] > found[..., 1]
    assert sees_wall.sum() > 500
    assert (red == (x < 0))[sees_wall].mean() > 0.995


def test_nested_dielectric(folder: Folder) -> None:
    """Water about glass, overlapping: the one of higher priority is there, in either order."""
    water = colour("INDEX_OF_REFRACTION", 1.33) + colour("PRIORITY", 1)
    glass = colour("INDEX_OF_REFRACTION", 1.5) + colour("PRIORITY", 2)
    wall = square("wall", "Wall", [9, 1, 9], [0, 0, -3], '<ROTATE x="1" y="0" z="0" w="90" />')
    # water reaches 0.01 into the glass: its surface inside must not be seen
    project = studio(
        folder,
        box("water", "Water", [5, 5, 0.255], [0, 0, 0.255])
        + box("glass", "Glass", [5, 5, 0.25], [0, 0, -0.24])
        + wall,
        {"Water": water, "Glass": glass, "Wall": colour("EMISSION", 1.0, 1.0, 1.0, 1.0)},
        program("Water", "dielectric") + program("Glass", "dielectric"),
        camera='<POSITION x="0" y="0" z="500" />',
        fov=0.11,
        size=(4, 4),
        spp=64,
        depth=30,
    )
    found = picture(project)[..., 0].mean()

    def r(a: float, b: float) -> float:
        return ((a - b) / (a + b)) ** 2

    # incoherent stack of three interfaces, by adding layers (Stokes)
    def add(t1: float, r1: float, r1b: float, t2: float, r2: float) -> tuple[float, float]:
        return t1 * t2 / (1 - r1b * r2), r1 + t1**2 * r2 / (1 - r1b * r2)

    a, b, c = r(1, 1.33), r(1.33, 1.5), r(1.5, 1)
    t, back = add(1 - b, b, b, 1 - c, c)
    total, _ = add(1 - a, a, a, t, back)
    assert found == pytest.approx(total, abs=3e-3)


def test_alpha_stack(folder: Folder) -> None:
    """Five cards of three opacities: transmittance is the product of 1 - alpha, blended exactly,
    by chance on average, and for shadow rays as well."""
    alphas = [0.5, 0.01, 0.3, 0.25, 0.1]
    expected = float(np.prod([1 - a for a in alphas]))
    turn = '<ROTATE x="1" y="0" z="0" w="90" />'
    cards = "".join(
        square(f"card{k}", f"Card{k}", [9, 1, 9], [0, 0, -0.1 * k], turn) for k in range(5)
    )
    wall = square("wall", "Wall", [9, 1, 9], [0, 0, -3], turn)
    materials = {f"Card{k}": colour("DIFFUSE", 0.0, 0.0, 0.0, a) for k, a in enumerate(alphas)}
    materials["Wall"] = colour("EMISSION", 1.0, 1.0, 1.0, 1.0)
    for any_hit, spp, tolerance in (("transparency", 1, 1e-5), ("stochastic_alpha", 64, 0.02)):
        programs = "".join(program(f"Card{k}", "emission", any_hit) for k in range(5))
        project = studio(folder, cards + wall, materials, programs, size=(16, 16), spp=spp)
        found = picture(project)[..., 0]
        assert found.mean() == pytest.approx(expected, abs=tolerance)
    materials["Wall"] = colour("DIFFUSE", 1.0, 1.0, 1.0, 1.0)
    programs = "".join(program(f"Card{k}", "emission", "transparency") for k in range(5))
    lights = '<light name="Sun"><DIRECTION x="0" y="0" z="-1" /></light>'
    behind = '<POSITION x="0" y="0" z="-1" />'  # sees the wall directly, lit through the cards
    project = studio(
        folder, cards + wall, materials, programs + program("Wall", "direct"), lights=lights,
        camera=behind, size=(8, 8),
    )  # fmt: skip
    np.testing.assert_allclose(picture(project)[..., 0], expected, atol=1e-5)


AREA = {
    "RECTANGLE": '<SHAPE value="RECTANGLE" /><EDGE_U x="1" y="0" z="0" /><EDGE_V x="0" y="0" z="1" />',
    "DISC": '<SHAPE value="DISC" /><DIRECTION x="0" y="-1" z="0" /><RADIUS value="0.5" />',
    "SPHERE": '<SHAPE value="SPHERE" /><RADIUS value="0.5" />',
    "POINT": '<SHAPE value="POINT" />',
}


def light_points(shape: str, n: int = 64) -> np.ndarray:  # type: ignore[type-arg]
    """Points spread evenly over the light about (0, 4, 0), float64 (m, 3)."""
    a, b = np.meshgrid((np.arange(n) + 0.5) / n, (np.arange(n) + 0.5) / n)
    a, b = a.reshape(-1), b.reshape(-1)
    if shape == "RECTANGLE":
        found = np.stack([a - 0.5, 0 * a, b - 0.5], axis=1)
    elif shape == "DISC":
        r = 0.5 * np.sqrt(a)
        found = np.stack([r * np.cos(2 * np.pi * b), 0 * a, r * np.sin(2 * np.pi * b)], axis=1)
    elif shape == "SPHERE":
        z = 1 - 2 * a
        r = np.sqrt(1 - z**2)
        found = 0.5 * np.stack([r * np.cos(2 * np.pi * b), r * np.sin(2 * np.pi * b), z], axis=1)
    else:
        found = np.zeros((1, 3))
    return np.asarray(found + np.array([0, 4, 0]))


DOWN = '<POSITION x="0" y="1.5" z="0" /><VIEW x="0" y="-1" z="0" /><UP x="0" y="0" z="-1" />'


@pytest.mark.parametrize("shape", sorted(AREA))
def test_penumbra_of_a_half_plane(folder: Folder, shape: str) -> None:
    """A card that ends at x = 0, halfway to the light: umbra, penumbra and light on the floor."""
    size = (48, 8)
    project = studio(
        folder,
        square("floor", "White", [9, 1, 9], [0, 0, 0])
        + square("card", "White", [5, 1, 9], [-5, 2, 0]),
        {"White": colour("DIFFUSE", 1.0, 1.0, 1.0, 1.0)},
        program("White", "direct"),
        lights=f'<light name="Lamp"><POSITION x="0" y="4" z="0" />{AREA[shape]}</light>',
        camera=DOWN,
        size=size,
        spp=64,
        fov=30,
    )
    found = picture(project)[..., 0].mean(axis=0)
    _, direction = pixel_rays(size, (0, 0, 0), 30)
    floor = np.stack([direction[4, :, 0] * 1.5, np.zeros(size[0]), np.zeros(size[0])], axis=1)
    to = light_points(shape)[None] - floor[:, None]
    length = np.linalg.norm(to, axis=-1)
    crossing = floor[:, None, 0] + to[..., 0] * (2 / to[..., 1])
    expected = (to[..., 1] / length * (crossing > 0)).mean(axis=1)
    edge = np.abs(floor[:, 0]) < 0.02 if shape == "POINT" else np.zeros(size[0], bool)
    np.testing.assert_allclose(found[~edge], expected[~edge], atol=0.025)
    assert found.min() < 0.02 or shape != "POINT"


def test_spot_light(folder: Folder) -> None:
    """Inside the cutoff the light falls off with cos^exponent, outside it is dark."""
    size = (64, 8)
    project = studio(
        folder,
        square("floor", "White", [9, 1, 9], [0, 0, 0]),
        {"White": colour("DIFFUSE", 1.0, 1.0, 1.0, 1.0)},
        program("White", "direct"),
        lights='<light name="Lamp"><POSITION x="0" y="1" z="0" /><SHAPE value="SPOT" />'
        '<SPOT_DIRECTION x="0" y="-1" z="0" /><SPOT_CUTOFF value="20" />'
        '<SPOT_EXPONENT value="8" /></light>',
        camera=DOWN,
        size=size,
        fov=40,
    )
    found = picture(project)[4, :, 0]
    _, direction = pixel_rays(size, (0, 0, 0), 40)
    x, z = direction[4, :, 0] * 1.5, direction[4, :, 1] * 1.5
    cosine = 1 / np.sqrt(1 + x**2 + z**2)
    inside = cosine > np.cos(np.radians(20))
    np.testing.assert_allclose(found[inside], cosine[inside] ** 9, rtol=1e-4)
    np.testing.assert_array_equal(found[~inside], 0)
    assert 5 < inside.sum() < 60


def test_ambient_occlusion_beside_a_wall(folder: Folder) -> None:
    """A long wall of height h at distance x hides (1 - x / sqrt(x² + h²)) / 2 of the sky."""
    size = (32, 4)
    project = studio(
        folder,
        square("floor", "White", [500, 1, 500], [0, 0, 0])
        + box("wall", "White", [0.5, 1, 500], [-1.5, 0, 0]),
        {"White": colour("DIFFUSE", 1.0, 1.0, 1.0, 1.0)},
        program("White", "ambient_occlusion"),
        camera='<POSITION x="0" y="0.9" z="0" /><VIEW x="0" y="-1" z="0" /><UP x="0" y="0" z="-1" />',
        size=size,
        spp=256,
        fov=80,
    )
    found = picture(project)[..., 0].mean(axis=0)
    _, direction = pixel_rays(size, (0, 0, 0), 80)
    x = direction[0, :, 0] * 0.9 + 1
    visible = x > 0.05
    expected = 1 - 0.5 * (1 - x / np.sqrt(x**2 + 1))
    np.testing.assert_allclose(found[visible], expected[visible], atol=0.02)
    assert visible.sum() > 10


def test_circle_of_confusion(folder: Folder) -> None:
    """A bright dot at distance D, focus F, lens radius A: a disc of radius A |1/F - 1/D|."""
    size = (96, 96)
    aperture, focus, distance = 0.2, 4.0, 8.0
    project = studio(
        folder,
        square("dot", "Dot", [0.02, 1, 0.02], [0, 0, 0], '<ROTATE x="1" y="0" z="0" w="90" />'),
        {"Dot": colour("EMISSION", 1.0, 1.0, 1.0, 1.0)},
        camera=f'<POSITION x="0" y="0" z="{distance}" /><APERTURE value="{aperture}" />'
        f'<FOCUS_DISTANCE value="{focus}" />',
        size=size,
        fov=8,
        spp=256,
        generate="thin_lens",
    )
    found = picture(project)[..., 0]
    _, direction = pixel_rays(size, (0, 0, 0), 8)
    radius2 = direction[..., 0] ** 2 + direction[..., 1] ** 2
    measured = np.sqrt((found * radius2).sum() / found.sum())
    circle = aperture * abs(1 / focus - 1 / distance)
    assert measured == pytest.approx(circle / np.sqrt(2), rel=0.03)  # of a uniform disc
    assert found.sum() > 1


def test_furnace_of_diffuse_walls(folder: Folder) -> None:
    """Inside a closed box of emission E and albedo p everything shows E (1 + p + p² + …)."""
    project = studio(
        folder,
        box("room", "Wall", [2, 2, 2], [0, 0, 0]) + sphere("ball", "Wall", 0.5, [0, 0, -1], 32),
        {"Wall": colour("DIFFUSE", 0.6, 0.5, 0.25, 1.0) + colour("EMISSION", 0.5, 0.5, 0.5, 1.0)},
        program("Wall", "path"),
        camera='<POSITION x="0" y="0" z="1.5" />',
        size=(24, 24),
        spp=256,
        depth=60,
    )
    found = picture(project)[..., :3].mean(axis=(0, 1))
    np.testing.assert_allclose(found, 0.5 / (1 - np.array([0.6, 0.5, 0.25])), rtol=0.01)


def test_fluorescence(folder: Folder) -> None:
    """Blue light on a surface that turns it to red and green: the matrix, directly and between
    facing surfaces; no energy is gained."""
    material = (
        colour("DIFFUSE", 0.0, 0.0, 0.2, 1.0)
        + colour("FLUORESCENCE_BLUE", 0.3, 0.4, 0.0, 1.0)
        + colour("FLUORESCENCE_GREEN", 0.5, 0.0, 0.0, 1.0)
    )
    lights = (
        '<light name="Lamp"><DIRECTION x="0" y="-1" z="0" />'
        '<COLOR r="0" g="{}" b="{}" a="1" /></light>'
    )
    for green, blue in ((0.0, 1.0), (1.0, 0.5)):
        project = studio(
            folder,
            square("floor", "Glow", [9, 1, 9], [0, 0, 0]),
            {"Glow": material},
            program("Glow", "fluorescent"),
            lights=lights.format(green, blue),
            camera=DOWN,
            size=(16, 16),
            spp=256,
            depth=1,
        )
        found = picture(project)[..., :3].mean(axis=(0, 1))
        matrix = np.array([[0, 0.5, 0.3], [0, 0, 0.4], [0, 0, 0.2]])
        expected = matrix @ [0, green, blue]
        np.testing.assert_allclose(found, expected, atol=0.01)
        assert found.sum() <= green + blue


def test_fluorescent_furnace(folder: Folder) -> None:
    """In a closed box radiance solves L = E + M L."""
    emission, matrix = np.array([0.1, 0.2, 1.0]), np.diag([0.3, 0.2, 0.1])
    matrix[0, 2], matrix[1, 2], matrix[0, 1] = 0.25, 0.35, 0.4
    project = studio(
        folder,
        box("room", "Glow", [2, 2, 2], [0, 0, 0]),
        {
            "Glow": colour("DIFFUSE", 0.3, 0.2, 0.1, 1.0)
            + colour("EMISSION", *emission, 1.0)
            + colour("FLUORESCENCE_BLUE", 0.25, 0.35, 0.0, 1.0)
            + colour("FLUORESCENCE_GREEN", 0.4, 0.0, 0.0, 1.0)
        },
        program("Glow", "fluorescent"),
        size=(24, 24),
        camera='<POSITION x="0" y="0" z="1.5" />',
        spp=1024,
        depth=40,
    )
    found = picture(project)[..., :3].mean(axis=(0, 1))
    np.testing.assert_allclose(found, np.linalg.solve(np.eye(3) - matrix, emission), rtol=0.02)


def test_caustic_energy(folder: Folder) -> None:
    """Light from a lamp through a glass ball onto the floor, against photons traced forwards
    through the exact sphere: the same light in every ring about the axis."""
    size, albedo = (32, 32), 0.05  # dark: next to no light comes back from the floor
    down = '<ROTATE x="1" y="0" z="0" w="180" />'
    project = studio(
        folder,
        square("lamp", "Lamp", [0.5, 1, 0.5], [0, 5, 0], down)
        + sphere("ball", "Glass", 0.7, [0, 1.2, 0], 256)
        + square("floor", "Floor", [20, 1, 20], [0, 0, 0]),
        {
            "Lamp": colour("DIFFUSE", 0.0, 0.0, 0.0, 1.0) + colour("EMISSION", 5.0, 5.0, 5.0, 1.0),
            "Glass": colour("INDEX_OF_REFRACTION", 1.5),
            "Floor": colour("DIFFUSE", albedo, albedo, albedo, 1.0),
        },
        program("Lamp", "path") + program("Floor", "path") + program("Glass", "dielectric"),
        camera='<POSITION x="0" y="0.2" z="0" /><VIEW x="0" y="-1" z="0" /><UP x="0" y="0" z="-1" />',
        size=size,
        fov=140,
        spp=1024,
        depth=4,
        near=0.01,
    )
    image = picture(project)[..., 0]
    _, direction = pixel_rays(size, (0, 0, 0), 140)
    radius = np.hypot(direction[..., 0], direction[..., 1]) * 0.2
    rings = [0.0, 0.12, 0.25, 0.4, 0.52]

    rng = np.random.default_rng(1)
    n = 3_000_000
    p = np.stack([rng.uniform(-0.5, 0.5, n), np.full(n, 5.0), rng.uniform(-0.5, 0.5, n)], axis=1)
    a, b = np.sqrt(rng.random(n)), 2 * np.pi * rng.random(n)
    d = np.stack([a * np.cos(b), -np.sqrt(1 - a**2), a * np.sin(b)], axis=1)
    power = 5.0 * 1.0 * np.pi / n  # radiance x area x pi
    near_axis = d[:, 1] < -0.85
    p, d = p[near_axis], d[near_axis]
    meets, q, out = through_sphere(p - [0, 1.2, 0], d, 0.7, 1.5)
    # the share that is refracted twice, by Fresnel at the (equal) angles of entry and exit
    centre = p - [0, 1.2, 0]
    along = (centre * d).sum(axis=1)
    entry = (
        centre
        + d * (-along - np.sqrt(np.maximum(along**2 - (centre**2).sum(1) + 0.49, 0)))[:, None]
    )
    cosine = np.clip(-(entry / 0.7 * d).sum(axis=1), 0, 1)
    behind = np.sqrt(1 - (1 - cosine**2) / 1.5**2)
    rs = ((cosine - 1.5 * behind) / (cosine + 1.5 * behind)) ** 2
    rp = ((1.5 * cosine - behind) / (1.5 * cosine + behind)) ** 2
    share = (1 - (rs + rp) / 2) ** 2
    start = np.where(meets[:, None], q + np.array([0, 1.2, 0]), p)
    heading = np.where(meets[:, None], out, d)
    weight = np.where(meets, share, 1.0)
    falls = heading[:, 1] < 0
    at = start + heading * (-start[:, 1] / np.where(falls, heading[:, 1], -1))[:, None]
    r = np.hypot(at[:, 0], at[:, 2])
    for low, high in pairwise(rings):
        chosen = falls & (r >= low) & (r < high)
        irradiance = weight[chosen].sum() * power / (np.pi * (high**2 - low**2))
        seen = (radius >= low) & (radius < high)
        assert image[seen].mean() == pytest.approx(albedo * irradiance / np.pi, rel=0.1), (
            low,
            high,
        )


def test_depth_zero_and_no_light(folder: Folder) -> None:
    """No light, nothing emitted: black, finite, and no shadow ray."""
    project = studio(
        folder,
        square("floor", "White", [9, 1, 9], [0, -1, 0]),
        {"White": colour("DIFFUSE", 1.0, 1.0, 1.0, 1.0)},
        program("White", "direct"),
    )
    frame = nau_py.Renderer(project).render()
    assert (frame.targets["L::out"][..., :3] == 0).all()
    assert "shadow" not in frame.report["totals"]["rays"]


def test_cornell_box_against_mitsuba(folder: Folder) -> None:
    """``projects/indirect`` at 48 x 48 against Mitsuba 3.9 (its path tracer, 4096 spp, the same
    geometry, depth 8; ``data/cornell_mitsuba.npz`` holds its picture as float16).

    The same mean light to 1.5 %, and no pixel off by more than its own noise: with 256 samples the
    difference is what est_error says of it.
    """
    reference = np.load(Path(__file__).parent / "data" / "cornell_mitsuba.npz")["image"]
    text = (PROJECTS / "indirect" / "project.xml").read_text().replace("../../", f"{ROOT}/")
    library = (ROOT / "materials" / "studio.mlib").read_text().replace("512", "48")
    folder.write("studio.mlib", library.replace("shaders/", f"{ROOT}/materials/shaders/"))
    folder.write("project.xml", text.replace(f"{ROOT}/materials/studio.mlib", "studio.mlib"))
    renderer = nau_py.Renderer(folder.load(), options=nau_py.RunOptions(samples=256))
    frame = renderer.render()
    found = frame.targets["Studio::dark"][..., :3].astype(np.float64)
    expected = reference.astype(np.float64)
    np.testing.assert_allclose(found.mean(axis=(0, 1)), expected.mean(axis=(0, 1)), rtol=0.015)
    error = frame.report["frames"][0]["passes"][0]["est_error"]
    rms = np.sqrt(((found - expected) ** 2).mean())
    assert rms < 1.5 * error + 0.01

"""A mirror, a shadow and an alpha card against analytic answers in float64."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

import nau_py
from tests.conftest import Folder, RayProject, pixel_rays

SIZE = (96, 72)
MIRROR = """\
<rtDefaultMaterial><rayType name="Radiance">
<rtProgram type="CLOSEST_HIT" file="builtin" proc="emission" />
<rtProgram type="MISS" file="builtin" proc="background" />
</rayType></rtDefaultMaterial>
<rtMaterialMap><rtMap to="Mirror"><rayType name="Radiance">
<rtProgram type="CLOSEST_HIT" file="builtin" proc="mirror" />
</rayType></rtMap></rtMaterialMap>
"""
CARD = """\
<rtDefaultMaterial><rayType name="Radiance">
<rtProgram type="CLOSEST_HIT" file="builtin" proc="emission" />
<rtProgram type="ANY_HIT" file="builtin" proc="alpha_test" />
<rtProgram type="MISS" file="builtin" proc="background" />
</rayType></rtDefaultMaterial>
"""
BACKGROUND = [0, 0, 0.25, 0]


def rectangle(
    origin: NDArray[Any],
    direction: NDArray[Any],
    axis: int,
    at: float,
    low: tuple[float, float],
    high: tuple[float, float],
) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """Hit mask, distance and position of rays with an axis-aligned rectangle, float64."""
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (at - origin[..., axis]) / direction[..., axis]
        p = origin + t[..., None] * direction
    others = [k for k in range(3) if k != axis]
    inside = (t > 1e-9) & np.isfinite(t)
    for k, lo, hi in zip(others, low, high):
        inside &= (p[..., k] > lo) & (p[..., k] < hi)
    return inside, np.where(inside, t, np.inf), p


def test_mirror(folder: Folder, ray_project: RayProject) -> None:
    """A floor mirrors a red wall: each pixel is the wall, its image at half strength, or sky."""
    folder.mtl("scene", {"Mirror": {"Ks": "0.5 0.25 1"}, "Red": {"Ke": "1 1 0"}})
    folder.obj(
        "scene",
        [
            ("Mirror", [(-2, 0, 2), (2, 0, 2), (2, 0, -4), (-2, 0, -4)]),
            ("Red", [(-0.7, 0.3, -3), (0.9, 0.3, -3), (0.9, 1.1, -3), (-0.7, 1.1, -3)]),
        ],
    )
    project = ray_project(MIRROR, '<POSITION x="0.1" y="1" z="2.5" />', size=SIZE)
    found = nau_py.Renderer(project).render().targets["L::out"]

    origin, direction = pixel_rays(SIZE, (0.1, 1.0, 2.5))
    wall = ((-0.7, 0.3), (0.9, 1.1))
    floor, t_floor, at = rectangle(origin, direction, 1, 0.0, (-2, -4), (2, 2))
    direct, t_direct, _ = rectangle(origin, direction, 2, -3.0, *wall)
    image, _, _ = rectangle(at, direction * [1, -1, 1], 2, -3.0, *wall)
    expected = np.tile(np.array(BACKGROUND), (*SIZE[::-1], 1))
    expected[floor & ~image] = [0, 0, 0.25, 1]
    expected[floor & image] = [0.5, 0.25, 0, 1]
    expected[direct & (t_direct < t_floor)] = [1, 1, 0, 1]
    np.testing.assert_allclose(found, expected, atol=1e-6)
    assert (floor & image).sum() > 100


def test_shadow_edge(folder: Folder, ray_project: RayProject) -> None:
    """A card above the floor: the shadow is its shear along the light, to the pixel."""
    folder.mtl("scene", {"Floor": {"Kd": "1 1 1"}, "Card": {"Kd": "1 1 1"}})
    folder.obj(
        "scene",
        [
            ("Floor", [(-3, 0, 3), (3, 0, 3), (3, 0, -5), (-3, 0, -5)]),
            ("Card", [(-0.5, 1, -1), (0.8, 1, -1), (0.8, 1, -2.2), (-0.5, 1, -2.2)]),
        ],
    )
    light = np.array([0.5, -1.0, 0.25])
    project = ray_project(camera='<POSITION x="0" y="2.6" z="3" />', light=tuple(light), size=SIZE)
    found = nau_py.Renderer(project).render().targets["L::out"][..., 0]

    origin, direction = pixel_rays(SIZE, (0.0, 2.6, 3.0))
    floor, t_floor, at = rectangle(origin, direction, 1, 0.0, (-3, -5), (3, 3))
    card, t_card, _ = rectangle(origin, direction, 1, 1.0, (-0.5, -2.2), (0.8, -1))
    shadow, _, _ = rectangle(at, np.broadcast_to(-light, at.shape), 1, 1.0, (-0.5, -2.2), (0.8, -1))
    on_floor = floor & ~(card & (t_card < t_floor))
    cosine = 1 / np.linalg.norm(light)
    np.testing.assert_allclose(found[on_floor & shadow], 0.3, atol=1e-6)
    np.testing.assert_allclose(found[on_floor & ~shadow], 0.3 + cosine, atol=1e-6)
    assert (on_floor & shadow).sum() > 50


def test_alpha_card(folder: Folder, ray_project: RayProject) -> None:
    """A card whose left half is transparent, before a wall: threshold 0.25, bilinear."""
    texels = np.zeros((8, 8, 4), np.uint8)
    texels[:, 4:] = 255
    folder.image("card.png", texels)
    folder.mtl("scene", {"Card": {"Ke": "1 0 0", "map_Kd": "card.png"}, "Wall": {"Ke": "0 1 0"}})
    folder.obj(
        "scene",
        [
            ("Card", [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]),
            ("Wall", [(-3, -3, -2), (3, -3, -2), (3, 3, -2), (-3, 3, -2)]),
        ],
    )
    frame = nau_py.Renderer(ray_project(CARD, size=SIZE)).render()
    found = frame.targets["L::out"]

    origin, direction = pixel_rays(SIZE, (0.0, 0.0, 3.0))
    card, _, at = rectangle(origin, direction, 2, 0.0, (-1, -1), (1, 1))
    u = (at[..., 0] + 1) / 2 * 8 - 0.5  # texel coordinates: 0 is the centre of the first texel
    alpha = np.clip(u - 3, 0, 1) + np.clip(-u, 0, 1) - np.clip(u - 7, 0, 1)  # it repeats
    solid = card & (alpha > 0.25)
    wall, _, _ = rectangle(origin, direction, 2, -2.0, (-3, -3), (3, 3))
    np.testing.assert_allclose(found[solid], [[1, 0, 0, 1]] * solid.sum())
    seen = wall & ~solid
    np.testing.assert_allclose(found[seen], [[0, 1, 0, 1]] * seen.sum())
    rays = frame.report["frames"][0]["passes"][0]["rays"]
    assert rays == {"primary": SIZE[0] * SIZE[1], "continuation": int((card & ~solid).sum())}

"""Packets of rays: what they find is what single rays find, whatever is traced beside them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import nau_py
from nau_py.raytrace.kernels.path.camera import ITEM
from nau_py.raytrace.tracing.accelerator import Accelerator
from nau_py.raytrace.tracing.dispatch import compute_packet_shift, split_items
from nau_py.raytrace.tracing.geometry import gather_triangles
from nau_py.scene.world import World
from tests.conftest import PROJECTS, Folder, RayProject
from tests.raytrace.studio import colour, program, sphere, square, studio

SEEN = """\
import numpy as np

found = []

def camera(launch):
    x = launch.x + (launch.sample % 4 + 0.5) / 4
    y = launch.y + (launch.sample // 4 + 0.5) / 4
    origin, direction = launch.camera_rays(x, y)
    return launch.trace("Radiance", origin, direction)

def shade(hits):
    found.append((hits.rays.origin, hits.direction, hits.t))
    return np.ones(3)
"""


def test_packets_find_what_single_rays_find(folder: Folder, ray_project: RayProject) -> None:
    """The plaza through 16 rays a pixel: distances as single rays have them, to a float."""
    import sys

    folder.write("prog.py", SEEN)
    project = ray_project(
        '<rtDefaultMaterial><rayType name="Radiance">'
        '<rtProgram type="CLOSEST_HIT" file="prog.py" proc="shade"/></rayType></rtDefaultMaterial>',
        camera='<POSITION x="3.6" y="1.75" z="6.5" /><LOOK_AT_POINT x="1.2" y="3.1" z="-7.5" />',
        size=(96, 96),
        spp=16,
    )
    text = (folder.path / "project.xml").read_text()
    text = text.replace("scene.obj", str(PROJECTS / "models/plaza/plaza.obj"))
    text = text.replace('file="builtin" proc="pinhole"', 'file="prog.py" proc="camera"')
    folder.write("project.xml", text)
    project = folder.load()
    frame = nau_py.Renderer(project).render()
    module = next(
        m for n, m in sys.modules.items() if str(folder.path) in str(getattr(m, "__file__", ""))
    )
    parts: list[Any] = module.found
    origin, direction, t = (np.concatenate([part[k] for part in parts]) for k in range(3))
    assert len(t) > 0.7 * frame.report["totals"]["rays"]["primary"]
    single = Accelerator(gather_triangles(World(project, (96, 96)).objects(["S"]))).intersect(
        origin, direction
    )
    assert (single.triangle >= 0).all()
    np.testing.assert_allclose(t, single.t, rtol=2.5e-7)  # at edges: either of two triangles


@pytest.mark.parametrize("at", [(0.0, 0.0, 0.0), (0.1, -0.2, 0.05)])
def test_no_ray_leaks_where_a_packet_spans_octants(folder: Folder, at: tuple[float, ...]) -> None:
    """From inside a ball every ray hits it, also where directions change sign within a pixel."""
    frame = nau_py.Renderer(
        studio(
            folder,
            sphere("ball", "Glow", 1.0, [0, 0, 0], 64),
            {"Glow": colour("EMISSION", 1.0, 1.0, 1.0, 1.0)},
            program("Glow", "emission"),
            camera='<POSITION x="{}" y="{}" z="{}" />'.format(*at),
            near=0.001,
            fov=120,
            size=(64, 64),
            spp=16,
        )
    ).render()
    np.testing.assert_array_equal(frame.targets["L::out"], 1)


def test_alpha_tests_of_what_moves(folder: Folder) -> None:
    """A moved card's holes stay holes: Embree's two scenes number their triangles apart."""
    holes = np.zeros((2, 2, 4), np.uint8)
    folder.image("clear.png", holes)
    folder.mtl("scene", {"Card": {"map_Kd": "clear.png"}, "Wall": {"Ke": "0 1 0"}})
    folder.obj("wall", [("Wall", [(-9, -9, -2), (9, -9, -2), (9, 9, -2), (-9, 9, -2)])])
    folder.obj("card", [("Card", [(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)])])
    for name in ("wall", "card"):
        text = (folder.path / f"{name}.obj").read_text()
        folder.write(f"{name}.obj", text.replace(f"{name}.mtl", "scene.mtl"))
    studio(
        folder,
        '<file name="wall.obj" /><file name="card.obj" />',
        {},
        program("Card", "emission", "alpha_test") + program("Wall", "emission"),
        size=(16, 16),
        spp=16,
    )
    text = (folder.path / "project.xml").read_text()
    folder.write("project.xml", text.replace('<scene name="S">', '<scene name="S" type="Scene">'))
    renderer = nau_py.Renderer(folder.load())
    card = renderer.session.world.objects(["S"])[1]
    renderer.move(card.name, np.eye(4))
    frame = renderer.render()
    np.testing.assert_array_equal(frame.targets["L::out"][..., 1], 1)
    assert frame.report["totals"]["rays"]["continuation"] == 16 * 16 * 16


@pytest.mark.parametrize("samples", [1, 2, 3, 4, 9, 16, 64])
@pytest.mark.parametrize("tile", [1, 8, 777, 10**6])
def test_tiles_do_not_split_what_is_traced_together(samples: int, tile: int) -> None:
    rng = np.random.default_rng(samples)
    pixels = np.flatnonzero(rng.random(1000) < 0.3)
    items = np.zeros(len(pixels), ITEM)
    items["pixel"], items["count"] = pixels, rng.integers(0, samples + 1, len(pixels))
    shift = compute_packet_shift(samples)
    assert samples << shift <= max(16, samples)
    parts = split_items(items, tile, shift)
    assert np.concatenate([np.arange(p.start, p.stop) for p in parts]).tolist() == list(
        range(len(pixels))
    )
    groups = [set((pixels[p] >> shift).tolist()) for p in parts]
    assert sum(len(g) for g in groups) == len(set().union(*groups))


def test_one_sample_a_pixel_is_the_same_for_any_tile(folder: Folder) -> None:
    """Below 16 samples neighbours share packets, in the same way for every tile and thread."""
    scene = sphere("ball", "Mirror", 0.6, [0, 0, 0], 64) + square(
        "floor", "White", [9, 1, 9], [0, -0.6, 0]
    )
    materials = {
        "Mirror": colour("SPECULAR", 0.9, 0.9, 0.9, 1.0),
        "White": colour("DIFFUSE", 1.0, 1.0, 1.0, 1.0),
    }
    project = studio(
        folder,
        scene,
        materials,
        program("Mirror", "mirror") + program("White", "direct"),
        lights='<light name="L"><DIRECTION x="-0.4" y="-1" z="-0.3" /></light>',
        size=(75, 41),
    )
    found = []
    for threads, tile in ((1, 0), (2, 1000), (4, 16), (3, 10**6)):
        options = nau_py.RunOptions(threads=threads, tile=tile)
        frame = nau_py.Renderer(project, options=options).render()
        found.append(frame.targets["L::out"])
    for other in found[1:]:
        np.testing.assert_array_equal(other, found[0])

"""The raytrace engine against raw Embree, as ratios in one run.

``python benchmarks/raytrace.py [SIZE] [--threads N]`` traces SIZE x SIZE pixels (512), one sample
each, of three scenes: the plaza, a Cornell box, a mesh of 300k triangles. For each it prints

- raw: embreex alone on the very rays that the built-in program ``lambert`` traces: primary rays,
  then shadow rays, in the same tiles on the same threads;
- built-in: ray generation, tracing, shading and averaging by the built-in programs;
- NumPy: the same by programs as a user writes them.

Ratios are medians over 9 runs after a warm-up, the runs of the three taken in turn; the spread is
that of the middle half. "Same colours" is the share of pixels in which built-in and NumPy programs
agree; the rest are terminators of smooth surfaces, where the built-in lifts shadow rays.
"""

from __future__ import annotations

import argparse
import os
import platform
import statistics
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any

import embreex
import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

from nau_py.diagnostics.location import NOWHERE
from nau_py.raytrace.programs.catalogue import CODES
from nau_py.raytrace.programs.description import CLOSEST_HIT, MISS, RAY_GENERATION
from nau_py.raytrace.tracing.accelerator import Accelerator, embree_version
from nau_py.raytrace.tracing.camera_rays import encode_camera, make_camera_rays
from nau_py.raytrace.tracing.dispatch import run_launch
from nau_py.raytrace.tracing.estimate import LaunchResult
from nau_py.raytrace.tracing.geometry import RayGeometry, gather_triangles
from nau_py.raytrace.tracing.launch import LaunchSettings, RayGeneration, RayLaunch
from nau_py.raytrace.tracing.materials import TracedLight, TracedMaterial
from nau_py.raytrace.tracing.program_loader import BoundProgram
from nau_py.raytrace.tracing.scene_tables import TexelStore, TracedScene, TraceSettings
from nau_py.scene import primitives
from nau_py.scene.camera import CameraState
from nau_py.scene.mesh import SceneObject
from nau_py.scene.viewport import Rect

TILE = 16384
RUNS = 9
SUN = np.array([-0.5, -1.0, -0.4]) / np.linalg.norm([-0.5, -1.0, -0.4])


def bound(function: Callable[..., Any] | None, code: int = 127) -> BoundProgram:
    return BoundProgram(function, "benchmark", NOWHERE, "", code)


def camera_of(eye: tuple[float, ...], at: tuple[float, ...]) -> CameraState:
    values = {"FOV": 50.0, "NEAR": 0.05, "FAR": 500.0, "APERTURE": 0.0, "FOCUS_DISTANCE": 1.0}
    position = np.array(eye)
    return CameraState("eye", position, np.array(at) - position, values=values)


def plaza() -> tuple[RayGeometry, CameraState]:
    from pathlib import Path

    import nau_py
    from nau_py.scene.world import World

    path = Path(__file__).parent.parent / "projects" / "half" / "project.xml"
    world = World(nau_py.load(path), (512, 512))
    return gather_triangles(world.objects(["Plaza"])), camera_of((3.6, 1.75, 6.5), (1.2, 3.1, -7.5))


def cornell() -> tuple[RayGeometry, CameraState]:
    def placed(mesh: Any, scale: tuple[float, ...], at: tuple[float, ...]) -> SceneObject:
        matrix = np.diag([*scale, 1.0])
        matrix[:3, 3] = at
        return SceneObject("o", mesh, matrix)

    objects = [
        placed(primitives.make_square("white"), (1, 1, 1), (0, 0, 0)),
        placed(primitives.make_box("white"), (1, 1, 0.01), (0, 1, -1)),
        placed(primitives.make_box("red"), (0.01, 1, 1), (-1, 1, 0)),
        placed(primitives.make_box("green"), (0.01, 1, 1), (1, 1, 0)),
        placed(primitives.make_box("white"), (0.3, 0.6, 0.3), (-0.35, 0.6, -0.3)),
        placed(primitives.make_box("white"), (0.3, 0.3, 0.3), (0.35, 0.3, 0.35)),
    ]
    return gather_triangles(objects), camera_of((0, 1, 3.2), (0, 0.9, 0))


def mesh_300k() -> tuple[RayGeometry, CameraState]:
    ball = primitives.make_sphere(548, 274, "white")
    bumps = 1 + 0.03 * np.sin(40 * ball.positions[:, :1]) * np.sin(40 * ball.positions[:, 1:2])
    ball.attributes["position"][:, :3] *= bumps
    return gather_triangles([SceneObject("o", ball)]), camera_of((0, 0.3, 2.4), (0, 0, 0))


def user_generate(launch: Any) -> Any:
    origin, direction = launch.camera_rays(launch.x + 0.5, launch.y + 0.5)
    return launch.trace("Radiance", origin, direction)


def user_shade(hits: Any) -> Any:
    to_light = -hits.lights[0].vector("NORMALIZED_DIRECTION")
    normal = hits.facing_normal
    cosine = normal[:, 0] * to_light[0] + normal[:, 1] * to_light[1] + normal[:, 2] * to_light[2]
    cosine = np.maximum(cosine, 0)
    seen = hits.trace("Shadow", to_light, kind="shadow")[:, 0]
    return hits.color("DIFFUSE") * (cosine * seen + np.float32(0.3))[:, None]


def user_miss(rays: Any) -> Any:
    return np.zeros(4, np.float32)


def user_lit(rays: Any) -> Any:
    return np.ones(4, np.float32)


def work(
    geometry: RayGeometry, camera: CameraState, size: int, threads: int, user: bool
) -> RayLaunch:
    from nau_py.model.attributes.light import LIGHT

    count = len(geometry.materials)
    values: dict[str, tuple[Any, ...]] = {a.name: a.default for a in LIGHT if a.default}
    values |= {"NORMALIZED_DIRECTION": (*SUN, 0.0), "DIRECTION": (*SUN, 0.0)}
    shade = bound(user_shade) if user else bound(None, CODES[CLOSEST_HIT]["lambert"])
    miss = bound(user_miss) if user else bound(None, CODES[MISS]["background"])
    lit = bound(user_lit) if user else bound(None, CODES[MISS]["unoccluded"])
    scene = TracedScene(
        geometry,
        Accelerator(geometry),
        [TracedMaterial(name, {}, {}) for name in geometry.materials],
        {
            ("Radiance", CLOSEST_HIT): [shade] * count,
            ("Radiance", MISS): [miss],
            ("Shadow", MISS): [lit],
        },
        [TracedLight("Sun", values)],
        {},
        {},
        ["Radiance", "Shadow"],
        TraceSettings(),
        TexelStore(),
    )
    rect = Rect(0.0, 0.0, float(size), float(size))
    generation = RayGeneration(
        bound(user_generate) if user else bound(None, CODES[RAY_GENERATION]["pinhole"]),
        encode_camera(camera, rect, geometry.centre),
        make_camera_rays(camera, rect, geometry.centre),
        size,
    )
    return RayLaunch(scene, generation, None, LaunchSettings(1, threads, TILE))


class Raw:
    """Embree alone on the rays that ``work`` traces."""

    def __init__(self, job: RayLaunch, size: int, threads: int) -> None:
        geometry = job.scene.geometry
        self.scene = EmbreeScene(robust=True)
        TriangleMesh(self.scene, geometry.vertices, geometry.triangles)
        self.threads = threads
        y, x = np.mgrid[0:size, 0:size]
        o, d = job.generation.rays(
            (x.reshape(-1) + 0.5).astype(np.float32), (y.reshape(-1) + 0.5).astype(np.float32)
        )
        self.tiles = [(o[i : i + TILE], d[i : i + TILE]) for i in range(0, len(o), TILE)]
        self.shadows: list[tuple[Any, Any]] = []
        toward = (-SUN).astype(np.float32)
        for origin, direction in self.tiles:
            found = self.scene.run(origin, direction, output=True)
            hit = found["primID"] >= 0
            at = origin[hit] + direction[hit] * (found["tfar"][hit] * np.float32(0.9999))[:, None]
            n = np.cross(
                *(
                    geometry.vertices[geometry.triangles[found["primID"][hit], k]]
                    - geometry.vertices[geometry.triangles[found["primID"][hit], 0]]
                    for k in (1, 2)
                )
            )
            facing = np.where((n * direction[hit]).sum(1) > 0, -1, 1)
            lit = (n @ toward) * facing > 0
            at = np.ascontiguousarray(at[lit])
            self.shadows.append((at, np.ascontiguousarray(np.broadcast_to(toward, at.shape))))

    def tile(self, index: int) -> None:
        origin, direction = self.tiles[index]
        self.scene.run(origin, direction, output=True)
        origin, direction = self.shadows[index]
        if len(origin):
            self.scene.run(origin, direction, query="OCCLUDED")

    def __call__(self) -> None:
        with ThreadPoolExecutor(max_workers=self.threads) as pool:
            list(pool.map(self.tile, range(len(self.tiles))))


def timed(function: Callable[[], Any]) -> float:
    start = time.perf_counter()
    function()
    return time.perf_counter() - start


def quartiles(values: list[float]) -> str:
    low, middle, high = statistics.quantiles(values, n=4)
    return f"{middle:5.2f} ({low:.2f}-{high:.2f})"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("size", nargs="?", type=int, default=512)
    parser.add_argument("--threads", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    size, threads = options.size, options.threads
    print(
        f"{platform.platform()}, {os.cpu_count()} CPUs, Python {platform.python_version()}, ",
        end="",
    )
    print(f"NumPy {np.__version__}, embreex {embreex.__version__}, Embree {embree_version()}")
    print(f"{size} x {size}, 1 sample, tiles of {TILE}, {threads} threads; raw in ms, then ratios")
    pixels = np.arange(size * size)
    for name, make in (("plaza", plaza), ("cornell box", cornell), ("300k mesh", mesh_300k)):
        geometry, camera = make()
        jobs = [work(geometry, camera, size, threads, user) for user in (False, True)]
        raw = Raw(jobs[0], size, threads)

        def launch(job: RayLaunch) -> LaunchResult:
            return run_launch(job, pixels, lambda done, total: None)

        a, b = (launch(job) for job in jobs)
        same = float((np.abs(a.colours - b.colours).max(axis=1) < 2e-6).mean())
        traced = sum(len(o) for o, _ in raw.shadows)
        raw()
        times: list[tuple[float, float, float]] = []
        for _ in range(RUNS):
            built_in, numpy_programs = (timed(partial(launch, job)) for job in jobs)
            times.append((timed(raw), built_in, numpy_programs))
        base = statistics.median(t[0] for t in times) * 1000
        print(
            f"{name:12} {len(geometry.triangles):7} triangles  raw {base:6.1f} ms  "
            f"built-in {quartiles([t[1] / t[0] for t in times])}  "
            f"NumPy {quartiles([t[2] / t[0] for t in times])}  same colours {same:.1%}  "
            f"shadow rays {a.counts.rays['shadow']} (raw {traced})"
        )


if __name__ == "__main__":
    main()

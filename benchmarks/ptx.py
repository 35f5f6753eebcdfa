"""Compiled OptiX programs against raw Embree, on Nau's own sample 07.

``python benchmarks/ptx.py NAU [RUNS]`` (a checkout of Nau3D/nau) launches the shipped PTX of
``optix07-ReflectionRefraction`` and traces by hand, without shading, the rays that make up nine
tenths of its own: the primary ones, and those from their hits to the light. Same threads, same run.
Then the selective demo: its programs of OptiX 3 to 6 against their Python twins, in turn.
"""

from __future__ import annotations

import statistics
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from time import perf_counter

import numpy as np

import nau_py
from nau_py.raytrace.tracing.accelerator import Accelerator
from nau_py.raytrace.tracing.geometry import gather_triangles

TILE = 65536
SELECTIVE = Path(__file__).parent.parent / "projects" / "selective"


def raw_rate(
    accelerator: Accelerator, origin: np.ndarray, direction: np.ndarray, threads: int
) -> float:
    """Rays a second of Embree alone, in tiles over threads."""
    parts = [slice(i, i + TILE) for i in range(0, len(origin), TILE)]
    begun = perf_counter()
    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(lambda p: accelerator.intersect(origin[p], direction[p]), parts))
    return len(origin) / (perf_counter() - begun)


def twins(runs: int) -> None:
    """Milliseconds of the selective demo's raytrace pass, compiled and in Python."""
    options = nau_py.RunOptions(threads=2)
    renderers = [
        nau_py.Renderer(nau_py.load(SELECTIVE / name), options=options)
        for name in ("optix.xml", "project.xml")
    ]
    for renderer in renderers:
        renderer.render()
    times: list[list[float]] = [[], []]
    for _ in range(runs):
        for renderer, measured in zip(renderers, times):
            passes = renderer.again().report["frames"][0]["passes"]
            stages = next(p["stages"] for p in passes if p["name"] == "trace")
            measured.append(stages["trace"] + stages.get("shade", 0.0))
    compiled, python = (statistics.median(measured) for measured in times)
    print(f"selective, PTX of OptiX 3 to 6: {compiled:.0f} ms, its Python twin: {python:.0f} ms")
    print(f"ratio {compiled / python:.2f}")


def main() -> None:
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    root, runs = Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 5
    project = nau_py.load(root / "projects/optix test/optix07-ReflectionRefraction/optix.xml")
    options = nau_py.RunOptions(threads=2)
    renderer = nau_py.Renderer(project, options=options)
    frame = renderer.render()
    rates = []
    for _ in range(runs):
        (trace, *_) = renderer.again().report["frames"][0]["passes"]
        rates.append(sum(trace["rays"].values()) / trace["stages"]["trace"] * 1000)
    pass_ = renderer.pipeline.passes[0]
    world = renderer.session.world
    geometry = gather_triangles(world.objects(pass_.scene_names), frozenset())
    accelerator = Accelerator(geometry)
    camera = world.camera(pass_.camera_name)
    height, width = frame.image.shape[:2]
    across, up = camera.half_extent(width / height)
    y, x = np.mgrid[0:height, 0:width].reshape(2, -1)
    sx, sy = (x + 0.5) / width * 2 - 1, (y + 0.5) / height * 2 - 1
    direction = camera.forward + sx[:, None] * camera.right * across
    direction = direction + sy[:, None] * camera.true_up * up
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    origin = np.broadcast_to(camera.position - geometry.centre, direction.shape)
    first = [np.ascontiguousarray(a, np.float32) for a in (origin, direction)]
    hits = accelerator.intersect(*first)
    met = hits.triangle >= 0
    points = first[0][met] + first[1][met] * (hits.t[met] * 0.999)[:, None]
    light = np.array(world.light(pass_.lights[0].name or "").values["POSITION"][:3], float)
    towards = (light - geometry.centre - points).astype(np.float32)
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    both = [np.concatenate([a, b]) for a, b in zip(first, (points, towards))]
    both = [np.ascontiguousarray(a, np.float32) for a in both]
    raw = [raw_rate(accelerator, both[0], both[1], 2) for _ in range(runs)]
    print(frame.report["machine"])
    ours, theirs = statistics.median(rates) / 1e6, statistics.median(raw) / 1e6
    print(f"PTX, shaded: {ours:.1f} M rays/s ({min(rates) / 1e6:.1f} to {max(rates) / 1e6:.1f})")
    print(f"Embree alone: {theirs:.1f} M rays/s ({min(raw) / 1e6:.1f} to {max(raw) / 1e6:.1f})")
    print(f"ratio {ours / theirs:.2f}")
    renderer.close()
    twins(runs)


if __name__ == "__main__":
    main()

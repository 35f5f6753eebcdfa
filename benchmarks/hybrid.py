"""What hybrid rendering saves, and what programs cost over raw Embree, as ratios in one run.

``python benchmarks/hybrid.py [SIZE]`` renders the plaza at SIZE x SIZE (512) and prints

- the raytrace pass of the selective demo against the same pass without its mask;
- the half demo's raytrace pass (built-in programs, 1 spp) against Embree alone on as many coherent
  rays: its primary and shadow rays.

Each figure is the best of three after a warm-up. Machine and versions are printed with them.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import nau_py
from nau_py.raytrace.accel import Accelerator
from nau_py.raytrace.camera import camera_rays
from nau_py.raytrace.geometry import gather
from nau_py.scene.world import World

PROJECTS = Path(__file__).parent.parent / "projects"
RUNS = 3


def best(work: Callable[[], float]) -> float:
    """The smallest of RUNS results, after one that does not count."""
    work()
    return min(work() for _ in range(RUNS))


def trace_ms(project: nau_py.Project, size: int, threads: int = 0) -> float:
    """Milliseconds of the raytrace pass in steady state."""
    options = nau_py.RunOptions(threads=threads)
    renderer = nau_py.Renderer(project, size=(size, size), options=options)
    frame = 0

    def once() -> float:
        nonlocal frame
        report = renderer.render(frame).report
        frame += 1
        passes = report["frames"][0]["passes"]
        return float(next(p["ms"] for p in passes if p["name"] == "trace"))

    return best(once)


def without_mask(project: nau_py.Project) -> nau_py.Project:
    """``project`` with every pixel traced."""
    for pipeline in project.pipelines:
        for pass_ in pipeline.passes:
            if pass_.name == "trace":
                pass_.rtInput = []  # type: ignore[attr-defined]
    return project


def raw_ms(project: nau_py.Project, size: int) -> float:
    """Milliseconds of Embree alone: primary rays of the lower half, and as many shadow rays."""
    world = World(project, (size, size))
    accelerator = Accelerator(gather(world.objects(["Plaza"])))
    rows = np.arange(size // 2)
    x, y = np.meshgrid(np.arange(size) + 0.5, rows + 0.5)
    rays = camera_rays(world.camera("Eye"), world.viewport("Window"))
    origin, direction = rays(x.reshape(-1).astype(np.float32), y.reshape(-1).astype(np.float32))
    sun = -np.array(world.light("Sun").vector("NORMALIZED_DIRECTION"), np.float32)

    def once() -> float:
        start = time.perf_counter()
        found = accelerator.intersect(origin, direction)
        hit = found.triangle >= 0
        at = origin[hit] + direction[hit] * (found.t[hit] * np.float32(0.999))[:, None]
        accelerator.occluded(at, np.broadcast_to(sun, at.shape))
        return (time.perf_counter() - start) * 1000

    return best(once)


def main() -> None:
    size = int(sys.argv[1]) if len(sys.argv) > 1 else 512
    selective = trace_ms(nau_py.load(PROJECTS / "selective" / "project.xml"), size)
    whole = trace_ms(without_mask(nau_py.load(PROJECTS / "selective" / "project.xml")), size)
    half = trace_ms(nau_py.load(PROJECTS / "half" / "project.xml"), size, threads=1)
    raw = raw_ms(nau_py.load(PROJECTS / "half" / "project.xml"), size)
    machine = nau_py.Renderer(nau_py.load(PROJECTS / "half" / "project.xml"), "Raster", size=(8, 8))
    print(machine.render().report["machine"])
    print(f"selective, 16 spp, {size} x {size}: {selective:8.1f} ms in the mask")
    print(f"every pixel, same programs:      {whole:8.1f} ms, {whole / selective:.1f} x")
    print(f"half, built-in programs, 1 thread: {half:6.1f} ms")
    print(f"Embree alone on its rays, 1 thread: {raw:5.1f} ms; the pass takes {half / raw:.1f} x")


if __name__ == "__main__":
    main()

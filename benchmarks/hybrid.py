"""Time that hybrid rendering saves, as a ratio in one run.

``python benchmarks/hybrid.py [SIZE]`` renders the selective demo at SIZE x SIZE (1024) with its
mask and its twin that traces every pixel, 16 samples, the same programs. It prints the time of the
raytrace passes in steady state (medians of 5 frames after a warm-up, taken in turn) and their rays.
"""

from __future__ import annotations

import statistics
import sys
from pathlib import Path
from typing import Any

import nau_py

PROJECTS = Path(__file__).parent.parent / "projects"
RUNS = 5


def traced(frame: nau_py.Frame) -> dict[str, Any]:
    """The record of the raytrace pass."""
    passes = frame.report["frames"][0]["passes"]
    return next(p for p in passes if p["class"] in ("optix", "raytrace"))


def main() -> None:
    size = int(sys.argv[1]) if len(sys.argv) > 1 else 1024
    renderers = [
        nau_py.Renderer(nau_py.load(PROJECTS / "selective" / f"{name}.xml"), size=(size, size))
        for name in ("project", "full")
    ]
    for renderer in renderers:
        renderer.render(0)
    times: list[list[float]] = [[], []]
    records: list[dict[str, Any]] = [{}, {}]
    for index in range(1, RUNS + 1):
        for which, renderer in enumerate(renderers):
            frame = renderer.render(index)
            records[which] = traced(frame)
            times[which].append(records[which]["ms"])
    print(frame.report["machine"])
    for label, listed, record in zip(("in the mask", "every pixel"), times, records):
        rays = sum(record["rays"].values())
        low, high = min(listed), max(listed)
        print(
            f"{label}: {statistics.median(listed):8.1f} ms ({low:.0f}-{high:.0f}), "
            f"{record['pixels']} pixels, {rays / 1e6:.2f} M rays"
        )
    ratios = [full / part for part, full in zip(*times)]
    print(
        f"every pixel takes {statistics.median(ratios):.2f} x ({min(ratios):.2f}-{max(ratios):.2f})"
    )


if __name__ == "__main__":
    main()

"""Time from saving a file to the new picture.

``python benchmarks/reload.py [SIZE]`` copies the selective demo, follows it as ``nau-run --watch``
does, and saves a shader, a ray program and the project file, five times each. It prints the medians
beside a steady frame of the same run, as ratios: above 1 is what taking in the change costs. Then
the same for a shader in ``nau-view``, with its child process and its look at the files: to the
first picture, which is coarse, and to the one of full size.
"""

from __future__ import annotations

import shutil
import statistics
import sys
import tempfile
from pathlib import Path
from time import perf_counter, sleep

import nau_py
from nau_py.passes.frame import RunOptions
from nau_py.run.reload import HotReload
from nau_py.run.renderer import Renderer
from nau_py.viewer.render_thread import RenderThread, make_worker
from nau_py.viewer.state import ViewerState

ROOT = Path(__file__).parent.parent
RUNS = 5


def main() -> None:
    size = int(sys.argv[1]) if len(sys.argv) > 1 else 512
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        for name in ("projects/selective", "projects/models", "materials"):
            shutil.copytree(ROOT / name, root / name)
        watch = HotReload(
            root / "projects/selective/project.xml",
            nau_py.load,
            lambda p: Renderer(p, size=(size, size)),
        )
        watch.start()
        assert watch.renderer is not None
        print(watch.renderer.again().report["machine"])
        steady = []
        for _ in range(RUNS):
            begun = perf_counter()
            watch.renderer.again()
            steady.append(perf_counter() - begun)
        frame = statistics.median(steady)
        print(f"steady frame: {frame * 1000:.0f} ms")
        for label, name, mark in (
            ("shader", "materials/shaders/combine.frag", "// {}\n"),
            ("ray program", "projects/selective/programs/hybrid.py", "# {}\n"),
            ("project", "projects/selective/project.xml", "<!-- {} -->\n"),
        ):
            times = []
            for run in range(RUNS):
                file = root / name
                text = file.read_text()
                begun = perf_counter()
                file.write_text(text + "\n" + mark.format(run))
                changed = watch.watch.take_changes()
                assert changed, name
                watch.render(changed)
                times.append(perf_counter() - begun)
            middle = statistics.median(times)
            print(
                f"{label}: {middle * 1000:.0f} ms ({min(times) * 1000:.0f} to "
                f"{max(times) * 1000:.0f}), {middle / frame:.2f} x a steady frame"
            )
        watch.close()
        viewer(root, size, frame)
    print(nau_py.__version__)


def viewer(root: Path, size: int, frame: float) -> None:
    """Save a shader while nau-view shows the demo."""
    state = ViewerState(root / "projects/selective/project.xml", (size, size))
    render_thread = RenderThread(state, make_worker(state.path, RunOptions()))
    render_thread.start()
    while not state.full:
        sleep(0.01)
    file = root / "materials/shaders/combine.frag"
    firsts, fulls = [], []
    for run in range(RUNS):
        sleep(1.0)
        text, attempt, full = file.read_text(), state.attempt, state.full
        begun = perf_counter()
        file.write_text(text + f"\n// {run}\n")
        while state.attempt == attempt:
            sleep(0.0005)
        shown = state.pictures
        while state.pictures == shown:
            sleep(0.0005)
        firsts.append(perf_counter() - begun)
        while state.full == full:
            sleep(0.0005)
        fulls.append(perf_counter() - begun)
    render_thread.close()
    for label, times in (("first", firsts), ("full size", fulls)):
        middle = statistics.median(times)
        print(
            f"nau-view, shader, {label}: {middle * 1000:.0f} ms ({min(times) * 1000:.0f} to "
            f"{max(times) * 1000:.0f}), {middle / frame:.2f} x a steady frame"
        )


if __name__ == "__main__":
    main()

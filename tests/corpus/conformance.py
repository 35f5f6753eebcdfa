"""One of Nau's own projects, from reading to its picture, and how far that is from the real one.

``python -m tests.corpus.conformance REQUEST.json`` does one request in a process of its own, so that
what hangs or crashes costs only itself; ``tests/corpus/__main__.py`` makes the requests.
"""

from __future__ import annotations

import json
import sys
import time
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

MEAN, HIGH = 1.5, 8.0
"""Bounds of issue 4: mean and 99th percentile of absolute differences, in 1/255."""
FRAME = 2
"""The frame whose pictures the real engine left."""


def project_files(nau: Path) -> list[Path]:
    """The project files of a checkout; one lies beside the engine's own source."""
    return sorted([*(nau / "projects").glob("**/*.xml"), *(nau / "nau/geometry").glob("*.xml")])


@dataclass
class Request:
    """A pipeline to render. ``reference``: folder of the real engine's picture, if there is one."""

    project: str
    pipeline: str | None
    size: tuple[int, int] | None
    reference: str | None
    picture: str


@dataclass
class Difference:
    """Of one picture or target: mean and 99th percentile, in 1/255 (float targets: of their
    range)."""

    name: str
    mean: float
    high: float

    @property
    def good(self) -> bool:
        return self.mean <= MEAN and self.high <= HIGH


@dataclass
class Result:
    """Result of a request: the last stage, its message, time and differences."""

    project: str
    pipeline: str | None
    stage: str = "read"
    message: str = ""
    warnings: int = 0
    errors: list[str] = field(default_factory=list)
    first_ms: float = 0.0
    frame_ms: float = 0.0
    differences: list[Difference] = field(default_factory=list)
    missing_targets: list[str] = field(default_factory=list)

    @property
    def verdict(self) -> str:
        if self.stage != "run":
            return f"no: {self.stage}"
        if not self.differences:
            return "runs"
        return "equal" if all(d.good for d in self.differences) else "differs"


def compare(name: str, found: np.ndarray, reference: np.ndarray) -> Difference:  # type: ignore[type-arg]
    """Both (height, width, …), row 0 at the top, in the same units; 8-bit values count as such,
    others in 255ths of the reference's range (at least 1)."""
    if found.shape[:2] != reference.shape[:2]:
        return Difference(f"{name}: size {found.shape[:2]} not {reference.shape[:2]}", 255.0, 255.0)
    found, reference = (a.reshape(*a.shape[:2], -1) for a in (found, reference))
    channels = min(found.shape[2], reference.shape[2])
    a, b = (x[..., :channels].astype(np.float64) for x in (found, reference))
    scale = 1.0
    if reference.dtype != np.uint8:
        scale = 255.0 / max(float(np.ptp(b[np.isfinite(b)])) if np.isfinite(b).any() else 1.0, 1.0)
    both = np.isfinite(a) & np.isfinite(b)
    off = np.where(both, np.abs(np.where(both, a - b, 0.0)) * scale, 0.0)
    off[np.isfinite(a) != np.isfinite(b)] = 255.0
    return Difference(name, float(off.mean()), float(np.percentile(off.max(axis=-1), 99)))


def targets(folder: Path, frame: Any) -> tuple[list[Difference], list[str]]:
    """Differences of the textures that the real engine kept, and those that are not there."""
    meta = json.loads((folder / "meta.json").read_text())
    found, missing = [], []
    for row in meta.get("targets", []):
        file = folder / "targets" / str(row.get("file"))
        if not file.exists() or row.get("d", 1) != 1 or row.get("faces", 1) != 1:
            continue
        label = str(row["label"])
        ours = frame.targets.get(label)
        if ours is None:
            missing.append(label)
            continue
        if file.suffix == ".npz":
            with np.load(file) as data:
                reference = data[data.files[0]]
        else:
            reference = np.asarray(Image.open(file))
        found.append(compare(label, ours, reference))
    return found, missing


def run(request: Request) -> Result:
    """Read, lint, plan, render and compare."""
    import nau_py
    from nau_py.diagnostics.errors import NauError, ProjectError

    result = Result(request.project, request.pipeline)
    try:
        project = nau_py.load(request.project)
        result.stage = "lint"
        found = nau_py.lint(project)
        result.errors = [f"{d.rule} {d.message}" for d in found if d.severity.value == "error"]
        result.warnings = sum(d.severity.value == "warning" for d in found)
        result.stage = "plan"
        for pipeline in project.pipelines:
            nau_py.plan(project, pipeline.name)
        result.stage = "run"
        keep = request.reference is not None
        start = time.perf_counter()
        renderer = nau_py.Renderer(project, request.pipeline, size=request.size, keep_targets=keep)
        renderer.render(0)
        result.first_ms = (time.perf_counter() - start) * 1000
        start = time.perf_counter()
        frame = renderer.render(FRAME)
        result.frame_ms = (time.perf_counter() - start) * 1000 / FRAME
    except ProjectError as wrong:
        result.stage = f"error at {result.stage}"
        result.message = "; ".join(f"{d.rule} {d.message}" for d in wrong.diagnostics)
        return result
    except NauError as wrong:
        result.stage = f"error at {result.stage}"
        result.message = str(wrong)
        return result
    image = frame.image
    if image.dtype != np.uint8:
        image = (np.clip(np.nan_to_num(image), 0, 1) * 255).astype(np.uint8)
    Image.fromarray(image[..., :3]).save(request.picture)
    if request.reference is not None:
        folder = Path(request.reference)
        final = np.asarray(Image.open(folder / "final.png").convert("RGB"))
        result.differences.append(compare("picture", image[..., :3], final))
        others, result.missing_targets = targets(folder, frame)
        result.differences += others
    return result


def main() -> None:
    request = Request(**json.loads(Path(sys.argv[1]).read_text()))
    request.size = tuple(request.size) if request.size else None  # type: ignore[assignment]
    print(json.dumps(asdict(run(request))))


if __name__ == "__main__":
    main()

"""What the viewer's child process does: renders a project as it is wanted, and keeps what it found.

A picture comes in steps: first a coarse one (a smaller one of one sample a pixel), then one of full
size, then the mean of more and more of those, each with random numbers of its own.
"""

from __future__ import annotations

import io
import zipfile
from dataclasses import dataclass, field, fields, replace
from math import isfinite, sqrt
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.accuracy.metrics import measure
from nau_py.accuracy.picture import enlarged, mask_of, picture
from nau_py.api import load
from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.diagnostics.errors import NauError
from nau_py.diagnostics.suggest import format_names
from nau_py.graph.resource import WINDOW
from nau_py.model.linked import Project
from nau_py.model.node import Configured, Setting
from nau_py.model.values import Scalar
from nau_py.passes.compute import ComputePass
from nau_py.passes.frame import Progress, RunOptions
from nau_py.passes.ray_query import RayQueryPass
from nau_py.reporting.output import exr, png
from nau_py.reporting.target_picture import difference, encoded, shown, thumbnail, tinted
from nau_py.run.frame import Frame
from nau_py.run.renderer import Renderer
from nau_py.run.used_files import PROGRAM, SHADER
from nau_py.scene.mesh import compute_bounding_box
from nau_py.viewer.camera import camera_with
from nau_py.viewer.controls import COLOURS, Values, home, parts_of

COARSE = 0.25
"""Size of the coarse picture, in parts of the full one."""
COARSE_PIXELS = 96
"""Pixels of its shorter side, at the least."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """What the picture is to be of. ``size``: the window's, or None for the project's own."""

    pipeline: str
    frame: int = 0
    values: tuple[tuple[str, tuple[Scalar, ...]], ...] = ()
    effects: str | None = None
    size: tuple[int, int] | None = None


@dataclass(slots=True)
class Shown:
    """One step of a picture. ``spp``: samples a pixel so far; ``error``: the estimated standard
    error of the traced pixels, None where that is not known; ``more``: another step would make it
    better."""

    png: bytes
    width: int
    height: int
    coarse: bool
    steps: int
    spp: int
    error: float | None
    ms: float
    more: bool
    report: dict[str, Any]
    targets: list[tuple[str, tuple[int, ...], str]] = field(default_factory=list)
    diagnostics: list[Diagnostic] = field(default_factory=list)


@dataclass(slots=True)
class Facts:
    """What only loading tells: the scene's box, and the materials that models bring."""

    low: tuple[float, ...]
    high: tuple[float, ...]
    materials: dict[str, dict[str, tuple[float, ...]]]


class Cancelled(NauError):
    """The picture in work is not wanted any more."""

    def __init__(self) -> None:
        super().__init__([])


class _Camera:
    """A renderer for one kind of picture, and what it has been told."""

    def __init__(self, renderer: Renderer) -> None:
        self.renderer = renderer
        self.told: Values = {}
        self.before: Values = {}
        """What was there before anything was told."""
        self.rendered = -1


class Studio:
    """Renders one project. ``tell`` is called while a pass works, and may raise
    :class:`Cancelled`."""

    def __init__(self, path: Path, options: RunOptions, tell: Progress) -> None:
        self.path, self.options, self._tell = path, options, tell
        self._cameras: dict[tuple[Any, ...], _Camera] = {}
        self._sum: NDArray[np.float64] | None = None
        self._mean: NDArray[np.float64] | None = None
        """The last picture of full size."""
        self._steps = 0
        self._of: Wanted | None = None
        self._frame: Frame | None = None
        self._pipeline = ""
        self._window = False
        """Whether the picture is the window's, no target's."""
        self._other: tuple[NDArray[np.float64], str] | None = None
        """The picture to compare with, and what it is called."""

    def close(self) -> None:
        for camera in self._cameras.values():
            camera.renderer.close()
        self._cameras.clear()

    def reload(self, kinds: dict[str, str]) -> None:
        """Take in files that have changed: path to kind (:mod:`nau_py.run.used_files`)."""
        self._of = None
        found = set(kinds.values())
        if not found <= {SHADER, PROGRAM}:
            self.close()
            return
        try:
            for camera in self._cameras.values():
                if SHADER in found:
                    files = {Path(p) for p, kind in kinds.items() if kind == SHADER}
                    camera.renderer.reload_shaders(files)
                if PROGRAM in found:
                    camera.renderer.reload_ray_programs()
        except NauError:
            self.close()  # what is half new is not kept
            raise

    def render(self, wanted: Wanted, coarse: bool) -> Shown:
        """The next step of a picture. Raises :class:`~nau_py.NauError`."""
        camera = self._camera(wanted, coarse)
        again = not coarse and wanted == self._of
        if not again and not coarse:
            self._of, self._sum, self._steps = None, None, 0
        seed = self.options.seed + (self._steps if again else 0)
        frame = self._render(camera, wanted, seed)
        if coarse:
            return self._step(frame, camera.renderer, frame.image, 1, coarse=True)
        self._window = camera.renderer.plan.output == WINDOW
        values = picture(frame, self._window)
        self._sum = values if self._sum is None else self._sum + values
        self._steps += 1
        self._mean = self._sum / self._steps
        self._of, self._frame = wanted, frame
        self._pipeline = wanted.pipeline
        image = frame.image if self._steps == 1 else self._mean
        return self._step(frame, camera.renderer, image, self._steps, coarse=False)

    def _step(
        self, frame: Frame, renderer: Renderer, image: NDArray[Any], steps: int, coarse: bool
    ) -> Shown:
        report = frame.report["frames"][-1]
        tracing = [p for p in report["passes"] if p["rays"]]
        errors = [p["est_error"] for p in tracing if p.get("est_error") is not None]
        known = [e for e in errors if isfinite(e)]
        spp = 0 if frame.samples is None else int(frame.samples.max(initial=0))
        error = max(known) / sqrt(steps) if known else None
        height, width = image.shape[:2]
        named = self._named(frame)
        targets = [(n, tuple(v.shape), str(v.dtype)) for n, v in named.items()]
        return Shown(
            png(image),
            width,
            height,
            coarse,
            steps,
            spp * steps,
            error,
            report["ms"],
            bool(tracing) and not coarse,
            frame.report,
            [] if coarse else targets,
            list(renderer.diagnostics),
        )

    def _camera(self, wanted: Wanted, coarse: bool) -> _Camera:
        key = (coarse, wanted.pipeline, wanted.effects, wanted.size)
        found = self._cameras.get(key)
        if found is not None:
            return found
        for other in [k for k in self._cameras if k[0] == coarse]:
            self._cameras.pop(other).renderer.close()
        self._cameras[key] = _Camera(self._renderer(wanted, coarse))
        return self._cameras[key]

    def _renderer(self, wanted: Wanted, coarse: bool) -> Renderer:
        project = load(self.path)
        size = wanted.size or project.size
        options = replace(self.options, effects=wanted.effects)
        pipeline = project.pipeline(wanted.pipeline)
        if coarse and pipeline is not None:
            options = replace(options, samples=1)
            if not any(isinstance(p, ComputePass | RayQueryPass) for p in pipeline.passes):
                size = _smaller(project, size)  # those count pixels by numbers of their own
        return Renderer(project, wanted.pipeline, size=size, options=options, progress=self._tell)

    def _render(self, camera: _Camera, wanted: Wanted, seed: int) -> Frame:
        renderer = camera.renderer
        self._apply(camera, dict(wanted.values))
        if camera.rendered == wanted.frame:
            return renderer.again(seed)
        first = camera.rendered + 1 if camera.rendered < wanted.frame else 0
        camera.rendered = -1
        for index in range(first, wanted.frame + 1):
            self._tell("", index, wanted.frame)  # a sign of work, and a chance to be cancelled
            frame = renderer.render(index)
        camera.rendered = wanted.frame
        return frame

    def _apply(self, camera: _Camera, values: Values) -> None:
        """Tell the renderer what has changed; what is no longer changed goes back to the file's."""
        gone = [key for key in camera.told if key not in values]
        wanted = {key: camera.before.get(key, ()) for key in gone} | values
        moved = set()
        for key, value in wanted.items():
            if camera.told.get(key) == value:
                continue
            if key.startswith("CAMERA|"):
                moved.add(parts_of(key)[1])
                continue
            if key not in camera.before:
                camera.before[key] = _present(camera.renderer, key)
            _set(camera.renderer, key, value)
        for name in moved:
            _aim(camera.renderer, name, values)
        camera.told = dict(values)

    def facts(self) -> Facts:
        """Of what was rendered last. Raises :class:`ValueError` before the first picture."""
        if not self._cameras:
            raise ValueError("nothing has been rendered yet")
        renderer = next(iter(self._cameras.values())).renderer
        world = renderer.session.world
        objects = [o for listed in world.scenes.values() for o in listed]
        low, high = compute_bounding_box(objects) if objects else (np.zeros(3), np.ones(3))
        found: dict[str, dict[str, tuple[float, ...]]] = {}
        for name in world.materials.default_names():
            material = world.materials.get("__nau_material_lib", name)
            if material is not None and not name.startswith("__"):
                colours = {c: tuple(map(float, material.colours[c])) for c in COLOURS}
                found[f"__nau_material_lib::{name}"] = colours
        return Facts(tuple(map(float, low[:3])), tuple(map(float, high[:3])), found)

    def thumbnails(self) -> list[tuple[str, bytes]]:
        """A small picture of every target of the last full frame."""
        return [
            (name, thumbnail(shown(values, depth=_is_depth(name, values))))
            for name, values in self._named(self._frame).items()
        ]

    def _named(self, frame: Frame | None) -> dict[str, NDArray[Any]]:
        """What can be looked at: the window, and every target."""
        if frame is None:
            return {}
        return ({"window": frame.image} if self._window else {}) | frame.targets

    def _target(self, name: str) -> NDArray[Any]:
        found = self._named(self._frame)
        if name not in found:
            raise KeyError(f"there is no target '{name}'; there is {format_names(list(found))}")
        return found[name]

    def target(self, name: str, channel: str, exposure: float, mask: bool) -> bytes:
        """A target as a PNG of its full size. Raises :class:`KeyError`."""
        values = self._target(name)
        pixels = shown(values, channel, exposure, _is_depth(name, values))
        chosen = self._mask() if mask else None
        return encoded(pixels if chosen is None else tinted(pixels, chosen))

    def _mask(self) -> NDArray[np.bool_] | None:
        for camera in self._cameras.values():
            pipeline = camera.renderer.pipeline
            if self._frame is not None and pipeline.name == self._pipeline:
                return mask_of(self._frame, pipeline)
        return None

    def pixel(self, name: str, x: int, y: int) -> list[float]:
        """The components of one texel, row 0 at the top. Raises :class:`KeyError`, also for a place
        outside."""
        values = self._target(name)
        height, width = values.shape[:2]
        if not (0 <= x < width and 0 <= y < height):
            raise KeyError(f"target '{name}' has no pixel ({x}, {y})")
        return [float(v) for v in values[y, x]]

    def keep(self, label: str) -> bytes:
        """Keep the present picture, to be compared with later ones. Raises :class:`ValueError`."""
        self._other = self._picture(), label
        return png(self._other[0])

    def render_other(self, wanted: Wanted, steps: int, label: str) -> bytes:
        """Render another picture to compare with: the mean of so many."""
        renderer = self._renderer(wanted, coarse=False)
        camera = _Camera(renderer)
        try:
            total: NDArray[np.float64] | None = None
            for step in range(max(steps, 1)):
                frame = self._render(camera, wanted, self.options.seed + step)
                values = picture(frame, renderer.plan.output == WINDOW)
                total = values if total is None else total + values
            assert total is not None
            self._other = total / max(steps, 1), label
            return png(self._other[0])
        finally:
            renderer.close()

    def compare(self) -> tuple[bytes, dict[str, float | None]]:
        """The difference of the present picture from the kept one, ten times as large, and the
        figures of docs/cost.md. Raises :class:`ValueError` where either is missing."""
        if self._other is None:
            raise ValueError("there is nothing to compare with yet")
        other = self._other[0]
        mine = enlarged(self._picture(), (other.shape[0], other.shape[1]))
        whole = {"picture": np.ones(other.shape[:2], bool)}
        found = measure(mine, other, whole)["picture"]
        figures = {
            "rmse": found.rmse,
            "relMSE": found.relmse,
            "PSNR": found.psnr,
            "SSIM": found.ssim,
            "FLIP": found.flip,
            "greatest": float(np.nanmax(np.abs(mine - other))),
        }
        return encoded(difference(mine, other)), {
            k: v if v is not None and isfinite(v) else None for k, v in figures.items()
        }

    def export_exr(self) -> bytes:
        """The present picture as floats. Raises :class:`~nau_py.OutputError` without the
        extra ``exr``."""
        return exr(Path("picture.exr"), self._picture().astype(np.float32))

    def _picture(self) -> NDArray[np.float64]:
        if self._mean is None:
            raise ValueError("there is no picture yet")
        return self._mean

    def sequence(self, wanted: Wanted, first: int, last: int) -> bytes:
        """A ZIP of PNGs, one a frame."""
        stream = io.BytesIO()
        renderer = self._renderer(wanted, coarse=False)
        camera = _Camera(renderer)
        try:
            with zipfile.ZipFile(stream, "w") as archive:
                for index in range(first, last + 1):
                    frame = self._render(camera, replace(wanted, frame=index), self.options.seed)
                    archive.writestr(f"frame.{index:04d}.png", png(frame.image))
        finally:
            renderer.close()
        return stream.getvalue()


def _is_depth(name: str, values: NDArray[Any]) -> bool:
    return values.shape[2] == 1 and values.dtype.kind == "f" and "depth" in name.lower()


def _set(renderer: Renderer, key: str, value: tuple[Scalar, ...]) -> None:
    type_, context, component = parts_of(key)
    if type_ == "MASK":
        node = home(renderer.project, key)
        if node is not None:
            setattr(node, component, value[0])
        return
    renderer.set_attribute(type_, context, component, value)


def _aim(renderer: Renderer, name: str, values: Values) -> None:
    """Put a camera where the file would have it with these values."""
    wanted = camera_with(renderer.project, name, values)
    state = renderer.session.world.camera(name)
    if wanted is not None and state.name == name:
        for field_ in fields(state):
            setattr(state, field_.name, getattr(wanted, field_.name))


def _present(renderer: Renderer, key: str) -> tuple[Scalar, ...]:
    """The value before any change."""
    project = renderer.project
    type_, context, component = parts_of(key)
    node = home(project, key)
    if type_ == "MASK":
        return (getattr(node, component),) if node is not None else (0.0,)
    if type_ == "COLOR":
        library, _, name = context.partition("::")
        material = renderer.session.world.materials.get(library, name)
        return tuple(material.colours[component]) if material is not None else ()
    if isinstance(node, Configured):
        return project.value(node, type_, component)
    return project.default(type_, component)


def _smaller(project: Project, size: tuple[int, int]) -> tuple[int, int]:
    """Shrink every render target, and the window."""
    share = min(max(COARSE, COARSE_PIXELS / min(size)), 1.0)

    def small(number: Scalar) -> int:
        return max(round(project.number(number) * share), 1)

    for library in project.libraries:
        for target in library.renderTargets:
            written = target.settings.get("SIZE")
            if written is not None:
                target.settings["SIZE"] = Setting(tuple(small(p) for p in written.parts))
    return small(size[0]), small(size[1])

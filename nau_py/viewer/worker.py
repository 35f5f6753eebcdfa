"""Worker process of the viewer: renders a project with changed values, and keeps the last picture.

A picture comes in steps: first a coarse one (smaller, one sample a pixel), then one of full size,
then the mean of more and more of those, each with its own random numbers.
"""

from __future__ import annotations

import io
import zipfile
from dataclasses import replace
from math import isfinite, sqrt
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.accuracy.metrics import measure_errors
from nau_py.accuracy.picture import enlarge, find_traced_pixels, to_picture
from nau_py.api import load
from nau_py.diagnostics.errors import NauError
from nau_py.diagnostics.suggest import format_names
from nau_py.graph.resource import WINDOW
from nau_py.passes.compute import ComputePass
from nau_py.passes.frame import Progress, RunOptions
from nau_py.passes.ray_query import RayQueryPass
from nau_py.process.worker import serve
from nau_py.reporting.output import exr
from nau_py.reporting.pixels import encode_png, tint
from nau_py.reporting.target_picture import (
    FAST,
    display_difference,
    display_target,
    encode_thumbnail,
)
from nau_py.run.frame import Frame
from nau_py.run.renderer import Renderer
from nau_py.run.used_files import PROGRAM, SHADER
from nau_py.scene.mesh import compute_bounding_box
from nau_py.viewer.controls import COLOURS
from nau_py.viewer.request import PictureRequest, PictureStep, SceneSummary
from nau_py.viewer.steered_renderer import SteeredRenderer, shrink_targets


class RenderWorker:
    """Renderer of one project in several sizes and pipelines. ``report`` is called while a pass
    works, and may raise :class:`~nau_py.process.worker.RequestCancelled`."""

    def __init__(self, path: Path, options: RunOptions, report: Progress) -> None:
        self.path, self.options, self._report = path, options, report
        self._renderers: dict[tuple[bool, str, str | None, tuple[int, int] | None], SteeredRenderer]
        self._renderers = {}
        self._sum: NDArray[np.float64] | None = None
        self._mean: NDArray[np.float64] | None = None
        """The last picture of full size."""
        self._steps = 0
        self._request: PictureRequest | None = None
        self._frame: Frame | None = None
        self._pipeline = ""
        self._window = False
        """True if the picture is the window's, False for a target's."""
        self._other: tuple[NDArray[np.float64], str] | None = None
        """The picture to compare with, and its label."""

    def close(self) -> None:
        for steered in self._renderers.values():
            steered.renderer.close()
        self._renderers.clear()

    def reload(self, kinds: dict[str, str]) -> None:
        """Reload changed files: path to kind (:mod:`nau_py.run.used_files`)."""
        self._request = None
        found = set(kinds.values())
        if not found <= {SHADER, PROGRAM}:
            self.close()
            return
        try:
            for steered in self._renderers.values():
                if SHADER in found:
                    files = {Path(p) for p, kind in kinds.items() if kind == SHADER}
                    steered.renderer.reload_shaders(files)
                if PROGRAM in found:
                    steered.renderer.reload_ray_programs()
        except NauError:
            self.close()  # keep no half reloaded renderer
            raise

    def render(self, request: PictureRequest, coarse: bool) -> PictureStep:
        """Render the next step of a picture. Raises :class:`~nau_py.NauError`."""
        steered = self._steered(request, coarse)
        again = not coarse and request == self._request
        if not again and not coarse:
            self._request, self._sum, self._steps = None, None, 0
        seed = self.options.seed + (self._steps if again else 0)
        frame = steered.render(request, seed, self._report)
        if coarse:
            return self._step(frame, steered.renderer, frame.image, 1, coarse=True)
        self._window = steered.renderer.plan.output == WINDOW
        values = to_picture(frame, self._window)
        self._sum = values if self._sum is None else self._sum + values
        self._steps += 1
        self._mean = self._sum / self._steps
        self._request, self._frame = request, frame
        self._pipeline = request.pipeline
        image = frame.image if self._steps == 1 else self._mean
        return self._step(frame, steered.renderer, image, self._steps, coarse=False)

    def _step(
        self, frame: Frame, renderer: Renderer, image: NDArray[Any], steps: int, coarse: bool
    ) -> PictureStep:
        report = frame.report["frames"][-1]
        tracing = [p for p in report["passes"] if p["rays"]]
        errors = [p["est_error"] for p in tracing if p.get("est_error") is not None]
        known = [e for e in errors if isfinite(e)]
        spp = 0 if frame.samples is None else int(frame.samples.max(initial=0))
        error = max(known) / sqrt(steps) if known else None
        height, width = image.shape[:2]
        named = self._named(frame)
        targets = [(n, tuple(v.shape), str(v.dtype)) for n, v in named.items()]
        return PictureStep(
            encode_png(image),
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

    def _steered(self, request: PictureRequest, coarse: bool) -> SteeredRenderer:
        key = (coarse, request.pipeline, request.effects, request.size)
        found = self._renderers.get(key)
        if found is not None:
            return found
        for other in [k for k in self._renderers if k[0] == coarse]:
            self._renderers.pop(other).renderer.close()
        self._renderers[key] = SteeredRenderer(self._renderer(request, coarse))
        return self._renderers[key]

    def _renderer(self, request: PictureRequest, coarse: bool) -> Renderer:
        project = load(self.path)
        size = request.size or project.size
        options = replace(self.options, effects=request.effects)
        pipeline = project.pipeline(request.pipeline)
        if coarse and pipeline is not None:
            options = replace(options, samples=1)
            if not any(isinstance(p, ComputePass | RayQueryPass) for p in pipeline.passes):
                size = shrink_targets(project, size)  # those two have pixel counts of their own
        return Renderer(
            project, request.pipeline, size=size, options=options, progress=self._report
        )

    def summarize_scene(self) -> SceneSummary:
        """Summarize the scene. Raises :class:`ValueError` before the first picture."""
        if not self._renderers:
            raise ValueError("nothing has been rendered yet")
        renderer = next(iter(self._renderers.values())).renderer
        world = renderer.session.world
        objects = [o for listed in world.scenes.values() for o in listed]
        low, high = compute_bounding_box(objects) if objects else (np.zeros(3), np.ones(3))
        found: dict[str, dict[str, tuple[float, ...]]] = {}
        for name in world.materials.default_names():
            material = world.materials.get("__nau_material_lib", name)
            if material is not None and not name.startswith("__"):
                colours = {c: tuple(map(float, material.colours[c])) for c in COLOURS}
                found[f"__nau_material_lib::{name}"] = colours
        return SceneSummary(tuple(map(float, low[:3])), tuple(map(float, high[:3])), found)

    def thumbnails(self) -> list[tuple[str, bytes]]:
        """Return the name and a small PNG of every target of the last full frame."""
        return [
            (name, encode_thumbnail(display_target(values, depth=_is_depth(name, values))))
            for name, values in self._named(self._frame).items()
        ]

    def _named(self, frame: Frame | None) -> dict[str, NDArray[Any]]:
        """Return the pictures of a frame by name: the window, and every target."""
        if frame is None:
            return {}
        return ({"window": frame.image} if self._window else {}) | frame.targets

    def _target(self, name: str) -> NDArray[Any]:
        found = self._named(self._frame)
        if name not in found:
            raise KeyError(f"there is no target '{name}'; there is {format_names(list(found))}")
        return found[name]

    def target(self, name: str, channel: str, exposure: float, mask: bool) -> bytes:
        """Return a target as a PNG of its full size. Raises :class:`KeyError`."""
        values = self._target(name)
        pixels = display_target(values, channel, exposure, _is_depth(name, values))
        chosen = self._mask() if mask else None
        if chosen is not None and chosen.shape == pixels.shape[:2]:
            pixels = tint(pixels, chosen.astype(np.float64))
        return encode_png(pixels, FAST)

    def _mask(self) -> NDArray[np.bool_] | None:
        for steered in self._renderers.values():
            pipeline = steered.renderer.pipeline
            if self._frame is not None and pipeline.name == self._pipeline:
                return find_traced_pixels(self._frame, pipeline)
        return None

    def pixel(self, name: str, x: int, y: int) -> list[float]:
        """Return the components of one texel, row 0 at the top. Raises :class:`KeyError` for an
        unknown target and a place outside of it."""
        values = self._target(name)
        height, width = values.shape[:2]
        if not (0 <= x < width and 0 <= y < height):
            raise KeyError(f"target '{name}' has no pixel ({x}, {y})")
        return [float(v) for v in values[y, x]]

    def keep(self, label: str) -> bytes:
        """Keep the present picture, to compare later ones with it. Raises :class:`ValueError`."""
        self._other = self._picture(), label
        return encode_png(self._other[0])

    def render_other(self, request: PictureRequest, steps: int, label: str) -> bytes:
        """Render another picture to compare with, the mean of ``steps`` ones; return its PNG."""
        renderer = self._renderer(request, coarse=False)
        steered = SteeredRenderer(renderer)
        try:
            total: NDArray[np.float64] | None = None
            for step in range(max(steps, 1)):
                frame = steered.render(request, self.options.seed + step, self._report)
                values = to_picture(frame, renderer.plan.output == WINDOW)
                total = values if total is None else total + values
            assert total is not None
            self._other = total / max(steps, 1), label
            return encode_png(self._other[0])
        finally:
            renderer.close()

    def compare(self) -> tuple[bytes, dict[str, float | None]]:
        """Return the tenfold difference of the present picture from the kept one, as a PNG, and the
        measures of docs/cost.md. Raises :class:`ValueError` if either is missing."""
        if self._other is None:
            raise ValueError("there is nothing to compare with yet")
        other = self._other[0]
        mine = enlarge(self._picture(), (other.shape[0], other.shape[1]))
        whole = {"picture": np.ones(other.shape[:2], bool)}
        found = measure_errors(mine, other, whole)["picture"]
        figures = {
            "rmse": found.rmse,
            "relMSE": found.relmse,
            "PSNR": found.psnr,
            "SSIM": found.ssim,
            "FLIP": found.flip,
            "greatest": float(np.nanmax(np.abs(mine - other))),
        }
        return encode_png(display_difference(mine, other), FAST), {
            k: v if v is not None and isfinite(v) else None for k, v in figures.items()
        }

    def export_exr(self) -> bytes:
        """Return the present picture as an EXR of floats.

        Raises :class:`~nau_py.OutputError` without the extra ``exr``.
        """
        return exr(Path("picture.exr"), self._picture().astype(np.float32))

    def _picture(self) -> NDArray[np.float64]:
        if self._mean is None:
            raise ValueError("there is no picture yet")
        return self._mean

    def sequence(self, request: PictureRequest, first: int, last: int) -> bytes:
        """Return a ZIP of PNGs, one for each frame."""
        stream = io.BytesIO()
        renderer = self._renderer(request, coarse=False)
        steered = SteeredRenderer(renderer)
        try:
            with zipfile.ZipFile(stream, "w") as archive:
                for index in range(first, last + 1):
                    frame = steered.render(
                        replace(request, frame=index), self.options.seed, self._report
                    )
                    archive.writestr(f"frame.{index:04d}.png", encode_png(frame.image))
        finally:
            renderer.close()
        return stream.getvalue()


def _is_depth(name: str, values: NDArray[Any]) -> bool:
    return values.shape[2] == 1 and values.dtype.kind == "f" and "depth" in name.lower()


def main() -> None:
    """Entry point of the worker process."""
    serve(lambda setup, report: RenderWorker(Path(setup[0]), setup[1], report))

"""Viewports in pixels (docs/format.md, 9.3)."""

from __future__ import annotations

from dataclasses import dataclass

from nau_py.model.linked import Project
from nau_py.model.viewport import Viewport


@dataclass(frozen=True, slots=True)
class Rect:
    """A rectangle in pixels, lower left corner first, with a clear colour.

    OpenGL gets fractions of pixels unrounded.
    """

    x: float
    y: float
    width: float
    height: float
    clear: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)

    @property
    def aspect(self) -> float:
        return self.width / self.height if self.height > 0 else 0.0

    @property
    def scissor(self) -> tuple[int, int, int, int]:
        """Whole pixels: x, y, width, height."""
        return int(self.x), int(self.y), int(self.width), int(self.height)


def compute_viewport_rect(
    project: Project, viewport: Viewport | None, window: tuple[int, int]
) -> Rect:
    """Compute the rectangle of a viewport in a window of ``window`` (width, height) pixels."""
    width, height = float(window[0]), float(window[1])
    if viewport is None:
        return Rect(0.0, 0.0, width, height)
    clear = _four(project.value(viewport, "VIEWPORT", "CLEAR_COLOR"))
    settings = viewport.settings
    full = bool(project.value(viewport, "VIEWPORT", "FULL")[0])
    placed = [k for k in ("ORIGIN", "SIZE", "RATIO") if k in settings]
    if not placed or (full and "FULL" in settings and list(settings)[-1] == "FULL"):
        return Rect(0.0, 0.0, width, height, clear)
    ox, oy = (float(v) for v in project.value(viewport, "VIEWPORT", "ORIGIN"))
    sx, sy = (float(v) for v in project.value(viewport, "VIEWPORT", "SIZE"))
    ratio = float(project.value(viewport, "VIEWPORT", "RATIO")[0])
    x = ox * width if ox < 1 else ox
    y = oy * height if oy < 1 else oy
    w = sx * width if sx <= 1 else sx
    h = sy * height if sy <= 1 else sy
    if ratio > 0:
        h = w / ratio
    return Rect(x, y, w, h, clear)


def _four(values: tuple[object, ...]) -> tuple[float, float, float, float]:
    r, g, b, a = (float(v) for v in values)  # type: ignore[arg-type]
    return r, g, b, a

"""Values that pass between the viewer and its worker process."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.model.values import Scalar


@dataclass(frozen=True, slots=True)
class PictureRequest:
    """Subject of a picture. ``values``: changed controls, key and value, sorted; ``effects``: as
    ``--effects``; ``size``: the window's width and height, None for the project's own."""

    pipeline: str
    frame: int = 0
    values: tuple[tuple[str, tuple[Scalar, ...]], ...] = ()
    effects: str | None = None
    size: tuple[int, int] | None = None


@dataclass(slots=True)
class PictureStep:
    """One step of a picture. ``steps``: pictures averaged so far; ``spp``: samples a pixel so far;
    ``error``: estimated standard error of the traced pixels, None if unknown; ``more``: True if
    another step would improve it; ``targets``: name, shape and type of each target."""

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
class SceneSummary:
    """Facts that only loading the models gives: the scene's bounding box in world space, and the
    colours of the materials that models bring, by name and component."""

    low: tuple[float, ...]
    high: tuple[float, ...]
    materials: dict[str, dict[str, tuple[float, ...]]]

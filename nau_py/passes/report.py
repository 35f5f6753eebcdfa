"""Reports of passes: the work they did and the time it took."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class PassReport:
    """Work of one execution of a pass.

    ``pixels``: drawn or traced. ``rays``: count by kind. ``avoided``: primary rays that were not
    traced. ``left_out``: the reason, where the pass found nothing to do. ``stages``: milliseconds
    by stage, where a pass has several. ``samples`` and ``error``: samples and estimated standard
    error of each pixel of a raytrace pass's target, (height, width), row 0 at the bottom; the error
    is infinite where one sample decides it alone, 0 where nothing was traced.
    """

    pixels: int = 0
    rays: Mapping[str, int] = field(default_factory=dict)
    avoided: int = 0
    left_out: str = ""
    est_error: float | None = None
    nonfinite: int = 0
    """Samples or rays whose value is not finite."""
    blame: str = ""
    """Source of the first value that is not finite, as the end of a message."""
    notes: tuple[str, ...] = ()
    stages: Mapping[str, float] = field(default_factory=dict)
    samples: NDArray[np.int32] | None = None
    error: NDArray[np.float32] | None = None
    effects: tuple[dict[str, Any], ...] = ()
    """Effects that a raytrace pass simulates and leaves out (docs/report.md)."""

    def then(self, later: PassReport) -> PassReport:
        """Return the report of two executions in one frame: ``later`` replaces everything but
        notes and stages, which add up."""
        stages = dict(self.stages)
        for name, ms in later.stages.items():
            stages[name] = stages.get(name, 0.0) + ms
        return replace(later, notes=self.notes + later.notes, stages=stages)


@dataclass(frozen=True, slots=True)
class PassRecord:
    """Outcome of one pass of a frame. ``status``: ``run`` or ``left_out``, then with ``reason``."""

    name: str
    pass_class: str
    status: str = "run"
    reason: str = ""
    ms: float = 0.0
    report: PassReport = field(default_factory=PassReport)


class Stages:
    """Stopwatch for the stages of a pass. ``ms``: milliseconds by name of stage."""

    def __init__(self) -> None:
        self.ms: dict[str, float] = {}
        self._begun = perf_counter()

    def end(self, name: str) -> None:
        """Count the time since the last stage ended as stage ``name``."""
        now = perf_counter()
        self.ms[name] = self.ms.get(name, 0.0) + (now - self._begun) * 1000
        self._begun = now

    def move(self, source: str, target: str, share: float) -> None:
        """Move the part ``share`` (0 to 1) of one stage's time to another stage."""
        whole = self.ms[source]
        self.ms[source] = whole * (1 - share)
        self.ms[target] = self.ms.get(target, 0.0) + whole * share

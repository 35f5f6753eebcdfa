"""Result of a cost run."""

from __future__ import annotations

from dataclasses import dataclass

from nau_py.accuracy.candidate import Candidate
from nau_py.accuracy.front_chart import draw_front, write_excerpt
from nau_py.accuracy.measure import Measured, Reference
from nau_py.accuracy.report import CostReport
from nau_py.diagnostics.diagnostic import Diagnostic


@dataclass(slots=True)
class CostRun:
    """A report, and the pictures that it was made from. ``chosen``: the setting that meets a target
    error or a time budget; ``diagnostics``: warnings of lint."""

    report: CostReport
    reference: Reference
    measured: list[Measured]
    chosen: Candidate | None
    diagnostics: list[Diagnostic]

    def _repr_png_(self) -> bytes | None:
        """Draw the front, for notebooks."""
        return draw_front(self.report)

    def _repr_html_(self) -> str:
        """Write the front, the answers and all numbers, for notebooks."""
        return write_excerpt(self.report)

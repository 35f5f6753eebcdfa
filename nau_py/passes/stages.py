"""The stages of a pass: where its time goes."""

from __future__ import annotations

from time import perf_counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from nau_py.passes.frame import PassRecord


class Stages:
    """Writes the milliseconds of each stage into the record of a pass."""

    def __init__(self, record: PassRecord) -> None:
        self._stages = record.stages
        self._begun = perf_counter()

    def end(self, name: str) -> None:
        """What was done since the last stage ended was stage ``name``."""
        now = perf_counter()
        self._stages[name] = self._stages.get(name, 0.0) + (now - self._begun) * 1000
        self._begun = now

    def move(self, source: str, target: str, share: float) -> None:
        """The part ``share`` of a stage belongs to another one."""
        whole = self._stages[source]
        self._stages[source] = whole * (1 - share)
        self._stages[target] = self._stages.get(target, 0.0) + whole * share

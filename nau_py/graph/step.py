"""One pass of a plan."""

from __future__ import annotations

from dataclasses import dataclass

from nau_py.graph.contract import Access
from nau_py.model.passes import Pass


@dataclass(frozen=True, slots=True)
class Step:
    """One pass of the plan. ``reason`` explains why it is left out, and is empty if it runs."""

    pass_: Pass
    access: Access
    run: bool
    reason: str = ""

    @property
    def name(self) -> str:
        return self.pass_.name or ""

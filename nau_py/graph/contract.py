"""What the graph must know of a pass class; :mod:`nau_py.passes` provides it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Protocol

from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.graph.resource import Resource
from nau_py.model.linked import Project
from nau_py.model.passes import Pass


@dataclass(slots=True)
class Access:
    """What one pass reads and writes, in a stable order.

    ``replaces`` holds the written resources of which nothing earlier remains; ``keeps`` those read
    ones that are drawn over without being cleared, rather than sampled.
    """

    reads: list[Resource] = field(default_factory=list)
    writes: list[Resource] = field(default_factory=list)
    replaces: list[Resource] = field(default_factory=list)
    keeps: list[Resource] = field(default_factory=list)

    def add_read(self, resource: Resource) -> None:
        if resource not in self.reads:
            self.reads.append(resource)

    def add_write(self, resource: Resource) -> None:
        if resource not in self.writes:
            self.writes.append(resource)


class Contract(Protocol):
    """The pure half of a pass class: no context, no execution."""

    def access(self, project: Project, pass_: Pass) -> Access: ...

    def faults(self, project: Project, pass_: Pass) -> Iterable[Diagnostic]: ...


Contracts = Mapping[str, Contract]
"""Contracts by pass class."""

"""The interface between the graph and the pass classes, which :mod:`nau_py.passes` provides."""

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
    """Resources that one pass reads and writes, in a stable order.

    ``replaces`` holds the written resources whose earlier content is lost. ``keeps`` holds the
    read resources that the pass draws over without clearing them, and does not sample.
    """

    reads: list[Resource] = field(default_factory=list)
    writes: list[Resource] = field(default_factory=list)
    replaces: list[Resource] = field(default_factory=list)
    keeps: list[Resource] = field(default_factory=list)

    def add_read(self, resource: Resource) -> None:
        """Append ``resource`` to ``reads``, once."""
        if resource not in self.reads:
            self.reads.append(resource)

    def add_write(self, resource: Resource) -> None:
        """Append ``resource`` to ``writes``, once."""
        if resource not in self.writes:
            self.writes.append(resource)


class Contract(Protocol):
    """The part of a pass class that the graph uses. It needs no context and executes nothing."""

    def access(self, project: Project, pass_: Pass) -> Access:
        """List the resources that ``pass_`` reads and writes."""
        ...

    def faults(self, project: Project, pass_: Pass) -> Iterable[Diagnostic]: ...


Contracts = Mapping[str, Contract]
"""Contracts by the name of the pass class."""

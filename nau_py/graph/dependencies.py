"""Dependencies between the passes of a pipeline, from the resources they read and write.

Plain data: the lint rules use it at every start, and importing networkx takes a quarter of a
second. :mod:`nau_py.graph.network` builds the networkx graph from it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from nau_py.graph.contract import Access, Contracts
from nau_py.graph.resource import Resource
from nau_py.model.linked import Project
from nau_py.model.passes import Pass
from nau_py.model.pipeline import Pipeline

Hazard = Literal["read after write", "write after read", "write after write"]


@dataclass(frozen=True, slots=True)
class Dependency:
    """``later`` must run after ``earlier`` because of ``resource``. Indices into the pipeline.

    ``earlier`` < ``later`` always: a pass that reads a resource before it is written reads the
    content of the previous frame. File order therefore satisfies every dependency, and is the
    order in which passes run.
    """

    earlier: int
    later: int
    resource: Resource
    hazard: Hazard


@dataclass(slots=True)
class Dependencies:
    """The passes of a pipeline with their accesses and the dependencies between them."""

    passes: list[Pass]
    accesses: list[Access]
    edges: list[Dependency] = field(default_factory=list)
    history: list[tuple[int, Resource]] = field(default_factory=list)
    """Reads, by index of the pass, of resources that only a later pass writes. They see the
    content of the previous frame."""

    def writers(self, resource: Resource) -> list[int]:
        """List the indices of the passes that write ``resource``."""
        return [i for i, access in enumerate(self.accesses) if resource in access.writes]

    def previous_frame_reads(self) -> list[tuple[int, Resource]]:
        """Select from ``history`` the passes that do not write the resource themselves.

        A pass that also writes it may do so before it reads.
        """
        return [(i, r) for i, r in self.history if r not in self.accesses[i].writes]

    def has_frame_cycle(self) -> bool:
        """Decide if some pass receives its own result of the previous frame."""
        flow = [(e.earlier, e.later) for e in self.edges if e.hazard == "read after write"]
        closing = [(self.writers(r)[-1], i) for i, r in self.previous_frame_reads()]
        flow += closing
        for _, start in closing:
            reached: set[int] = set()
            found = {start}
            while found:
                reached |= found
                found = {later for earlier, later in flow if earlier in found}
                if start in found:
                    return True
                found -= reached
        return False


def list_access(project: Project, pass_: Pass, contracts: Contracts) -> Access:
    """List what a pass reads and writes: nothing for an unknown class."""
    contract = contracts.get(pass_.pass_class)
    return contract.access(project, pass_) if contract else Access()


def find_dependencies(project: Project, pipeline: Pipeline, contracts: Contracts) -> Dependencies:
    """Find the dependencies between the passes of ``pipeline`` from the project's data alone."""
    accesses = [list_access(project, p, contracts) for p in pipeline.passes]
    found = Dependencies(list(pipeline.passes), accesses)
    last_writer: dict[Resource, int] = {}
    readers: dict[Resource, list[int]] = {}
    for index, access in enumerate(accesses):
        for resource in access.reads:
            writer = last_writer.get(resource)
            if writer is not None and writer != index:
                found.edges.append(Dependency(writer, index, resource, "read after write"))
            elif writer is None and any(
                resource in later.writes for later in accesses[index + 1 :]
            ):
                found.history.append((index, resource))
            readers.setdefault(resource, []).append(index)
        for resource in access.writes:
            for reader in readers.pop(resource, []):
                if reader != index:
                    found.edges.append(Dependency(reader, index, resource, "write after read"))
            writer = last_writer.get(resource)
            if writer is not None and writer != index:
                found.edges.append(Dependency(writer, index, resource, "write after write"))
            last_writer[resource] = index
    return found

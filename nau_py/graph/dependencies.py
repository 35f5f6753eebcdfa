"""Edges between the passes of a pipeline, from what they read and write."""

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
class Edge:
    """``later`` must run after ``earlier`` because of ``resource``. Indices into the pipeline.

    ``earlier`` < ``later`` always: what a pass reads before it is written is the previous frame's.
    File order therefore satisfies every edge, and is the order in which passes run.
    """

    earlier: int
    later: int
    resource: Resource
    hazard: Hazard


@dataclass(slots=True)
class PassGraph:
    """The passes of a pipeline with their accesses and edges."""

    passes: list[Pass]
    accesses: list[Access]
    edges: list[Edge] = field(default_factory=list)
    history: list[tuple[int, Resource]] = field(default_factory=list)
    """Reads of what only a later pass writes: the content of the previous frame."""

    def writers(self, resource: Resource) -> list[int]:
        return [i for i, access in enumerate(self.accesses) if resource in access.writes]


def access_of(project: Project, pass_: Pass, contracts: Contracts) -> Access:
    """What a pass reads and writes; nothing for a class that is not known."""
    contract = contracts.get(pass_.pass_class)
    return contract.access(project, pass_) if contract else Access()


def build(project: Project, pipeline: Pipeline, contracts: Contracts) -> PassGraph:
    """The graph of ``pipeline``. Pure: reads only the project's data."""
    accesses = [access_of(project, p, contracts) for p in pipeline.passes]
    graph = PassGraph(list(pipeline.passes), accesses)
    last_writer: dict[Resource, int] = {}
    readers: dict[Resource, list[int]] = {}
    for index, access in enumerate(accesses):
        for resource in access.reads:
            writer = last_writer.get(resource)
            if writer is not None and writer != index:
                graph.edges.append(Edge(writer, index, resource, "read after write"))
            elif writer is None and any(
                resource in later.writes for later in accesses[index + 1 :]
            ):
                graph.history.append((index, resource))
            readers.setdefault(resource, []).append(index)
        for resource in access.writes:
            for reader in readers.pop(resource, []):
                if reader != index:
                    graph.edges.append(Edge(reader, index, resource, "write after read"))
            writer = last_writer.get(resource)
            if writer is not None and writer != index:
                graph.edges.append(Edge(writer, index, resource, "write after write"))
            last_writer[resource] = index
    return graph

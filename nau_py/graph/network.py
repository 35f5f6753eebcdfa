"""The graph of a plan in networkx, and what networkx computes from it.

A :data:`Network` is a ``networkx.DiGraph`` with plain values, so that
``networkx.node_link_data`` makes JSON of it. Its ``graph`` attributes are ``project`` and
``pipeline``.

=============================== ================================================================
node                            attributes
=============================== ================================================================
``pass NAME``                   ``kind`` ("pass"), ``name``, ``class``, ``index`` (from 0, in file
                                order), ``runs``, ``reason`` (why it is left out, else ""),
                                ``location`` ("file:line:col"), ``programs``
                                (:func:`~nau_py.graph.programs.list_programs`)
``texture L::T``, ``buffer      ``kind`` ("texture", "buffer", "window"), ``name``, ``output`` (the
L::B``, ``window``              picture is read from it)
=============================== ================================================================

=================== ========= ==================================================================
edge                ``kind``  further attributes
=================== ========= ==================================================================
pass → resource     "write"   ``replaces``: nothing of the earlier content remains
resource → pass     "read"    ``draws_over``: drawn over without clearing, not sampled;
                              ``previous_frame``: only a later pass writes it
earlier → later     "order"   ``hazards``: a list of ``resource`` and ``hazard``, the reasons for
pass                          the order
=================== ========= ==================================================================

:func:`mark_times` adds ``ms`` (milliseconds, to passes) and ``critical`` (to nodes and edges).
Two passes of one name are told apart by their index, as in ``pass NAME (3)``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import networkx as nx

from nau_py.graph.dependencies import Dependencies
from nau_py.graph.programs import list_programs
from nau_py.graph.resource import Resource
from nau_py.graph.step import Step

Network: TypeAlias = "nx.DiGraph[str]"


def build_graph(
    project: str,
    pipeline: str,
    steps: Sequence[Step],
    dependencies: Dependencies,
    output: Resource,
) -> Network:
    """Build the graph of a plan: passes, resources, accesses and order."""
    graph: Network = nx.DiGraph(project=project, pipeline=pipeline)
    keys: list[str] = []
    for index, step in enumerate(steps):
        key = f"pass {step.name}"
        keys.append(key if key not in keys else f"{key} ({index})")
        graph.add_node(
            keys[-1],
            **{"class": step.pass_.pass_class},
            kind="pass",
            name=step.name,
            index=index,
            runs=step.run,
            reason=step.reason,
            location=str(step.pass_.location),
            programs=list_programs(step.pass_),
        )
    previous = set(dependencies.previous_frame_reads())
    for index, (key, step) in enumerate(zip(keys, steps)):
        access = step.access
        for resource in [*access.reads, *access.writes]:
            graph.add_node(
                str(resource), kind=resource.kind, name=resource.name, output=resource == output
            )
        for resource in access.reads:
            graph.add_edge(
                str(resource),
                key,
                kind="read",
                draws_over=resource in access.keeps,
                previous_frame=(index, resource) in previous,
            )
        for resource in access.writes:
            graph.add_edge(key, str(resource), kind="write", replaces=resource in access.replaces)
    for edge in dependencies.edges:
        earlier, later = keys[edge.earlier], keys[edge.later]
        if not graph.has_edge(earlier, later):
            graph.add_edge(earlier, later, kind="order", hazards=[])
        graph.edges[earlier, later]["hazards"].append(
            {"resource": str(edge.resource), "hazard": edge.hazard}
        )
    return graph


def list_passes(graph: Network) -> list[str]:
    """List the nodes of passes, in file order."""
    return [node for node in graph if graph.nodes[node]["kind"] == "pass"]


def list_resources(graph: Network) -> list[str]:
    """List the nodes of resources, in the order of their first use."""
    return [node for node in graph if graph.nodes[node]["kind"] != "pass"]


def number_passes(graph: Network) -> dict[str, int]:
    """Map the nodes of passes to their indices in the file."""
    return {node: int(graph.nodes[node]["index"]) for node in list_passes(graph)}


def extract_order(graph: Network) -> Network:
    """Copy the passes and the order between them: an acyclic graph.

    ``DiGraph.subgraph`` would do, but lists its nodes in the order of a set.
    """
    order: Network = nx.DiGraph(**graph.graph)
    order.add_nodes_from((node, graph.nodes[node]) for node in list_passes(graph))
    edges = [(a, b) for a, b in graph.edges if graph.edges[a, b]["kind"] == "order"]
    order.add_edges_from((a, b, graph.edges[a, b]) for a, b in edges)
    return order


def sort_passes(graph: Network) -> list[str]:
    """Sort the passes topologically; passes that are free keep their order in the file.

    Every dependency leads from an earlier pass of the file to a later one, so this is the file's
    order (:class:`~nau_py.graph.dependencies.Dependency`).
    """
    index = number_passes(graph)
    return list(nx.lexicographical_topological_sort(extract_order(graph), key=index.__getitem__))


def reduce_order(graph: Network) -> Network:
    """Copy the order between passes without what follows from the rest (transitive reduction)."""
    order = extract_order(graph)
    reduced = nx.transitive_reduction(order)
    order.remove_edges_from([edge for edge in order.edges if edge not in reduced.edges])
    return order


def find_frame_cycles(graph: Network) -> list[list[str]]:
    """Find the cycles of passes that are closed by content of the previous frame.

    Each cycle lists passes and resources in turns. It begins with the pass that reads the previous
    frame's content, and ends with the resource of that content. One shortest cycle is returned for
    each such read, in file order, and no cycle twice.
    """
    flow: Network = nx.DiGraph()
    for earlier, later in extract_order(graph).edges:
        for hazard in graph.edges[earlier, later]["hazards"]:
            if hazard["hazard"] == "read after write" and not flow.has_edge(earlier, later):
                flow.add_edge(earlier, later, resource=hazard["resource"])
    closing: list[tuple[str, str, str]] = []
    index = number_passes(graph)
    for reader in list_passes(graph):
        for resource in graph.predecessors(reader):
            if graph.edges[resource, reader].get("previous_frame"):
                writer = max(graph.predecessors(resource), key=index.__getitem__)
                closing.append((writer, resource, reader))
    for writer, resource, reader in closing:
        flow.add_edge(writer, reader, resource=resource)
    cycles: list[list[str]] = []
    seen: set[frozenset[str]] = set()
    for writer, resource, reader in closing:
        if not nx.has_path(flow, reader, writer):
            continue
        path: list[str] = nx.shortest_path(flow, reader, writer)
        cycle = []
        for earlier, later in nx.utils.pairwise(path):
            cycle += [earlier, flow.edges[earlier, later]["resource"]]
        cycle += [writer, resource]
        if frozenset(cycle) not in seen:
            seen.add(frozenset(cycle))
            cycles.append(cycle)
    return cycles


@dataclass(frozen=True, slots=True)
class CriticalPath:
    """The slowest chain of passes in which each depends on the one before.

    The others could run at the same time, so only a faster pass of this chain lets a frame take
    less than ``ms`` milliseconds. ``total_ms`` is the sum over all passes. ``passes`` are nodes of
    the graph, ``names`` the names of these passes.
    """

    passes: tuple[str, ...]
    names: tuple[str, ...]
    ms: float
    total_ms: float


def find_critical_path(graph: Network, times: Mapping[str, float]) -> CriticalPath:
    """Find the longest chain of passes by their times.

    ``times``: milliseconds by the name of the pass. A pass without a time counts as 0 and is not
    listed.
    """
    passes = sort_passes(graph)
    names = {node: str(graph.nodes[node]["name"]) for node in passes}
    weighted: Network = nx.DiGraph()
    weighted.add_node("")
    for node in passes:
        weighted.add_edge("", node, ms=times.get(names[node], 0.0))
    for earlier, later in extract_order(graph).edges:
        weighted.add_edge(earlier, later, ms=times.get(names[later], 0.0))
    path: list[str] = nx.dag_longest_path(weighted, weight="ms", topo_order=["", *passes])
    listed = tuple(node for node in path if node and names[node] in times)
    known = [times[names[node]] for node in passes if names[node] in times]
    on_path = tuple(names[node] for node in listed)
    return CriticalPath(listed, on_path, sum(times[name] for name in on_path), sum(known))


def mark_times(graph: Network, times: Mapping[str, float]) -> CriticalPath:
    """Write times and the critical path into the attributes ``ms`` and ``critical``.

    Return the path. ``times`` as for :func:`find_critical_path`.
    """
    found = find_critical_path(graph, times)
    for node in list_passes(graph):
        if graph.nodes[node]["name"] in times:
            graph.nodes[node]["ms"] = times[graph.nodes[node]["name"]]
        graph.nodes[node]["critical"] = node in found.passes
    for earlier, later in nx.utils.pairwise(found.passes):
        if not graph.has_edge(earlier, later):
            continue
        graph.edges[earlier, later]["critical"] = True
        for hazard in graph.edges[earlier, later]["hazards"]:
            if hazard["hazard"] == "read after write":
                graph.edges[earlier, hazard["resource"]]["critical"] = True
                graph.edges[hazard["resource"], later]["critical"] = True
    return found

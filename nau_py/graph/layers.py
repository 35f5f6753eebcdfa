"""Layers of a graph's picture: the first two steps of Sugiyama's method.

K. Sugiyama, S. Tagawa, M. Toda: Methods for Visual Understanding of Hierarchical System
Structures, IEEE Trans. SMC 11(2), 1981. Each node gets a layer such that arrows lead from lower
to higher layers, and each layer gets an order in which few arrows cross. An arrow over several
layers is cut by an invisible node, a waypoint, in each layer between, which keeps boxes out of
its way.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import networkx as nx

from nau_py.graph.network import Network, list_passes, list_resources, number_passes, reduce_order

_SWEEPS = 8


@dataclass(frozen=True, slots=True)
class DrawnEdge:
    """One arrow of the picture, from ``source`` to ``target``, with the attributes of its edge.

    ``upward``: it leads to a lower layer. ``both``: the pass reads the resource and writes it, so
    the arrow has two heads.
    """

    source: str
    target: str
    kind: str
    upward: bool = False
    both: bool = False
    previous_frame: bool = False
    critical: bool = False

    @property
    def upper(self) -> str:
        """The end in the lower layer."""
        return self.target if self.upward else self.source

    @property
    def lower(self) -> str:
        """The end in the higher layer."""
        return self.source if self.upward else self.target


def list_links(graph: Network) -> list[DrawnEdge]:
    """List the arrows of a picture: each access once, and the order that no access shows.

    A resource has its place after its first writers: those that come before anyone reads. A pass
    that writes it later, or that reads the previous frame's content, has an upward arrow.
    """
    index = number_passes(graph)
    links: list[DrawnEdge] = []
    for resource in list_resources(graph):
        writers = sorted(graph.predecessors(resource), key=index.__getitem__)
        readers = sorted(graph.successors(resource), key=index.__getitem__)
        fresh = [
            index[node]
            for node in readers
            if node not in writers and any(index[w] < index[node] for w in writers)
        ]
        end = min(fresh, default=len(graph))
        for node in writers:
            first = index[node] < end
            edge = graph.edges[node, resource]
            both = node in readers
            critical = bool(edge.get("critical"))
            if first or not both:
                links.append(DrawnEdge(node, resource, "write", not first, both, critical=critical))
            else:
                links.append(DrawnEdge(resource, node, "read", both=True, critical=critical))
        for node in readers:
            if node in writers:
                continue
            edge = graph.edges[resource, node]
            previous = bool(edge["previous_frame"])
            links.append(
                DrawnEdge(
                    resource,
                    node,
                    "read",
                    previous,
                    previous_frame=previous,
                    critical=bool(edge.get("critical")),
                )
            )
    for earlier, later, edge in reduce_order(graph).edges(data=True):
        if not any(hazard["hazard"] == "read after write" for hazard in edge["hazards"]):
            links.append(DrawnEdge(earlier, later, "order", critical=bool(edge.get("critical"))))
    return links


def rank_nodes(graph: Network, links: list[DrawnEdge]) -> dict[str, int]:
    """Assign a layer to each node: the longest path to it from any first pass.

    Passes get even layers and resources odd ones. A resource that nothing writes goes one layer
    before its first reader.
    """
    written = {link.target for link in links if link.kind == "write"}
    passes = set(list_passes(graph))
    down: Network = nx.DiGraph()
    down.add_nodes_from(n for n in graph.nodes if n in passes or n in written)
    for link in links:
        if not link.upward and link.source in down and link.target in down:
            down.add_edge(link.source, link.target, length=2 if link.kind == "order" else 1)
    for earlier, later in reduce_order(graph).edges:
        down.add_edge(earlier, later, length=2)
    rank: dict[str, int] = {}
    for node in nx.topological_sort(down):
        above = [rank[a] + down.edges[a, node]["length"] for a in down.predecessors(node)]
        rank[node] = max(above, default=0)
    for link in links:
        if link.source not in down:
            before = rank[link.target] - 1
            rank[link.source] = min(before, rank.get(link.source, before))
    return rank


@dataclass(frozen=True, slots=True)
class Layers:
    """Nodes and waypoints of each layer, in their order across it.

    ``chains``: of each link, its nodes from upper to lower end, waypoints between.
    """

    rows: list[list[str]]
    chains: list[list[str]]


def make_layers(graph: Network, links: list[DrawnEdge]) -> Layers:
    """Assign layers, add waypoints, and order the nodes within the layers."""
    rank = rank_nodes(graph, links)
    low = min(rank.values(), default=0)
    rows: list[list[str]] = [[] for _ in range(max(rank.values(), default=-1) - low + 1)]
    for node in _first_order(graph, links):
        rows[rank[node] - low].append(node)
    chains: list[list[str]] = []
    for number, link in enumerate(links):
        chain = [link.upper]
        for level in range(rank[link.upper] + 1, rank[link.lower]):
            chain.append(f"waypoint {number} {level}")
            rows[level - low].append(chain[-1])
        chains.append([*chain, link.lower])
    return _uncross(Layers(rows, chains))


def _first_order(graph: Network, links: list[DrawnEdge]) -> list[str]:
    """List the nodes so that each pass comes with the resources that it meets first."""
    found: dict[str, None] = {}
    for node in list_passes(graph):
        found.setdefault(node)
        for link in links:
            if node in (link.source, link.target):
                found.setdefault(link.source)
                found.setdefault(link.target)
    return list(found)


def _uncross(layers: Layers) -> Layers:
    """Sort each layer by the mean position of the neighbours, down and up, and keep the best."""
    above: dict[str, list[str]] = {}
    below: dict[str, list[str]] = {}
    for chain in layers.chains:
        for upper, lower in nx.utils.pairwise(chain):
            below.setdefault(upper, []).append(lower)
            above.setdefault(lower, []).append(upper)
    rows = [list(row) for row in layers.rows]
    best, least = [list(row) for row in rows], _count_crossings(rows, below)
    for sweep in range(_SWEEPS):
        downward = sweep % 2 == 0
        neighbours = above if downward else below
        for row in range(1, len(rows)) if downward else range(len(rows) - 2, -1, -1):
            fixed = {node: place for place, node in enumerate(rows[row + (-1 if downward else 1)])}
            rows[row].sort(key=_mean_place(rows[row], fixed, neighbours))
        crossings = _count_crossings(rows, below)
        if crossings < least:
            best, least = [list(row) for row in rows], crossings
    return Layers(best, layers.chains)


def _mean_place(
    row: list[str], fixed: dict[str, int], neighbours: dict[str, list[str]]
) -> Callable[[str], float]:
    """Return a sort key: a node's mean neighbour position, or its own place if it has none."""
    places = {}
    for own, node in enumerate(row):
        found = [fixed[n] for n in neighbours.get(node, []) if n in fixed]
        places[node] = sum(found) / len(found) if found else float(own)
    return lambda node: places[node]


def _count_crossings(rows: list[list[str]], below: dict[str, list[str]]) -> int:
    """Count the pairs of arrows between neighbouring layers that cross."""
    total = 0
    for upper, lower in nx.utils.pairwise(rows):
        place = {node: i for i, node in enumerate(lower)}
        ends = [sorted(place[n] for n in below.get(node, [])) for node in upper]
        flat = [end for row in ends for end in row]
        starts = [i for i, row in enumerate(ends) for _ in row]
        total += sum(
            starts[i] < starts[j] and flat[i] > flat[j]
            for i in range(len(flat))
            for j in range(i + 1, len(flat))
        )
    return total

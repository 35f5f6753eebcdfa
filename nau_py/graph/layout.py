"""Positions of boxes and arrows: the last step of Sugiyama's method, for any sizes of boxes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf
from typing import Literal

import networkx as nx

from nau_py.graph.layers import DrawnEdge, Layers, list_links, make_layers
from nau_py.graph.network import Network

Direction = Literal["down", "right"]
Size = tuple[float, float]
"""Width and height in pixels."""
Point = tuple[float, float]
_SWEEPS = 24
_WAYPOINT = 12.0
"""Room for an arrow that passes through a layer."""


@dataclass(frozen=True, slots=True)
class Box:
    """The place of a node. ``x``, ``y``: the upper left corner; all in pixels."""

    x: float
    y: float
    width: float
    height: float


@dataclass(frozen=True, slots=True)
class Arrow:
    """An arrow: its link, and the path from source to target as SVG path data."""

    link: DrawnEdge
    path: str


@dataclass(frozen=True, slots=True)
class GraphLayout:
    """Places of all nodes and arrows in a picture of ``width`` x ``height`` pixels."""

    width: float
    height: float
    boxes: dict[str, Box]
    arrows: list[Arrow]


def lay_out(
    graph: Network,
    sizes: Mapping[str, Size],
    direction: Direction = "down",
    gap: float = 18,
    layer_gap: float = 40,
) -> GraphLayout:
    """Place the nodes and arrows of a plan's graph in layers.

    ``sizes``: of each node's box. ``direction``: that of the arrows. ``gap``: the least distance
    of boxes in a layer; ``layer_gap``: the distance of layers. The result depends on the graph
    and the sizes only.
    """
    links = list_links(graph)
    layers = make_layers(graph, links)
    turned = direction == "right"
    extent = {n: (h, w) if turned else (w, h) for n, (w, h) in sizes.items()}
    across = _place_across(layers, {n: size[0] for n, size in extent.items()}, gap)
    tops, depths, top = [], [], 0.0
    for row in layers.rows:
        depths.append(max((extent[n][1] for n in row if n in extent), default=0.0))
        tops.append(top)
        top += depths[-1] + layer_gap
    along = {
        node: (tops[row], depths[row]) for row, names in enumerate(layers.rows) for node in names
    }
    starts, ends = _attach(layers, extent, across)
    boxes = {}
    for node, (width, depth) in extent.items():
        first, room = along[node]
        corner = (across[node] - width / 2, first + (room - depth) / 2)
        x, y = corner[::-1] if turned else corner
        boxes[node] = Box(round(x, 1), round(y, 1), *sizes[node])
    arrows = []
    for number, (link, chain) in enumerate(zip(links, layers.chains)):
        points = []
        for place, node in enumerate(chain):
            first, room = along[node]
            centre = first + room / 2
            half = extent[node][1] / 2 if node in extent else room / 2
            if place:
                points.append((ends[number] if node in extent else across[node], centre - half))
            if place < len(chain) - 1:
                points.append((starts[number] if node in extent else across[node], centre + half))
        arrows.append(Arrow(link, _draw_path(points[::-1] if link.upward else points, turned)))
    width = max((across[n] + extent[n][0] / 2 for n in extent), default=0.0)
    width = max([width, *(x for n, x in across.items() if n not in extent)])
    height = max(top - layer_gap, 0.0)
    size = (height, width) if turned else (width, height)
    return GraphLayout(round(size[0], 1), round(size[1], 1), boxes, arrows)


def _place_across(layers: Layers, widths: Mapping[str, float], gap: float) -> dict[str, float]:
    """Choose the centre of each node and waypoint, in pixels from the left of the picture.

    Each sweep moves a layer as near as possible to the mean of its neighbours (least squares).
    Long arrows count more, as in E. R. Gansner et al.: A Technique for Drawing Directed Graphs,
    IEEE Trans. Software Engineering 19(3), 1993, so that they become straight.
    """
    linked: dict[str, list[tuple[str, float]]] = {}
    for chain in layers.chains:
        for upper, lower in nx.utils.pairwise(chain):
            weight = (1.0, 2.0, 8.0)[(upper not in widths) + (lower not in widths)]
            linked.setdefault(upper, []).append((lower, weight))
            linked.setdefault(lower, []).append((upper, weight))
    centre: dict[str, float] = {}
    for row in layers.rows:
        free = [(0.0, 1.0)] * len(row)
        centre.update(zip(row, _spread(free, _distances(row, widths, gap))))
    order = list(range(len(layers.rows)))
    for sweep in range(_SWEEPS):
        for number in order if sweep % 2 == 0 else reversed(order):
            row = layers.rows[number]
            wanted = []
            for node in row:
                near = linked.get(node, [(node, 1.0)])
                total = sum(weight for _, weight in near)
                wanted.append((sum(centre[n] * weight for n, weight in near) / total, total))
            centre.update(zip(row, _spread(wanted, _distances(row, widths, gap))))
    for _ in range(2):  # the second time, those that have moved make room for others
        _straighten(layers, centre, widths, gap)
    left = min((x - widths.get(n, 0.0) / 2 for n, x in centre.items()), default=0.0)
    return {node: x - left for node, x in centre.items()}


def _straighten(
    layers: Layers, centre: dict[str, float], widths: Mapping[str, float], gap: float
) -> None:
    """Give as many successive waypoints of an arrow as possible one position; change ``centre``.

    A waypoint may move up to its neighbours in the layer. Each run of waypoints takes the position
    nearest to its mean that all of them can take.
    """
    limits: dict[str, tuple[str | None, str | None]] = {}
    for row in layers.rows:
        for before, node, after in zip([None, *row], row, [*row[1:], None]):
            limits[node] = (before, after)

    def free(node: str) -> tuple[float, float]:
        before, after = limits[node]
        least, most = -inf, inf
        if before is not None:
            least = centre[before] + _distances([before, node], widths, gap)[0]
        if after is not None:
            most = centre[after] - _distances([node, after], widths, gap)[0]
        return least, most

    for chain in layers.chains:
        waypoints = chain[1:-1]
        while waypoints:
            least, most = -inf, inf
            count = 0
            for node in waypoints:
                low, high = free(node)
                if max(least, low) > min(most, high):
                    break
                least, most, count = max(least, low), min(most, high), count + 1
            count = max(count, 1)
            run, waypoints = waypoints[:count], waypoints[count:]
            mean = sum(centre[node] for node in run) / count
            centre.update((node, min(max(mean, least), most)) for node in run)


def _distances(row: Sequence[str], widths: Mapping[str, float], gap: float) -> list[float]:
    """List the least distances between the centres of neighbours in a layer."""
    return [
        (widths.get(a, _WAYPOINT) + widths.get(b, _WAYPOINT)) / 2 + gap
        for a, b in nx.utils.pairwise(row)
    ]


def _spread(wanted: Sequence[tuple[float, float]], distances: Sequence[float]) -> list[float]:
    """Find the positions nearest to the wanted ones (least squares) that keep the distances.

    ``wanted``: pairs of position and weight. Without the distances this is isotonic regression,
    which the pool-adjacent-violators algorithm solves (R. E. Barlow et al., Statistical Inference
    under Order Restrictions, 1972).
    """
    offsets = [0.0]
    for distance in distances:
        offsets.append(offsets[-1] + distance)
    pools: list[tuple[float, float, int]] = []  # mean, weight, count
    for (value, weight), offset in zip(wanted, offsets):
        mean, count = value - offset, 1
        while pools and pools[-1][0] >= mean:
            before, mass, more = pools.pop()
            mean = (mean * weight + before * mass) / (weight + mass)
            weight, count = weight + mass, count + more
        pools.append((mean, weight, count))
    flat = [mean for mean, _, count in pools for _ in range(count)]
    return [value + offset for value, offset in zip(flat, offsets)]


def _attach(
    layers: Layers, extent: Mapping[str, Size], across: Mapping[str, float]
) -> tuple[dict[int, float], dict[int, float]]:
    """Spread the ends of arrows over the edges of the boxes, in the order of their other ends.

    The only arrow on an edge is drawn straight if it can be. Returns the position across the layer
    of each arrow's upper and lower end, by its number.
    """
    below: dict[str, list[tuple[float, int]]] = {}
    above: dict[str, list[tuple[float, int]]] = {}
    for number, chain in enumerate(layers.chains):
        below.setdefault(chain[0], []).append((across[chain[1]], number))
        above.setdefault(chain[-1], []).append((across[chain[-2]], number))
    found: list[dict[int, float]] = []
    for side in (below, above):
        places: dict[int, float] = {}
        for node, listed in side.items():
            step = min(extent[node][0] / (len(listed) + 1), 28.0)
            for place, (_, number) in enumerate(sorted(listed)):
                places[number] = across[node] + (place - (len(listed) - 1) / 2) * step
        found.append(places)
    starts, ends = found
    for places, side, other, last in ((ends, above, starts, 0), (starts, below, ends, -1)):
        for node, listed in side.items():
            number = listed[0][1]
            chain = layers.chains[number]
            near = chain[-2] if last == 0 else chain[1]
            straight = across[near] if near not in extent else other[number]
            if len(listed) == 1 and abs(straight - across[node]) < extent[node][0] / 2 - 12:
                places[number] = straight
    return starts, ends


def _draw_path(points: Sequence[Point], turned: bool) -> str:
    """Write an SVG path: straight through boxes' layers, curved between them."""

    def text(x: float, y: float) -> str:
        return f"{y:.1f},{x:.1f}" if turned else f"{x:.1f},{y:.1f}"

    parts = [f"M{text(*points[0])}"]
    for number, (start, end) in enumerate(nx.utils.pairwise(points)):
        if number % 2:
            parts.append(f"L{text(*end)}")
        else:
            middle = (start[1] + end[1]) / 2
            parts.append(f"C{text(start[0], middle)} {text(end[0], middle)} {text(*end)}")
    return " ".join(parts)

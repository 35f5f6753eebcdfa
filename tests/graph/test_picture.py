"""The layout and the SVG of a plan: no overlaps, one box a resource, the same for every run."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from itertools import combinations

import pytest
from lxml import etree

from nau_py.graph.layers import list_links, make_layers, rank_nodes
from nau_py.graph.layout import Box, lay_out
from nau_py.graph.network import mark_times
from nau_py.graph.picture import draw_svg
from tests.conftest import ROOT
from tests.graph.test_plan import plan

HARD = {
    "shadow": ">depth!",
    "gbuffer": "depth>albedo!+normal!+position!",
    "sky": ">W",
    "ao": "normal>ao",
    "blurx": "ao>tmp",
    "blury": "tmp>ao",
    "unused": "albedo>nothing+more",
    "trace": "position+normal+history>radiance",
    "off": "radiance>radiance",
    "accumulate": "radiance+history>acc!",
    "keep": "acc>history!",
    "combine": "albedo+acc+ao+depth>W",
    "text": "W>W",
}


def apart(a: Box, b: Box) -> bool:
    return (
        a.x + a.width <= b.x
        or b.x + b.width <= a.x
        or a.y + a.height <= b.y
        or b.y + b.height <= a.y
    )


def test_layers_by_hand() -> None:
    graph = plan(a=">t+u", b="t>v", c="u+v+image>W").graph
    assert rank_nodes(graph, list_links(graph)) == {
        "pass a": 0,
        "texture t": 1,
        "texture u": 1,
        "pass b": 2,
        "texture v": 3,
        "texture image": 3,  # nothing writes it: beside its reader
        "pass c": 4,
        "window": 5,
    }
    layers = make_layers(graph, list_links(graph))
    assert [sum(not n.startswith("waypoint") for n in row) for row in layers.rows] == [
        1, 2, 1, 2, 1, 1,
    ]  # fmt: skip
    assert [len(row) for row in layers.rows] == [1, 2, 2, 3, 1, 1]


def test_links_by_hand() -> None:
    graph = plan(a="x>t", b="t>t", c="t>x", sky=">W", text=">W").graph
    drawn = {
        (link.source, link.target, link.upward, link.both, link.previous_frame)
        for link in list_links(graph)
    }
    assert drawn == {
        ("pass a", "texture t", False, False, False),
        ("pass b", "texture t", False, True, False),  # reads and writes: one arrow, two heads
        ("texture t", "pass c", False, False, False),
        ("pass c", "texture x", False, False, False),
        ("texture x", "pass a", True, False, True),  # what the previous frame left
        ("pass sky", "window", False, False, False),
        ("pass text", "window", False, False, False),
        ("pass sky", "pass text", False, False, False),  # order that no resource shows
    }


@pytest.mark.parametrize("direction", ["down", "right"])
def test_boxes_do_not_overlap_and_arrows_end_at_them(direction: str) -> None:
    graph = plan(**HARD, modes={"off": "DONT_RUN"}).graph
    sizes = {node: (60.0 + 7 * len(node), 30.0 + len(node) % 3 * 10) for node in graph}
    layout = lay_out(graph, sizes, direction)  # type: ignore[arg-type]
    assert set(layout.boxes) == set(graph)
    for one, other in combinations(layout.boxes.values(), 2):
        assert apart(one, other)
    for box in layout.boxes.values():
        assert 0 <= box.x <= layout.width - box.width + 0.1
        assert 0 <= box.y <= layout.height - box.height + 0.1
    for arrow in layout.arrows:
        numbers = [float(n) for n in re.findall(r"-?\d+\.\d+", arrow.path)]
        for node, (x, y) in (
            (arrow.link.source, numbers[:2]),
            (arrow.link.target, numbers[-2:]),
        ):
            box = layout.boxes[node]
            assert box.x - 0.1 <= x <= box.x + box.width + 0.1
            assert box.y - 0.1 <= y <= box.y + box.height + 0.1
            ends = (
                {box.y, box.y + box.height} if direction == "down" else {box.x, box.x + box.width}
            )
            assert min(abs((y if direction == "down" else x) - end) for end in ends) < 0.11


def test_long_arrows_stay_out_of_boxes() -> None:
    graph = plan(**HARD).graph
    layout = lay_out(graph, dict.fromkeys(graph, (90.0, 30.0)))
    for arrow in layout.arrows:
        points = [
            tuple(map(float, p.split(","))) for p in re.findall(r"[\d.-]+,[\d.-]+", arrow.path)
        ]
        others = [
            b for n, b in layout.boxes.items() if n not in (arrow.link.source, arrow.link.target)
        ]
        for x, y in points:
            for box in others:
                inside = box.x < x < box.x + box.width and box.y < y < box.y + box.height
                assert not inside, (arrow.link, x, y, box)


def test_each_resource_is_drawn_once_and_text_is_escaped() -> None:
    made = plan(**{"a<b": ">t&u", "c": "t&u>W", "d": "t&u>v"})
    texts = [t.text for t in etree.fromstring(draw_svg(made.graph).encode()).iter("{*}text")]
    assert texts.count("t&u") == 1
    assert "1  a<b" in texts
    assert "left out: nothing that the picture" in texts
    assert draw_svg(plan().graph).count("<text") == 1


def test_times_and_the_critical_path_are_drawn() -> None:
    graph = plan(a=">t", b="t>W").graph
    assert "critical" not in draw_svg(graph)
    mark_times(graph, {"a": 1.25, "b": 2.0})
    texts = [t.text for t in etree.fromstring(draw_svg(graph).encode()).iter("{*}text")]
    assert "default · 1.2 ms" in texts
    assert texts[-1] == "red: critical path"


def test_the_picture_does_not_depend_on_hashing() -> None:
    code = (
        "import hashlib\n"
        "from nau_py.graph.export import export\n"
        "from tests.graph.test_picture import HARD\n"
        "from tests.graph.test_plan import plan\n"
        "made = plan(**HARD)\n"
        "text = ''.join(export(made, s) for s in ('svg', 'node-link', 'dot', 'mermaid', 'json'))\n"
        "print(hashlib.sha256(text.encode()).hexdigest())\n"
    )
    found = {
        subprocess.run(
            [sys.executable, "-c", code],
            cwd=ROOT,
            env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("1", "2", "3")
    }
    assert len(found) == 1

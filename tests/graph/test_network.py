"""The networkx graph of a plan: hand-computed order, cycles, reduction, critical path."""

from __future__ import annotations

import json

import networkx as nx
import pytest

from nau_py.graph.export import export
from nau_py.graph.network import (
    extract_order,
    find_critical_path,
    find_frame_cycles,
    mark_times,
    reduce_order,
    sort_passes,
)
from nau_py.graph.times import median_times
from tests.graph.test_plan import plan

DIAMOND = {
    "a": ">t+u",
    "b": "t>v",
    "c": "u>w",
    "d": "v+w+t>W",
}
"""a feeds b and c, both feed d; d reads t of a, too."""


def test_nodes_and_edges() -> None:
    graph = plan(a=">t!", b="t>W", c="W>t", modes={"c": "DONT_RUN"}).graph
    assert isinstance(graph, nx.DiGraph)
    assert list(graph) == ["pass a", "pass b", "pass c", "texture t", "window"]
    assert graph.nodes["pass c"] == {
        "kind": "pass",
        "name": "c",
        "class": "default",
        "index": 2,
        "runs": False,
        "reason": "its mode is DONT_RUN",
        "location": "<unknown>",
        "programs": [],
    }
    assert graph.nodes["window"] == {"kind": "window", "name": "window", "output": True}
    assert graph.edges["pass a", "texture t"] == {"kind": "write", "replaces": True}
    assert graph.edges["texture t", "pass b"] == {
        "kind": "read",
        "draws_over": False,
        "previous_frame": False,
    }
    assert graph.edges["pass b", "pass c"] == {
        "kind": "order",
        "hazards": [
            {"resource": "window", "hazard": "read after write"},
            {"resource": "texture t", "hazard": "write after read"},
        ],
    }


def test_two_passes_of_one_name_are_two_nodes() -> None:
    made = plan(a=">t", b="t>W")
    made.steps[1].pass_.name = "a"
    assert [n for n in made.graph if n.startswith("pass")] == ["pass a", "pass a (1)"]


@pytest.mark.parametrize(
    "table",
    [DIAMOND, {"z": ">t", "y": ">u", "x": "u>v", "a": "t+v>W"}, {"b": ">W", "a": ">W"}, {}],
)
def test_the_order_is_that_of_the_file(table: dict[str, str]) -> None:
    assert sort_passes(plan(**table).graph) == [f"pass {name}" for name in table]


def test_reduction_drops_the_order_that_follows_from_the_rest() -> None:
    graph = plan(**DIAMOND).graph
    assert set(extract_order(graph).edges) == {
        ("pass a", "pass b"),
        ("pass a", "pass c"),
        ("pass a", "pass d"),
        ("pass b", "pass d"),
        ("pass c", "pass d"),
    }
    assert list(reduce_order(graph).edges) == [
        ("pass a", "pass b"),
        ("pass a", "pass c"),
        ("pass b", "pass d"),
        ("pass c", "pass d"),
    ]


@pytest.mark.parametrize(
    "table, cycles",
    [
        (DIAMOND, []),
        ({"a": "x>W", "b": ">x"}, []),  # the previous frame, but no cycle
        ({"a": "x>t", "b": "t>W", "c": "t>x"}, ["a t c x"]),
        ({"a": "x>t", "b": "t>u", "c": "u>x+W"}, ["a t b u c x"]),
        ({"a": "x+y>t", "b": "t>x", "c": "t>y+W"}, ["a t b x", "a t c y"]),
        ({"a": "x>y", "b": "z>x", "c": "y>z+W"}, ["a y c z b x"]),  # through two frames
        ({"a": "x>x", "b": "x>x+W"}, []),  # a may write before it reads
    ],
)
def test_cycles_are_whole(table: dict[str, str], cycles: list[str]) -> None:
    made = plan(**table)
    found = [" ".join(node.split()[1] for node in cycle) for cycle in find_frame_cycles(made.graph)]
    assert found == cycles
    assert made.dependencies.has_frame_cycle() == bool(cycles)


def test_critical_path() -> None:
    graph = plan(**DIAMOND).graph
    path = find_critical_path(graph, {"a": 1.0, "b": 2.0, "c": 5.0, "d": 3.0})
    assert (path.names, path.ms, path.total_ms) == (("a", "c", "d"), 9.0, 11.0)
    path = mark_times(graph, {"a": 1.0, "b": 2.0, "d": 3.0})
    assert (path.names, path.ms, path.total_ms) == (("a", "b", "d"), 6.0, 6.0)
    assert [n for n in graph if graph.nodes[n].get("critical")] == ["pass a", "pass b", "pass d"]
    assert "ms" not in graph.nodes["pass c"]
    critical = {(a, b) for a, b in graph.edges if graph.edges[a, b].get("critical")}
    assert critical == {
        ("pass a", "pass b"),
        ("pass a", "texture t"),
        ("texture t", "pass b"),
        ("pass b", "pass d"),
        ("pass b", "texture v"),
        ("texture v", "pass d"),
    }
    assert find_critical_path(plan().graph, {}).names == ()


def test_a_left_out_pass_keeps_the_order_of_its_neighbours() -> None:
    graph = plan(a=">t", off="t>t", b="t>W", modes={"off": "DONT_RUN"}).graph
    assert find_critical_path(graph, {"a": 1.0, "b": 2.0}).names == ("a", "b")


def test_times_are_medians_of_the_pipeline_s_frames() -> None:
    def frame(pipeline: str, **times: float) -> dict[str, object]:
        passes = [{"name": n, "status": "run", "ms": t} for n, t in times.items()]
        left_out = {"name": "z", "status": "left_out", "ms": 0.0}
        return {"pipeline": pipeline, "passes": [*passes, left_out]}

    frames = [frame("Q", a=9.0, b=1.0), frame("Q", a=2.0), frame("R", a=50.0), frame("Q", a=3.0)]
    assert median_times({"frames": frames}, "Q") == {"a": 3.0, "b": 1.0}
    with pytest.raises(ValueError, match="has no frame of pipeline 'S'; its pipelines: 'Q', 'R'"):
        median_times({"frames": frames}, "S")
    for wrong in ([], 3, {"frames": [{}]}, {"frames": [{"pipeline": "Q", "passes": [1]}]}):
        with pytest.raises(ValueError, match="is not a report of nau-run"):
            median_times(wrong, "Q")


def test_node_link_survives_the_round_trip() -> None:
    made = plan(**DIAMOND)
    read = nx.node_link_graph(json.loads(export(made, "node-link")), edges="edges")
    assert nx.utils.graphs_equal(read, made.graph)
    assert read.graph == {"project": "P", "pipeline": "Q"}
    timed = json.loads(export(made, "json", {"a": 1.0, "c": 5.0}))
    assert timed["critical_path"] == {"passes": ["a", "c"], "ms": 6.0, "total_ms": 6.0}
    assert [p.get("ms") for p in timed["passes"]] == [1.0, None, 5.0, None]

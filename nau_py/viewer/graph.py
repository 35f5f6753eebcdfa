"""The pipeline as the viewer's page draws it: passes, targets and arrows with their positions."""

from __future__ import annotations

from typing import Any

from nau_py.graph.plan import Plan

_PASS = (190.0, 58.0)
_TARGET = (88.0, 80.0)
"""Boxes in pixels; a target's has room for a thumbnail of 80 x 60 and its name."""
_MARGIN = 10
EMPTY_GRAPH: dict[str, Any] = {
    "width": 0, "height": 0, "margin": 0, "passes": [], "targets": [], "arrows": [],
}  # fmt: skip
"""The graph of a project whose pipeline cannot be planned."""


def graph_data(plan: Plan, report: dict[str, Any] | None) -> dict[str, Any]:
    """Collect what the page draws: ``width`` and ``height`` in pixels, ``passes``, ``targets``
    (each with its ``box``: x, y, width, height) and ``arrows`` (with an SVG ``path``).

    Passes have their cost in the report's last frame, if that is one of the plan's pipeline.
    """
    # networkx is imported with the first picture of the graph: loading the viewer is quicker.
    from nau_py.graph.layout import lay_out

    cost = {}
    if report is not None and report["frames"][-1]["pipeline"] == plan.pipeline:
        cost = {p["name"]: p for p in report["frames"][-1]["passes"]}
    graph = plan.graph
    sizes = {n: _PASS if graph.nodes[n]["kind"] == "pass" else _TARGET for n in graph}
    layout = lay_out(graph, sizes, direction="right", gap=8, layer_gap=44)
    passes, targets = [], []
    for node, data in graph.nodes(data=True):
        box = layout.boxes[node]
        place = {"box": [box.x + _MARGIN, box.y + _MARGIN, box.width, box.height]}
        if data["kind"] == "pass":
            passes.append(place | _pass_data(data, cost.get(data["name"], {})))
        else:
            targets.append(place | {"name": data["name"], "kind": data["kind"]})
    return {
        "width": layout.width + 2 * _MARGIN,
        "height": layout.height + 2 * _MARGIN,
        "margin": _MARGIN,
        "passes": passes,
        "targets": targets,
        "arrows": [
            {
                "path": arrow.path,
                "kind": arrow.link.kind,
                "both": arrow.link.both,
                "previous": arrow.link.previous_frame,
            }
            for arrow in layout.arrows
        ],
    }


def _pass_data(data: dict[str, Any], spent: dict[str, Any]) -> dict[str, Any]:
    """Describe a pass: its node of the graph, and its entry in the report."""
    ran = data["runs"] and spent.get("status") != "left_out"
    return {
        "name": data["name"],
        "class": data["class"],
        "runs": ran,
        "reason": data["reason"] or (spent.get("reason") if not ran else "") or "",
        "ms": spent.get("ms"),
        "pixels": spent.get("pixels"),
        "rays": spent.get("rays", {}),
        "error": spent.get("est_error"),
    }

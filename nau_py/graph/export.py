"""A plan as JSON, DOT, Mermaid or SVG text."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping

import networkx as nx

from nau_py.graph.network import (
    CriticalPath,
    Network,
    list_passes,
    list_resources,
    mark_times,
)
from nau_py.graph.picture import draw_svg
from nau_py.graph.plan import Plan
from nau_py.graph.programs import list_programs


def export(plan: Plan, style: str, times: Mapping[str, float] | None = None) -> str:
    """Write a plan as ``json``, ``node-link``, ``dot``, ``mermaid`` or ``svg`` text.

    ``times``: milliseconds by the name of the pass; with them the critical path is written, too.
    """
    graph = plan.graph
    path = mark_times(graph, times) if times is not None else None
    if style == "json":
        return to_json(plan, times, path)
    writers: dict[str, Callable[[Network], str]] = {
        "node-link": to_node_link,
        "dot": to_dot,
        "mermaid": to_mermaid,
        "svg": draw_svg,
    }
    return writers[style](graph)


def to_json(
    plan: Plan, times: Mapping[str, float] | None = None, path: CriticalPath | None = None
) -> str:
    """Write ``{project, pipeline, passes: [{name, class, status, reason, reads, writes, programs}],
    edges}``; ``programs`` of raytrace passes: what is bound to which material and ray type.

    With times: ``ms`` of each pass that has one, and ``critical_path: {passes, ms, total_ms}``.
    """
    known = times or {}
    passes = [
        {
            "name": step.name,
            "class": step.pass_.pass_class,
            "status": "run" if step.run else "left_out",
            **({"reason": step.reason} if step.reason else {}),
            **({"ms": known[step.name]} if step.name in known else {}),
            "reads": [str(r) for r in step.access.reads],
            "writes": [str(r) for r in step.access.writes],
            **({"programs": bound} if (bound := list_programs(step.pass_)) else {}),
        }
        for step in plan.steps
    ]
    names = [pass_.name for pass_ in plan.dependencies.passes]
    edges = [
        {
            "from": names[e.earlier],
            "to": names[e.later],
            "resource": str(e.resource),
            "hazard": e.hazard,
        }
        for e in plan.dependencies.edges
    ]
    data: dict[str, object] = {"project": plan.project, "pipeline": plan.pipeline}
    data |= {"passes": passes, "edges": edges}
    if path is not None:
        critical = {"passes": list(path.names), "ms": path.ms, "total_ms": path.total_ms}
        data["critical_path"] = critical
    return json.dumps(data, indent=2) + "\n"


def to_node_link(graph: Network) -> str:
    """Write the whole graph as networkx's node-link JSON; ``networkx.node_link_graph(data,
    edges="edges")`` reads it."""
    return json.dumps(nx.node_link_data(graph, edges="edges"), indent=2) + "\n"


def to_dot(graph: Network) -> str:
    """Write Graphviz text: passes are boxes (dashed: left out), resources ellipses."""

    def quoted(text: str) -> str:
        return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'

    names = _short_names(graph)
    lines = [f"digraph {quoted(graph.graph['pipeline'])} {{", "  rankdir=LR;"]
    for node, name in names.items():
        attributes = graph.nodes[node]
        if attributes["kind"] == "pass":
            style = "" if attributes["runs"] else ", style=dashed"
            style += f", tooltip={quoted(attributes['reason'])}" if attributes["reason"] else ""
            style += ", color=red" if attributes.get("critical") else ""
            lines.append(f"  {name} [shape=box, label={quoted(_title(graph, node))}{style}];")
        else:
            lines.append(f"  {name} [shape=ellipse, label={quoted(attributes['name'])}];")
    lines += [f"  {names[a]} -> {names[b]};" for a, b in _accesses(graph)]
    return "\n".join([*lines, "}"]) + "\n"


def to_mermaid(graph: Network) -> str:
    """Write Mermaid flowchart text."""

    def quoted(text: str) -> str:
        return '"' + text.replace('"', "#quot;") + '"'

    names = _short_names(graph)
    lines = ["flowchart LR"]
    for node, name in names.items():
        attributes = graph.nodes[node]
        if attributes["kind"] == "pass":
            style = "" if attributes["runs"] else ":::left_out"
            style = ":::critical" if attributes.get("critical") else style
            lines.append(f"  {name}[{quoted(_title(graph, node))}]{style}")
        else:
            lines.append(f"  {name}([{quoted(attributes['name'])}])")
    lines += [f"  {names[a]} --> {names[b]}" for a, b in _accesses(graph)]
    lines.append("  classDef left_out stroke-dasharray: 4 4,color:#888")
    if any(graph.nodes[node].get("critical") for node in names):
        lines.append("  classDef critical stroke:#c2410c,stroke-width:3px")
    return "\n".join(lines) + "\n"


def _title(graph: Network, node: str) -> str:
    attributes = graph.nodes[node]
    ms = f", {attributes['ms']:.1f} ms" if "ms" in attributes else ""
    return f"{attributes['name']} ({attributes['class']}{ms})"


def _short_names(graph: Network) -> dict[str, str]:
    """Name the nodes ``p0``, ``p1``, …, ``r0``, …: passes, then resources."""
    names = {node: f"p{number}" for number, node in enumerate(list_passes(graph))}
    return names | {node: f"r{number}" for number, node in enumerate(list_resources(graph))}


def _accesses(graph: Network) -> list[tuple[str, str]]:
    """List the edges that read, then those that write, pass by pass."""
    found: list[tuple[str, str]] = []
    for node in list_passes(graph):
        accesses = [*graph.in_edges(node), *graph.out_edges(node)]
        found += [(a, b) for a, b in accesses if graph.edges[a, b]["kind"] != "order"]
    return found

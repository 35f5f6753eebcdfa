"""A plan as JSON, DOT, Mermaid or SVG text."""

from __future__ import annotations

import json
from xml.sax.saxutils import escape

from nau_py.graph.plan import Plan, Step
from nau_py.graph.resource import WINDOW, Resource
from nau_py.model.passes import Pass
from nau_py.model.raytrace import RaytracePass


def _resources(plan: Plan) -> list[Resource]:
    found: dict[Resource, None] = {}
    for step in plan.steps:
        for resource in [*step.access.reads, *step.access.writes]:
            found.setdefault(resource)
    return list(found)


def _programs(pass_: Pass) -> list[dict[str, str]]:
    """The programs that a raytrace pass binds."""
    if not isinstance(pass_, RaytracePass):
        return []
    found = []
    entry = pass_.rtEntryPoint
    for kind, node in (
        ("ray generation", entry.rayGen if entry else None),
        ("exception", entry.exception if entry else None),
    ):
        if node is not None:
            found.append({"kind": kind, "file": node.file or "", "proc": node.proc or ""})
    for material in pass_.materials:
        for group in material.rayTypes:
            found += [
                {
                    "kind": (program.type or "").lower().replace("_", " "),
                    "material": material.to or "default",
                    "ray": group.name or "",
                    "file": program.file or "",
                    "proc": program.proc or "",
                }
                for program in group.programs
            ]
    for geometry in pass_.rtGeometryProgram:
        kind = (geometry.type or "").lower().replace("_", " ")
        found.append({"kind": kind, "file": geometry.file or "", "proc": geometry.proc or ""})
    return found


def _title(step: Step) -> str:
    """What a pass's box says when one points at it."""
    lines = [step.reason or "runs"]
    for program in _programs(step.pass_):
        whose = ", ".join(program[k] for k in ("material", "ray") if k in program)
        where = f" ({whose})" if whose else ""
        lines.append(f"{program['kind']}{where}: {program['proc']} of {program['file']}")
    return "\n".join(lines)


def to_json(plan: Plan) -> str:
    """``{project, pipeline, passes: [{name, class, status, reason, reads, writes, programs}],
    edges}``; ``programs`` of raytrace passes: what is bound to which material and ray type."""
    passes = [
        {
            "name": step.name,
            "class": step.pass_.pass_class,
            "status": "run" if step.run else "left_out",
            **({"reason": step.reason} if step.reason else {}),
            "reads": [str(r) for r in step.access.reads],
            "writes": [str(r) for r in step.access.writes],
            **({"programs": bound} if (bound := _programs(step.pass_)) else {}),
        }
        for step in plan.steps
    ]
    edges = [
        {
            "from": plan.graph.passes[e.earlier].name,
            "to": plan.graph.passes[e.later].name,
            "resource": str(e.resource),
            "hazard": e.hazard,
        }
        for e in plan.graph.edges
    ]
    data = {"project": plan.project, "pipeline": plan.pipeline, "passes": passes, "edges": edges}
    return json.dumps(data, indent=2) + "\n"


def to_dot(plan: Plan) -> str:
    """Graphviz text: passes are boxes (dashed: left out), resources ellipses."""

    def quoted(text: str) -> str:
        return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'

    lines = [f"digraph {quoted(plan.pipeline)} {{", "  rankdir=LR;"]
    for index, step in enumerate(plan.steps):
        style = "" if step.run else f", style=dashed, tooltip={quoted(step.reason)}"
        label = quoted(f"{step.name} ({step.pass_.pass_class})")
        lines.append(f"  p{index} [shape=box, label={label}{style}];")
    resources = _resources(plan)
    for index, resource in enumerate(resources):
        lines.append(f"  r{index} [shape=ellipse, label={quoted(resource.name)}];")
    for index, step in enumerate(plan.steps):
        lines += [f"  r{resources.index(r)} -> p{index};" for r in step.access.reads]
        lines += [f"  p{index} -> r{resources.index(r)};" for r in step.access.writes]
    return "\n".join([*lines, "}"]) + "\n"


def to_mermaid(plan: Plan) -> str:
    """Mermaid flowchart text."""

    def quoted(text: str) -> str:
        return '"' + text.replace('"', "#quot;") + '"'

    lines = ["flowchart LR"]
    for index, step in enumerate(plan.steps):
        label = quoted(f"{step.name} ({step.pass_.pass_class})")
        lines.append(f"  p{index}[{label}]" + ("" if step.run else ":::left_out"))
    resources = _resources(plan)
    for index, resource in enumerate(resources):
        lines.append(f"  r{index}([{quoted(resource.name)}])")
    for index, step in enumerate(plan.steps):
        lines += [f"  r{resources.index(r)} --> p{index}" for r in step.access.reads]
        lines += [f"  p{index} --> r{resources.index(r)}" for r in step.access.writes]
    lines.append("  classDef left_out stroke-dasharray: 4 4,color:#888")
    return "\n".join(lines) + "\n"


_ROW, _GAP, _BOX, _PITCH = 40, 30, 230, 290


def _text(x: float, y: float, text: str, extra: str = "") -> str:
    shown = text if len(text) <= 34 else text[:33] + "…"
    return f'<text x="{x}" y="{y}" {extra}>{escape(shown)}</text>'


def to_svg(plan: Plan) -> str:
    """A picture: passes down the middle in order, what they read left, what they write right."""
    top = 50
    parts: list[str] = []
    y = top
    for step in plan.steps:
        reads, writes = step.access.reads, step.access.writes
        height = max(len(reads), len(writes), 1) * _ROW
        middle = y + height / 2
        colour = "#dbeafe" if step.run else "#f1f1f1"
        dash = "" if step.run else ' stroke-dasharray="5 4"'
        box = f'<rect x="{_PITCH}" y="{middle - 18}" width="{_BOX}" height="36" rx="5"'
        parts.append(f"<g><title>{escape(_title(step))}</title>{box}")
        parts.append(f'fill="{colour}" stroke="#334"{dash}/>')
        parts.append(_text(_PITCH + 10, middle - 2, step.name, 'font-weight="bold"'))
        label = step.pass_.pass_class + ("" if step.run else " · left out")
        parts.append(_text(_PITCH + 10, middle + 12, label, 'fill="#556"') + "</g>")
        for side, listed in ((0, reads), (2, writes)):
            for row, resource in enumerate(listed):
                at = y + row * _ROW + (height - len(listed) * _ROW) / 2 + _ROW / 2
                fill = "#fde68a" if resource == WINDOW else "#ecfccb"
                x = side * _PITCH
                parts.append(
                    f'<rect x="{x + 10}" y="{at - 13}" width="{_BOX - 10}" height="26" rx="13" '
                    f'fill="{fill}" stroke="#667"/>' + _text(x + 22, at + 4, resource.name)
                )
                ends = (
                    (x + _BOX, at, _PITCH, middle)
                    if side == 0
                    else (_PITCH + _BOX, middle, x + 10, at)
                )
                parts.append(
                    f'<line x1="{ends[0]}" y1="{ends[1]}" x2="{ends[2]}" y2="{ends[3]}" '
                    'stroke="#667" marker-end="url(#a)"/>'
                )
        y += height + _GAP
    width = 2 * _PITCH + _BOX + 20
    title = _text(10, 26, f"{plan.project}: {plan.pipeline}", 'font-size="16" font-weight="bold"')
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{y}" '
        f'viewBox="0 0 {width} {y}" font-family="sans-serif" font-size="12">'
        '<defs><marker id="a" markerWidth="8" markerHeight="8" refX="7" refY="3" orient="auto">'
        '<path d="M0,0 L7,3 L0,6 z" fill="#667"/></marker></defs>'
        f'<rect width="{width}" height="{y}" fill="white"/>{title}'
    )
    return head + "\n".join(parts) + "</svg>\n"


def export(plan: Plan, style: str) -> str:
    """Text in ``style``: ``json``, ``dot``, ``mermaid`` or ``svg``."""
    return {"json": to_json, "dot": to_dot, "mermaid": to_mermaid, "svg": to_svg}[style](plan)

"""The picture of a plan's graph as SVG text."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from textwrap import wrap
from typing import Any

from nau_py.graph.layout import Arrow, Box, Size, lay_out
from nau_py.graph.network import Network

_FONT = 12
_WIDE = 0.62
"""Mean width of a letter of a bold sans-serif font, as a part of the font's size."""
_MOST = 34
_LINE = 15
_MARGIN = 20
_TITLE = 40
_FILLS = {"texture": "#ecfccb", "buffer": "#ede9fe", "window": "#fde68a"}
_INK, _SOFT, _CRITICAL = "#334155", "#64748b", "#c2410c"


def draw_svg(graph: Network) -> str:
    """Draw passes as boxes and resources as rounded ones; arrows lead from writer to readers.

    Passes that are left out are grey and carry the reason. Times and the critical path are drawn
    if the graph has them (:func:`~nau_py.graph.network.mark_times`).
    """
    lines = {node: _label(attributes) for node, attributes in graph.nodes(data=True)}
    layout = lay_out(graph, {node: _measure(text) for node, text in lines.items()})
    legend = _legend(graph, layout.arrows)
    title = f"{graph.graph['project']}: {graph.graph['pipeline']}"
    width = max(layout.width, _text_width(title, 16), _text_width(legend)) + 2 * _MARGIN
    height = layout.height + _TITLE + _MARGIN + (24 if legend else 0)
    left = (width - layout.width) / 2
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" '
        f'viewBox="0 0 {width:.0f} {height:.0f}" font-family="sans-serif" font-size="{_FONT}">',
        '<defs><marker id="head" viewBox="0 0 8 6" markerWidth="8" markerHeight="6" refX="7" '
        'refY="3" orient="auto-start-reverse" markerUnits="userSpaceOnUse">'
        '<path d="M0,0 L8,3 L0,6 z" fill="context-stroke"/></marker></defs>',
        '<rect width="100%" height="100%" fill="white"/>',
        f'<text x="{_MARGIN}" y="24" font-size="16" font-weight="bold">{escape(title)}</text>',
        f'<g transform="translate({left:.1f},{_TITLE})">',
        *(_draw_arrow(graph, arrow) for arrow in layout.arrows),
        *(_draw_node(graph.nodes[n], box, lines[n]) for n, box in layout.boxes.items()),
        "</g>",
    ]
    if legend:
        parts.append(
            f'<text x="{_MARGIN}" y="{height - 12:.0f}" fill="{_SOFT}">{escape(legend)}</text>'
        )
    return "\n".join([*parts, "</svg>"]) + "\n"


def shorten(text: str, most: int = _MOST) -> str:
    """Cut a text to ``most`` characters, the last one an ellipsis."""
    return text if len(text) <= most else text[: most - 1] + "…"


def describe_pass(attributes: Mapping[str, Any]) -> str:
    """Describe a pass in lines: its name, why it is left out, and the programs that it binds."""
    lines = [attributes["name"], attributes["reason"] or "runs"]
    for program in attributes["programs"]:
        use = ", ".join(program[k] for k in ("material", "ray") if k in program)
        place = f" ({use})" if use else ""
        lines.append(f"{program['kind']}{place}: {program['proc']} of {program['file']}")
    return "\n".join(lines)


def _label(attributes: Mapping[str, Any]) -> list[str]:
    """List the lines of text in a node's box."""
    if attributes["kind"] != "pass":
        return [shorten(attributes["name"])]
    lines = [shorten(f"{attributes['index'] + 1}  {attributes['name']}"), attributes["class"]]
    if "ms" in attributes:
        lines[1] += f" · {attributes['ms']:.1f} ms"
    if not attributes["runs"]:
        lines += wrap(f"left out: {attributes['reason']}", _MOST, max_lines=4, placeholder=" …")
    return lines


def _text_width(text: str, size: float = _FONT) -> float:
    return len(text) * size * _WIDE


def _measure(lines: list[str]) -> Size:
    return max(map(_text_width, lines)) + 24, len(lines) * _LINE + 13


def _draw_node(attributes: Mapping[str, Any], box: Box, lines: list[str]) -> str:
    middle = box.x + box.width / 2
    if attributes["kind"] == "pass":
        fill = "#dbeafe" if attributes["runs"] else "#f1f5f9"
        radius, hint = 4.0, describe_pass(attributes)
    else:
        fill, radius = _FILLS[attributes["kind"]], box.height / 2
        hint = f"{attributes['kind']} {attributes['name']}"
    critical = attributes.get("critical")
    stroke = f'stroke="{_CRITICAL}" stroke-width="2"' if critical else f'stroke="{_INK}"'
    dash = ' stroke-dasharray="5 4"' if attributes.get("reason") else ""
    parts = [
        f"<g><title>{escape(hint)}</title>",
        f'<rect x="{box.x}" y="{box.y}" width="{box.width:.1f}" height="{box.height:.1f}" '
        f'rx="{radius}" fill="{fill}" {stroke}{dash}/>',
    ]
    for number, line in enumerate(lines):
        y = box.y + 18 + number * _LINE
        if attributes["kind"] != "pass" or (number == 0 and attributes["runs"]):
            style = f'fill="{_INK}"' + (' font-weight="bold"' if number == 0 else "")
        else:
            style = f'fill="{_SOFT}"'
        parts.append(
            f'<text x="{middle:.1f}" y="{y:.1f}" text-anchor="middle" {style}>{escape(line)}</text>'
        )
    return "".join([*parts, "</g>"])


def _draw_arrow(graph: Network, arrow: Arrow) -> str:
    link = arrow.link
    ends = [graph.nodes[node] for node in (link.source, link.target)]
    idle = any(node["kind"] == "pass" and not node["runs"] for node in ends)
    colour = _CRITICAL if link.critical else "#cbd5e1" if idle else _SOFT
    style = f'stroke="{colour}" stroke-width="{2 if link.critical else 1.2}"'
    if link.previous_frame:
        style += ' stroke-dasharray="6 4"'
    elif link.kind == "order":
        style += ' stroke-dasharray="2 4"'
    heads = 'marker-end="url(#head)"' + (' marker-start="url(#head)"' if link.both else "")
    return f'<path d="{arrow.path}" fill="none" {style} {heads}/>'


def _legend(graph: Network, arrows: list[Arrow]) -> str:
    """Explain the kinds of arrows that the picture has."""
    parts = []
    if any(arrow.link.previous_frame for arrow in arrows):
        parts.append("dashed: content of the previous frame")
    if any(arrow.link.kind == "order" for arrow in arrows):
        parts.append("dotted: runs before")
    if any(graph.nodes[node].get("critical") for node in graph):
        parts.append("red: critical path")
    return "; ".join(parts)

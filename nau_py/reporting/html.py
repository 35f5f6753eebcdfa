"""Pages and tables in HTML that need no network. Text is escaped here, nowhere else."""

from __future__ import annotations

import base64
from collections.abc import Iterable, Sequence
from html import escape

STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #1b1f24; margin: 2rem auto; max-width: 72rem;
  padding: 0 1rem; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.15rem; margin-top: 2.2rem; }
.wide { overflow-x: auto; } table { border-collapse: collapse; font-size: 13px; }
th, td { padding: .25rem .6rem; border-bottom: 1px solid #d8dee4; text-align: right; }
th:first-child, td:first-child { text-align: left; } td { white-space: nowrap; }
.grey { color: #57606a; } .good { color: #1a7f37; } .warn { color: #b35900; }
.bad { color: #cf222e; }
pre, code { background: #f6f8fa; } pre { padding: .6rem; overflow-x: auto; }
"""


class Markup(str):
    """Text that is HTML already."""

    __slots__ = ()


def text(value: str) -> str:
    """``value`` as HTML."""
    return value if isinstance(value, Markup) else escape(value)


def tag(name: str, inner: str, kind: str = "") -> Markup:
    """An element with a class and text, or markup, inside."""
    attribute = f' class="{escape(kind)}"' if kind else ""
    return Markup(f"<{name}{attribute}>{text(inner)}</{name}>")


def table(head: Sequence[str], rows: Iterable[Sequence[str]], kinds: Sequence[str] = ()) -> Markup:
    """A table; ``kinds``: the class of each row."""
    lines = ["<tr>" + "".join(f"<th>{text(h)}</th>" for h in head) + "</tr>"]
    for number, row in enumerate(rows):
        kind = kinds[number] if number < len(kinds) else ""
        lines.append(tag("tr", Markup("".join(f"<td>{text(cell)}</td>" for cell in row)), kind))
    return Markup(f'<div class="wide"><table>{"".join(lines)}</table></div>')


def items(lines: Iterable[str]) -> Markup:
    """A list."""
    return Markup("<ul>" + "".join(f"<li>{text(line)}</li>" for line in lines) + "</ul>")


def picture(png: bytes, words: str) -> Markup:
    """An image that the page carries; ``words`` say what it shows."""
    data = base64.b64encode(png).decode()
    return Markup(f'<img src="data:image/png;base64,{data}" alt="{escape(words)}">')


def document(title: str, parts: Iterable[str], style: str = "") -> str:
    """A whole page of ``parts``, which are markup."""
    body = "\n".join(parts)
    return (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8">'
        f"<title>{escape(title)}</title><style>{STYLE}{style}</style></head>"
        f"<body>{body}</body></html>\n"
    )

"""The page of a batch: one HTML file that needs no network. Whatever a project says is escaped."""

from __future__ import annotations

import base64
import io
from collections.abc import Sequence
from html import escape
from typing import Any

from PIL import Image

from nau_py.batch.grade import Limits, Result

_MOST = 480
"""Longest side of a picture, pixels."""
_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #1b1f24; margin: 2rem auto; max-width: 68rem;
  padding: 0 1rem; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.1rem; margin-top: 2rem; }
table { border-collapse: collapse; font-size: 14px; }
th, td { padding: .2rem .7rem; border-bottom: 1px solid #d8dee4; text-align: right; }
th:first-child, td:first-child, td.text { text-align: left; }
.rendered { color: #1a7f37; } .wrong { color: #b35900; } .stopped { color: #cf222e; }
.grey { color: #57606a; } pre { background: #f6f8fa; padding: .6rem; overflow-x: auto; }
img { max-width: 100%; display: block; margin: .5rem 0; } li { margin: .15rem 0; }
code { background: #f6f8fa; padding: 0 .2rem; }
"""


def page(title: str, results: Sequence[Result], limits: Limits) -> str:
    """A table of all projects, then each with its picture, passes and diagnostics."""
    good = sum(1 for r in results if r.status == "rendered")
    parts = [
        f"<h1>{escape(title)}</h1>",
        f"<p>{good} of {len(results)} projects rendered. Each ran by itself, for at most "
        f"{limits.seconds:g} s and {limits.megabytes:g} MB.</p>",
        _summary(results),
        *(_section(k, r) for k, r in enumerate(results)),
    ]
    body = "\n".join(parts)
    return (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title>'
        f"<style>{_STYLE}</style></head><body>{body}</body></html>\n"
    )


def _totals(result: Result) -> tuple[float | None, int]:
    """Milliseconds of the last frame, and rays."""
    if result.report is None:
        return None, 0
    frames = result.report["frames"]
    return frames[-1]["ms"], sum(result.report["totals"]["rays"].values())


def _summary(results: Sequence[Result]) -> str:
    rows = [
        "<tr><th>project</th><th>status</th><th>errors</th><th>warnings</th><th>ms a frame</th>"
        "<th>rays</th><th>s in all</th></tr>"
    ]
    for k, r in enumerate(results):
        ms, rays = _totals(r)
        cells = [
            f'<td><a href="#p{k}">{escape(r.name)}</a></td>',
            f'<td class="{r.status} text">{r.status}</td>',
            *(f"<td>{n or ''}</td>" for n in (r.errors, r.warnings)),
            f"<td>{'' if ms is None else f'{ms:,.0f}'}</td>",
            f"<td>{f'{rays:,}' if rays else ''}</td>",
            f"<td>{r.seconds:.1f}</td>",
        ]
        rows.append(f"<tr>{''.join(cells)}</tr>")
    return f"<table>{''.join(rows)}</table>"


def _section(number: int, result: Result) -> str:
    parts = [f'<h2 id="p{number}">{escape(result.name)}</h2>']
    if result.why:
        parts.append(
            f'<p class="{result.status}">{escape(result.status)}: {escape(result.why)}</p>'
        )
    if result.picture is not None:
        parts.append(f'<img src="{_small(result.picture)}" alt="picture of {escape(result.name)}">')
    if result.report is not None:
        parts.append(_passes(result.report))
    if result.diagnostics:
        items = "".join(_diagnostic(d) for d in result.diagnostics)
        parts.append(f"<ul>{items}</ul>")
    if result.status != "rendered" and result.said.strip():
        parts.append(f"<pre>{escape(result.said.strip())}</pre>")
    return "\n".join(parts)


def _passes(report: dict[str, Any]) -> str:
    rows = ["<tr><th>pass</th><th>class</th><th>ms</th><th>rays</th><th>est. error</th></tr>"]
    for item in report["frames"][-1]["passes"]:
        rays = sum(item["rays"].values())
        error = item.get("est_error")
        left = f" (left out: {item['reason']})" if item["status"] != "run" else ""
        rows.append(
            f"<tr><td>{escape(item['name'] + left)}</td><td>{escape(item['class'])}</td>"
            f"<td>{item['ms']:,.1f}</td><td>{f'{rays:,}' if rays else ''}</td>"
            f"<td>{'' if error is None else f'{error:.4f}'}</td></tr>"
        )
    return f"<table>{''.join(rows)}</table>"


def _diagnostic(d: dict[str, Any]) -> str:
    place = f"{d['file']}:{d['line']}:{d['column']}"
    kind = {"error": "stopped", "warning": "wrong"}.get(str(d["severity"]), "grey")
    return (
        f'<li><span class="{kind}">{escape(str(d["severity"]))} {escape(str(d["rule"]))}</span> '
        f"<code>{escape(place)}</code> {escape(str(d['message']))}</li>"
    )


def _small(picture: bytes) -> str:
    image = Image.open(io.BytesIO(picture))
    image.thumbnail((_MOST, _MOST))
    stream = io.BytesIO()
    image.save(stream, "PNG")
    return "data:image/png;base64," + base64.b64encode(stream.getvalue()).decode()

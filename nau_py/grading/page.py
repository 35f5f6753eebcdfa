"""The page of a batch: one HTML file that needs no network. Whatever a project says is escaped."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any

from PIL import Image

import nau_py.reporting.html as html
from nau_py.grading.grade import Result
from nau_py.process.supervised import Limits
from nau_py.reporting.html import Markup

_MOST = 480
"""Longest side of a picture, pixels."""
_KINDS = {"rendered": "good", "wrong": "warn", "stopped": "bad"}
_SEVERITIES = {"error": "bad", "warning": "warn"}
_STYLE = "img { max-width: 100%; display: block; margin: .5rem 0; } td { white-space: normal; }"


def page(title: str, results: Sequence[Result], limits: Limits) -> str:
    """A table of all projects, then each with its picture, passes and diagnostics."""
    good = sum(1 for r in results if r.status == "rendered")
    about = (
        f"{good} of {len(results)} projects rendered. Each ran by itself, for at most "
        f"{limits.seconds:g} s and {limits.megabytes:g} MB."
    )
    sections = [_section(k, r) for k, r in enumerate(results)]
    parts = [html.tag("h1", title), html.tag("p", about), _summary(results), *sections]
    return html.document(title, parts, _STYLE)


def _totals(result: Result) -> tuple[float | None, int]:
    """Milliseconds of the last frame, and rays."""
    if result.report is None:
        return None, 0
    frames = result.report["frames"]
    return frames[-1]["ms"], sum(result.report["totals"]["rays"].values())


def _summary(results: Sequence[Result]) -> Markup:
    rows = []
    for k, r in enumerate(results):
        ms, rays = _totals(r)
        rows.append(
            (
                Markup(f'<a href="#p{k}">{html.text(r.name)}</a>'),
                html.tag("span", r.status, _KINDS[r.status]),
                str(r.errors or ""),
                str(r.warnings or ""),
                "" if ms is None else f"{ms:,.0f}",
                f"{rays:,}" if rays else "",
                f"{r.seconds:.1f}",
            )
        )
    head = ("project", "status", "errors", "warnings", "ms a frame", "rays", "s in all")
    return html.table(head, rows)


def _section(number: int, result: Result) -> str:
    parts = [f'<h2 id="p{number}">{html.text(result.name)}</h2>']
    if result.why:
        parts.append(html.tag("p", f"{result.status}: {result.why}", _KINDS[result.status]))
    if result.picture is not None:
        parts.append(html.picture(_small(result.picture), f"picture of {result.name}"))
    if result.report is not None:
        parts.append(_passes(result.report))
    if result.diagnostics:
        parts.append(html.items(_diagnostic(d) for d in result.diagnostics))
    if result.status != "rendered" and result.said.strip():
        parts.append(html.tag("pre", result.said.strip()))
    return "\n".join(parts)


def _passes(report: dict[str, Any]) -> Markup:
    rows = []
    for item in report["frames"][-1]["passes"]:
        rays, error = sum(item["rays"].values()), item.get("est_error")
        left = f" (left out: {item['reason']})" if item["status"] != "run" else ""
        rows.append(
            (
                item["name"] + left,
                item["class"],
                f"{item['ms']:,.1f}",
                f"{rays:,}" if rays else "",
                "" if error is None else f"{error:.4f}",
            )
        )
    return html.table(("pass", "class", "ms", "rays", "est. error"), rows)


def _diagnostic(d: dict[str, Any]) -> Markup:
    kind = html.tag("span", f"{d['severity']} {d['rule']}", _SEVERITIES.get(d["severity"], "grey"))
    place = html.tag("code", f"{d['file']}:{d['line']}:{d['column']}")
    return Markup(f"{kind} {place} {html.text(d['message'])}")


def _small(picture: bytes) -> bytes:
    image = Image.open(io.BytesIO(picture))
    image.thumbnail((_MOST, _MOST))
    stream = io.BytesIO()
    image.save(stream, "PNG")
    return stream.getvalue()

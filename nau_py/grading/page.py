"""The page of a batch: one HTML file that needs no network."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from PIL import Image

from nau_py.grading.grade import Result
from nau_py.process.supervised import Limits
from nau_py.reporting.page import render_template
from nau_py.reporting.pass_rows import format_count, make_pass_grid
from nau_py.reporting.pixels import Bytes
from nau_py.reporting.table import Grid

LONGEST = 480
"""Longest side of a picture, pixels."""
_STATUSES = {"rendered": "good", "wrong": "warn", "stopped": "bad"}
_SEVERITIES = {"error": "bad", "warning": "warn"}


@dataclass(frozen=True, slots=True)
class Section:
    """A project on the page: row of the summary, and the details below."""

    name: str
    status: str
    kind: str
    reason: str
    numbers: tuple[str, ...]
    """Errors, warnings, milliseconds of the last frame, rays, seconds in all."""
    picture: Bytes | None
    passes: Grid | None
    diagnostics: list[dict[str, str]]
    output: str
    """Messages of the run."""


def write_page(title: str, results: Sequence[Result], limits: Limits) -> str:
    """Write a table of all projects, then each with its picture, passes and diagnostics."""
    rendered = sum(1 for r in results if r.status == "rendered")
    about = (
        f"{rendered} of {len(results)} projects rendered. Each ran by itself, for at most "
        f"{limits.seconds:g} s and {limits.megabytes:g} MB."
    )
    return render_template(
        "batch.html", title=title, about=about, sections=[_make_section(r) for r in results]
    )


def _make_section(result: Result) -> Section:
    frame = result.report["frames"][-1] if result.report is not None else None
    rays = sum(result.report["totals"]["rays"].values()) if result.report is not None else 0
    return Section(
        result.name,
        result.status,
        _STATUSES[result.status],
        result.reason,
        (
            format_count(result.errors),
            format_count(result.warnings),
            "" if frame is None else f"{frame['ms']:,.0f}",
            format_count(rays),
            f"{result.seconds:.1f}",
        ),
        _shrink_picture(result.picture) if result.picture is not None else None,
        make_pass_grid(frame) if frame is not None else None,
        [_describe_diagnostic(d) for d in result.diagnostics],
        result.messages.strip() if result.status != "rendered" else "",
    )


def _describe_diagnostic(diagnostic: dict[str, Any]) -> dict[str, str]:
    severity = str(diagnostic["severity"])
    return {
        "kind": _SEVERITIES.get(severity, "grey"),
        "rule": f"{severity} {diagnostic['rule']}",
        "place": f"{diagnostic['file']}:{diagnostic['line']}:{diagnostic['column']}",
        "message": str(diagnostic["message"]),
    }


def _shrink_picture(picture: bytes) -> Bytes:
    image = Image.open(io.BytesIO(picture))
    image.thumbnail((LONGEST, LONGEST))
    return np.asarray(image)

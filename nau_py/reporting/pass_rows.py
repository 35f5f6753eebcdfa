"""Passes of a frame and their cost, as one table for notebooks, pages and the gallery."""

from __future__ import annotations

from typing import Any

from nau_py.reporting.table import Grid

HEAD = ("pass", "class", "ms", "pixels", "rays", "est. error")


def make_pass_grid(frame: dict[str, Any]) -> Grid:
    """Make the table of the passes of a frame of a report (docs/report.md)."""
    return Grid("Passes", HEAD, tuple(_row(item) for item in frame["passes"]), left=2)


def _row(item: dict[str, Any]) -> tuple[str, ...]:
    return (
        item["name"],
        item["class"],
        f"{item['ms']:,.1f}" if item["status"] == "run" else f"left out: {item['reason']}",
        format_count(item["pixels"]),
        format_rays(item["rays"]),
        format_error(item.get("est_error")),
    )


def format_count(number: int) -> str:
    """Write a number with separators; nothing for 0."""
    return f"{number:,}" if number else ""


def format_rays(rays: dict[str, int]) -> str:
    """Write counts of rays by kind, as in ``primary 1,024, shadow 512``."""
    return ", ".join(f"{kind} {count:,}" for kind, count in rays.items())


def format_error(error: float | None) -> str:
    """Write an estimated error; nothing if it is unknown."""
    return "" if error is None else f"{error:.4f}"

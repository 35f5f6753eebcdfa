"""Tables of texts, once for terminal, page and Markdown."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Grid:
    """A table of texts. ``strong``: indices of the rows to emphasize; ``left``: number of the
    columns that are aligned left."""

    title: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    strong: frozenset[int] = frozenset()
    left: int = 1


def to_markdown(grid: Grid) -> list[str]:
    """Return the lines of a Markdown table, without the title."""
    rest = len(grid.head) - grid.left
    return [
        _markdown_row(grid.head),
        "|" + "---|" * grid.left + "--:|" * rest,
        *(_markdown_row(row) for row in grid.rows),
    ]


def _markdown_row(cells: tuple[str, ...]) -> str:
    return "| " + " | ".join(cells) + " |"

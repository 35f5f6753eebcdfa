"""Finding the number of samples that just meets a target, between and beyond those of a ladder."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import log2

NEAR = 1.3
"""Ratio of neighbouring numbers that is fine enough."""


def next_number(tried: Sequence[tuple[int, bool]], most: int) -> int | None:
    """The number to try next; None where the least one that passes is known well enough.

    ``tried``: numbers by growing size, and whether each passes; what passes once does so for all
    greater ones. Up to ``most``.
    """
    first = next((i for i, (_, passes) in enumerate(tried) if passes), None)
    if first is None:
        doubled = 2 * tried[-1][0] if tried else 1
        return doubled if doubled <= most else None
    if first == 0:
        halved = tried[0][0] // 2
        return halved if halved >= 1 else None
    low, high = tried[first - 1][0], tried[first][0]
    if high <= NEAR * low or high - low < 2:
        return None
    return round(2 ** ((log2(low) + log2(high)) / 2))


def refine(
    tried: Callable[[], Sequence[tuple[int, bool]]],
    add: Callable[[int], None],
    most: int,
    steps: int = 8,
) -> None:
    """``add`` numbers until the least that passes is known, in at most so many ``steps``."""
    for _ in range(steps):
        number = next_number(tried(), most)
        if number is None:
            return
        add(number)

"""Search for the least number of samples that meets a target, between and beyond a ladder."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import log2

NEAR = 1.3
"""Ratio of neighbouring numbers that is fine enough."""


def choose_number(tried: Sequence[tuple[int, bool]], most: int) -> int | None:
    """Choose the number to try next; None if the least one that passes is known well enough.

    ``tried``: numbers by growing size, each with True if it passes; all greater numbers pass, too.
    ``most``: the greatest number to try.
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


def refine_number(
    tried: Callable[[], Sequence[tuple[int, bool]]],
    add: Callable[[int], None],
    most: int,
    steps: int = 8,
) -> None:
    """Call ``add`` until the least number that passes is known, at most ``steps`` times."""
    for _ in range(steps):
        number = choose_number(tried(), most)
        if number is None:
            return
        add(number)

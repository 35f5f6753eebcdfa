"""Pareto front of time and error, its knee, and the best points at equal time and equal error.

A point is (time, error); smaller is better in both.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import log

Point = tuple[float, float]


def find_front(points: Sequence[Point]) -> list[int]:
    """Return the indices of the points that no other one beats in both, by growing time."""
    order = sorted(range(len(points)), key=lambda i: points[i])
    found: list[int] = []
    least = float("inf")
    for i in order:
        if points[i][1] < least:
            found.append(i)
            least = points[i][1]
    return found


def find_knee(points: Sequence[Point]) -> int | None:
    """Return the index of the knee of ``points``, a front by growing time; None below three points.

    The knee is farthest below the line between the ends, both axes logarithmic (Satopää et al.
    2011).
    """
    usable = [i for i, (t, e) in enumerate(points) if t > 0 and e > 0]
    if len(usable) < 3:
        return None
    first, last = points[usable[0]], points[usable[-1]]
    width, height = log(last[0] / first[0]), log(last[1] / first[1])
    if width == 0 or height == 0:
        return None

    def below(i: int) -> float:
        x = log(points[i][0] / first[0]) / width
        y = log(points[i][1] / first[1]) / height
        return y - x

    best = max(usable[1:-1], key=below)
    return best if below(best) > 0 else None


def find_most_accurate(points: Sequence[Point], time: float) -> int | None:
    """Return the index of the most accurate point that takes at most ``time``."""
    fitting = [i for i, (t, _) in enumerate(points) if t <= time]
    return min(fitting, key=lambda i: (points[i][1], points[i][0]), default=None)


def find_fastest(points: Sequence[Point], error: float) -> int | None:
    """Return the index of the fastest point whose error is at most ``error``."""
    fitting = [i for i, (_, e) in enumerate(points) if e <= error]
    return min(fitting, key=lambda i: points[i], default=None)

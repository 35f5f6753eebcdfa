"""Which settings are worth their time: Pareto front, knee, equal-time and equal-error answers.

A point is (time, error), both to be small.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import log

Point = tuple[float, float]


def front(points: Sequence[Point]) -> list[int]:
    """Indices of the points that no other one beats in both, by growing time (Pareto)."""
    order = sorted(range(len(points)), key=lambda i: points[i])
    found: list[int] = []
    least = float("inf")
    for i in order:
        if points[i][1] < least:
            found.append(i)
            least = points[i][1]
    return found


def knee(points: Sequence[Point]) -> int | None:
    """Index into ``points``, a front by growing time: the point farthest below the line between
    the ends, both axes logarithmic (Satopää et al. 2011); None below three points."""
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


def at_time(points: Sequence[Point], time: float) -> int | None:
    """The most accurate point that takes at most ``time``."""
    fitting = [i for i, (t, _) in enumerate(points) if t <= time]
    return min(fitting, key=lambda i: (points[i][1], points[i][0]), default=None)


def at_error(points: Sequence[Point], error: float) -> int | None:
    """The cheapest point whose error is at most ``error``."""
    fitting = [i for i, (_, e) in enumerate(points) if e <= error]
    return min(fitting, key=lambda i: points[i], default=None)

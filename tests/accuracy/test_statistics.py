"""Statistics against known distributions."""

from __future__ import annotations

import numpy as np
import pytest

from nau_py.accuracy.front import find_fastest, find_front, find_knee, find_most_accurate
from nau_py.accuracy.refine import choose_number, refine_number
from nau_py.accuracy.statistics import (
    Moments,
    compute_interval,
    compute_spread,
    find_t95,
    fit_exponent,
    split_error,
)


def test_t_quantiles() -> None:
    """Values of the printed tables (two-sided, 95 %)."""
    assert [find_t95(n) for n in (1, 4, 7, 10, 30)] == [12.706, 2.776, 2.365, 2.228, 2.042]
    assert find_t95(0) == float("inf")


def test_the_interval_covers_the_mean() -> None:
    """95 % of the intervals of five normal numbers hold the mean: 4000 trials, so 94 to 96 %."""
    random = np.random.default_rng(7)
    held = 0
    for _ in range(4000):
        found = compute_interval(random.normal(3.0, 0.5, 5))
        held += found.low <= 3.0 <= found.high
    assert 0.94 < held / 4000 < 0.96


def test_one_value_has_no_interval() -> None:
    found = compute_interval([2.0])
    assert (found.mean, found.low, found.high) == (2.0, 2.0, 2.0)


def test_spread() -> None:
    found = compute_spread([3.0, 1.0, 2.0, 9.0, 4.0])
    assert (found.median, found.low, found.high) == (3.0, 1.0, 9.0)


def test_bias_and_variance_are_told_apart() -> None:
    """Pictures off by 0.1 with noise of 0.2, a reference with noise of 0.05: 200,000 pixels."""
    random = np.random.default_rng(3)
    shape = (200, 1000, 3)
    reference = 0.5 + random.normal(0, 0.05, shape)
    runs = Moments(shape)
    for _ in range(5):
        runs.add(0.6 + random.normal(0, 0.2, shape))
    where = np.ones(shape[:2], bool)
    bias2, variance = split_error(runs, reference, np.full(shape, 0.05**2), where)
    assert bias2 == pytest.approx(0.01, rel=0.05)
    assert variance == pytest.approx(0.04, rel=0.02)


def test_pixels_that_are_not_finite_count_nowhere() -> None:
    """One NaN and one infinity of eight pixels: bias and variance are those of the other six."""
    runs, fewer = Moments((2, 4, 3)), Moments((1, 6, 3))
    random = np.random.default_rng(6)
    with np.errstate(invalid="ignore"):
        for _ in range(4):
            picture = random.uniform(0, 1, (2, 4, 3))
            fewer.add(picture.reshape(-1, 3)[[1, 2, 3, 4, 5, 6]][None])
            picture[0, 0], picture[1, 3, 1] = np.nan, np.inf
            runs.add(picture)
    found, expected = (
        split_error(
            m, np.zeros(m.mean.shape), np.zeros(m.mean.shape), np.ones(m.mean.shape[:2], bool)
        )
        for m in (runs, fewer)
    )
    assert found == pytest.approx(expected)


def test_moments_are_those_of_numpy() -> None:
    random = np.random.default_rng(5)
    pictures = random.uniform(0, 1, (7, 4, 5, 3))
    found = Moments((4, 5, 3))
    for picture in pictures:
        found.add(picture)
    np.testing.assert_allclose(found.mean, pictures.mean(axis=0), rtol=1e-12)
    np.testing.assert_allclose(found.variance, pictures.var(axis=0, ddof=1), rtol=1e-12)


def test_exponent_of_a_power_law() -> None:
    costs = [1.0, 4.0, 16.0, 64.0]
    assert fit_exponent(costs, [c**-0.5 for c in costs]) == pytest.approx(-0.5)
    assert fit_exponent([2.0], [1.0]) is None
    assert fit_exponent([2.0, 2.0], [1.0, 3.0]) is None


POINTS = [(1.0, 8.0), (2.0, 2.0), (3.0, 3.0), (4.0, 1.8), (16.0, 1.6), (2.0, 9.0)]


def test_front_and_knee() -> None:
    """(3, 3) and (2, 9) are beaten by (2, 2); the corner at (2, 2) is the knee."""
    assert find_front(POINTS) == [0, 1, 3, 4]
    line = [POINTS[i] for i in find_front(POINTS)]
    assert find_knee(line) == 1
    assert find_knee(line[:2]) is None
    # error falls as time to the power -1: a straight line, without a knee
    assert find_knee([(t, 1 / t) for t in (1.0, 2.0, 4.0, 8.0)]) is None


def test_answers_from_points() -> None:
    assert find_most_accurate(POINTS, 3.5) == 1
    assert find_most_accurate(POINTS, 0.5) is None
    assert find_fastest(POINTS, 1.9) == 3
    assert find_fastest(POINTS, 3.0) == 1
    assert find_fastest(POINTS, 0.1) is None


@pytest.mark.parametrize("least", [1, 2, 3, 7, 16, 29, 64, 100, 333])
def test_refining_finds_the_least_number(least: int) -> None:
    """From a ladder of 4 and 16, within the ratio that counts as near."""
    tried = {4: least <= 4, 16: least <= 16}
    refine_number(
        lambda: sorted(tried.items()), lambda n: tried.__setitem__(n, n >= least), 512, steps=20
    )
    found = min(n for n, passes in tried.items() if passes)
    assert least <= found <= max(1.3 * least, least + 1)


def test_refining_gives_up_at_the_most() -> None:
    assert choose_number([(4, False), (512, False)], 512) is None
    assert choose_number([(1, True), (4, True)], 512) is None

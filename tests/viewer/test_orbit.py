"""Camera moves against what they must leave as it was."""

from __future__ import annotations

import numpy as np
import pytest

from nau_py.viewer import orbit

START = orbit.pose(
    np.array([3.0, 2.0, 5.0]), np.array([-1.0, -0.4, -2.0]), np.array([0, 1.0, 0]), 4.0
)


def test_an_orbit_keeps_pivot_distance_and_horizon() -> None:
    pose = START
    for around, over in ((0.3, 0.1), (-2.0, -0.4), (7.0, 0.2)):
        pose = orbit.orbit(pose, around, over)
        assert pose.pivot == pytest.approx(START.pivot)
        assert np.linalg.norm(pose.view) == pytest.approx(1)
        assert pose.right[1] == pytest.approx(0, abs=1e-12)


def test_a_full_turn_comes_back() -> None:
    pose = START
    for _ in range(8):
        pose = orbit.orbit(pose, np.pi / 4, 0.0)
    assert pose.position == pytest.approx(START.position)


def test_an_orbit_stops_short_of_the_poles() -> None:
    for over in (50.0, -50.0):
        pose = orbit.orbit(START, 0.0, over)
        assert abs(pose.view[1]) < 1
        assert abs(pose.view[1]) > 0.99
        assert orbit.orbit(pose, 0.0, over).view == pytest.approx(pose.view, abs=1e-6)


def test_other_moves() -> None:
    looked = orbit.look(START, 0.2, 0.1)
    assert (looked.position == START.position).all()
    assert np.dot(looked.view, START.view) == pytest.approx(np.cos(0.2), abs=0.02)
    panned = orbit.pan(START, 0.5, 0.0)
    assert panned.position - START.position == pytest.approx(START.right * 2.0)
    near = orbit.dolly(START, 0.5)
    assert near.pivot == pytest.approx(START.pivot)
    assert np.linalg.norm(near.position - near.pivot) == pytest.approx(2.0)
    flown = orbit.fly(START, 1.0, 0.0, 2.0)
    assert flown.position == pytest.approx(START.position + START.view + [0, 2, 0])

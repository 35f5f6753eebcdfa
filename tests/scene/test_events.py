"""Sensors, interpolators and routes on the simulated clock."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import nau_py
from nau_py.scene.world import World
from tests.conftest import Folder

PROJECT = """\
<project name="P" width="8" height="8"><assets>
 <scenes><scene name="Ball" type="Scene"><geometry name="b" type="BOX"/></scene></scenes>
 <sensors><sensor name="clock" class="TimeSensor">
  <enabled value="{enabled}"/><loop value="{loop}"/><secondsToStart value="1"/>
  <cycleInterval value="4"/></sensor>
  <sensor name="zone" class="ProximitySensor"><enabled value="1"/><size x="2" y="2" z="2"/></sensor>
 </sensors>
 <interpolators><interpolator name="path" class="PositionInterpolator"><keyFrames>
  <keyFrame key="1" x="8" y="2" z="0" w="0"/><keyFrame key="0" x="0" y="0" z="4" w="0"/>
 </keyFrames></interpolator></interpolators>
 <routes>
  <route name="r1" sender="clock" receiver="path" eventOut="TIMESENSOR_FRACTION_CHANGED"
   eventIn="SET_INTERPOLATOR_FRACTION"/>
  <route name="r2" sender="path" receiver="Ball" eventOut="INTERPOLATOR_POSITION"
   eventIn="SET_POSITION"/>{more}
 </routes></assets>
 <pipelines><pipeline name="Q"><pass name="p" class="default"><scenes><scene name="Ball"/></scenes>
 </pass></pipeline></pipelines></project>
"""


def world(folder: Folder, enabled: int = 1, loop: int = 0, more: str = "") -> World:
    folder.write("project.xml", PROJECT.format(enabled=enabled, loop=loop, more=more))
    return World(folder.load(), (8, 8))


def place(made: World) -> Any:
    return made.objects(["Ball"])[0].matrix[:3, 3]


@pytest.mark.parametrize(
    ("now", "at"),
    [(0.5, (0, 0, 0)), (2.0, (2, 0.5, 3)), (3.0, (4, 1, 2)), (5.0, (8, 2, 0))],
)
def test_a_clock_moves_a_scene_along_key_frames(
    folder: Folder, now: float, at: tuple[float, ...]
) -> None:
    """It starts after 1 s and takes 4 s: at t the fraction is (t - 1) / 4, positions linear."""
    made = world(folder)
    made.events.frame(now)
    np.testing.assert_allclose(place(made), at, atol=1e-12)


def test_a_clock_that_loops_begins_anew(folder: Folder) -> None:
    made = world(folder, loop=1)
    for now in (2.0, 5.5, 6.5):
        made.events.frame(now)
    np.testing.assert_allclose(place(made), (2, 0.5, 3), atol=1e-12)  # 1 s of 4 since 5.5
    once = world(folder, loop=0)
    for now in (2.0, 5.5, 6.5):
        once.events.frame(now)
    np.testing.assert_allclose(place(once), (2, 0.5, 3), atol=1e-12)  # where it was at 2 s


def test_a_disabled_clock_stands_still_until_a_route_activates_it(folder: Folder) -> None:
    made = world(folder, enabled=0)
    made.events.frame(3.0)
    np.testing.assert_array_equal(place(made), (0, 0, 0))


def test_routes_that_feed_each_other_end(folder: Folder) -> None:
    more = (
        '<route name="a" sender="r1" receiver="x" eventOut="SET_INTERPOLATOR_FRACTION" '
        'eventIn="PING"/><route name="b" sender="a" receiver="y" eventOut="PING" eventIn="PONG"/>'
        '<route name="a" sender="b" receiver="y" eventOut="PONG" eventIn="PING"/>'
    )
    made = world(folder, more=more)
    made.events.frame(3.0)
    np.testing.assert_allclose(place(made), (4, 1, 2))


def test_nothing_of_this_is_reported_as_not_run(folder: Folder) -> None:
    folder.write("project.xml", PROJECT.format(enabled=1, loop=0, more=""))
    rules = {d.rule for d in nau_py.lint(folder.load())}
    assert "L003" not in rules

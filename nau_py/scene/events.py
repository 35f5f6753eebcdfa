"""Sensors, interpolators and routes on the simulated clock (docs/format.md, 3.8 and 11.8)."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from nau_py.model.events import Interpolator, Route, Sensor, SensorValue
from nau_py.model.scene import Scene
from nau_py.scene.mesh import F64

MAX_EVENTS = 10_000
"""Upper bound for the events of a frame, because routes may feed each other."""
Payload = float | tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Event:
    """A message of ``sender``; an empty ``receiver`` means all."""

    kind: str
    sender: str
    receiver: str
    data: Payload


class TimeSensor:
    """Counts a fraction from 0 to 1 while it is enabled."""

    def __init__(self, node: Sensor) -> None:
        self.name = node.name or ""
        self.enabled = _number(node.enabled, 0.0) != 0
        self.loop = _number(node.loop, 0.0) != 0
        self.interval = _number(node.cycleInterval, 0.0)
        self.start = _number(node.secondsToStart, 0.0)

    def receive(self, event: Event, now: float) -> None:
        if event.kind == "ACTIVATE" and not self.enabled:
            self.enabled, self.start = True, now
        elif event.kind == "DEACTIVATE":
            self.enabled = False

    def advance(self, now: float) -> Event | None:
        """Advance the clock to ``now``, in seconds, and return the event of this frame, if any."""
        if not self.enabled:
            return None
        if now > self.start + self.interval:
            if not self.loop:
                self.enabled = False
                return Event("TIMESENSOR_IS_FINISHED", self.name, "", now)
            self.start = now
        if now > self.start and self.interval > 0:
            fraction = (now - self.start) / self.interval
            return Event("TIMESENSOR_FRACTION_CHANGED", self.name, "", fraction)
        return None


class ProximitySensor:
    """Sends an event when a position enters or leaves an axis-aligned box."""

    def __init__(self, node: Sensor) -> None:
        self.name = node.name or ""
        self.enabled = _number(node.enabled, 0.0) != 0
        centre, size = node.center, node.size
        self.centre = np.array([(getattr(centre, k) or 0.0) if centre else 0.0 for k in "xyz"])
        self.half = np.array([(getattr(size, k) or 0.0) / 2 if size else 0.0 for k in "xyz"])
        self.inside = False

    def receive(self, event: Event, now: float) -> Event | None:
        if event.kind != "PROXIMITY" or not self.enabled or isinstance(event.data, float):
            return None
        at = np.array(event.data[:3])
        inside = bool((np.abs(at - self.centre) <= self.half).all())
        if inside == self.inside:
            return None
        self.inside = inside
        return Event("ENTER_TIME" if inside else "EXIT_TIME", self.name, "", now)


class PositionInterpolator:
    """Interpolates linearly between key frames; sends nothing outside their range."""

    def __init__(self, node: Interpolator) -> None:
        self.name = node.name or ""
        frames = sorted(node.keyFrames, key=lambda f: f.key or 0.0)
        self.keys = np.array([f.key or 0.0 for f in frames])
        rows = [[f.x or 0.0, f.y or 0.0, f.z or 0.0, f.w or 0.0] for f in frames]
        self.values: F64 = np.array(rows, np.float64).reshape(-1, 4)

    def receive(self, event: Event) -> Event | None:
        if event.kind != "SET_INTERPOLATOR_FRACTION" or not isinstance(event.data, float):
            return None
        if not len(self.keys) or not self.keys[0] <= event.data <= self.keys[-1]:
            return None
        at = tuple(float(np.interp(event.data, self.keys, column)) for column in self.values.T)
        return Event("INTERPOLATOR_POSITION", self.name, "", at)


class EventSystem:
    """Runs a project's events frame by frame.

    Events that reach a scene call ``place(scene, attribute, values)``, with TRANSLATE or ROTATE and
    four numbers, or ``animate(scene, fraction)``, with a fraction from 0 to 1.
    """

    def __init__(
        self,
        sensors: list[Sensor],
        interpolators: list[Interpolator],
        routes: list[Route],
        scenes: list[Scene],
        place: Callable[[str, str, tuple[float, ...]], None],
        animate: Callable[[str, float], None],
    ) -> None:
        self.clocks = [TimeSensor(s) for s in sensors if s.class_ == "TimeSensor"]
        self.boxes = [ProximitySensor(s) for s in sensors if s.class_ == "ProximitySensor"]
        self.interpolators = [PositionInterpolator(i) for i in interpolators]
        self.routes = routes
        self.scenes = [s.name or "" for s in scenes]
        self._place, self._animate = place, animate

    @property
    def idle(self) -> bool:
        """True if no sensor can ever send an event."""
        return not self.clocks and not self.boxes

    def frame(self, now: float) -> None:
        """Run the events of the beginning of a frame at ``now``, in seconds."""
        waiting = deque(e for clock in self.clocks if (e := clock.advance(now)) is not None)
        for _ in range(MAX_EVENTS):
            if not waiting:
                return
            waiting.extend(self._deliver(waiting.popleft(), now))

    def _deliver(self, event: Event, now: float) -> list[Event]:
        replies: list[Event | None] = [
            Event(r.eventIn or "", r.name or "", r.receiver or "", event.data)
            for r in self.routes
            if r.eventOut == event.kind and r.sender == event.sender
        ]
        for clock in self.clocks:
            if event.receiver in ("", clock.name):
                clock.receive(event, now)
        for box in self.boxes:
            if event.receiver in ("", box.name):
                replies.append(box.receive(event, now))
        for interpolator in self.interpolators:
            if event.receiver in ("", interpolator.name):
                replies.append(interpolator.receive(event))
        for scene in self.scenes:
            if event.receiver in ("", scene):
                self._apply_to_scene(scene, event)
        return [reply for reply in replies if reply is not None]

    def _apply_to_scene(self, scene: str, event: Event) -> None:
        if event.kind == "ANIMATE" and isinstance(event.data, float):
            self._animate(scene, event.data)
        elif event.kind in ("SET_POSITION", "SET_ROTATION") and isinstance(event.data, tuple):
            attribute = "TRANSLATE" if event.kind == "SET_POSITION" else "ROTATE"
            self._place(scene, attribute, event.data)


def _number(node: SensorValue | None, default: float) -> float:
    return default if node is None or node.value is None else float(node.value)

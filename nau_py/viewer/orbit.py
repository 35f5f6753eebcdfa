"""Moving a camera: orbit, pan, dolly and fly. World space, right-handed; angles in radians."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import acos, pi

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
_POLE = 0.02
"""Radians from the poles that an orbit keeps: there up and view are parallel."""


@dataclass(frozen=True, slots=True)
class Pose:
    """Position of a camera, unit view direction, the world's up, and the distance of the pivot."""

    position: F64
    view: F64
    up: F64
    distance: float

    @property
    def pivot(self) -> F64:
        """Point that an orbit turns about, world space."""
        return np.asarray(self.position + self.view * self.distance)

    @property
    def right(self) -> F64:
        return _unit(np.cross(self.view, self.up))


def _unit(vector: F64) -> F64:
    length = float(np.linalg.norm(vector))
    return vector / length if length > 0 else np.array([0.0, 0.0, -1.0])


def pose(position: F64, view: F64, up: F64, distance: float) -> Pose:
    return Pose(position, _unit(view), _unit(up), max(distance, 1e-6))


def _turned(vector: F64, axis: F64, angle: float) -> F64:
    """Rodrigues' rotation of ``vector`` about the unit ``axis``."""
    cos, sin = np.cos(angle), np.sin(angle)
    return np.asarray(
        vector * cos + np.cross(axis, vector) * sin + axis * (axis @ vector) * (1 - cos)
    )


def _aimed(old: Pose, around: float, over: float) -> F64:
    """Turn the view about up, then about right, and keep it off the poles."""
    view = _turned(old.view, old.up, -around)
    angle = acos(float(np.clip(view @ old.up, -1.0, 1.0)))
    over = float(np.clip(over, angle - (pi - _POLE), angle - _POLE))
    right = _unit(np.cross(view, old.up))
    return _unit(_turned(view, right, over))


def orbit(old: Pose, around: float, over: float) -> Pose:
    """Turn about the pivot, which stays in the middle of the picture."""
    view = _aimed(old, around, over)
    return replace(old, position=old.pivot - view * old.distance, view=view)


def look(old: Pose, around: float, over: float) -> Pose:
    """Turn about the position of the camera."""
    return replace(old, view=_aimed(old, around, over))


def pan(old: Pose, right: float, up: float) -> Pose:
    """Move across the view, in units of the pivot's distance."""
    above = np.cross(old.right, old.view)
    step = (old.right * right + above * up) * old.distance
    return replace(old, position=old.position + step)


def dolly(old: Pose, factor: float) -> Pose:
    """Come nearer to the pivot (a factor below 1) or go away from it."""
    distance = max(old.distance * factor, 1e-6)
    return replace(old, position=old.pivot - old.view * distance, distance=distance)


def fly(old: Pose, forward: float, right: float, up: float) -> Pose:
    """Move along the view, across it, and along the world's up; world units."""
    step = old.view * forward + old.right * right + old.up * up
    return replace(old, position=old.position + step)

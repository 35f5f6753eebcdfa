"""State of lights while a frame is drawn (docs/format.md, 9.2)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from nau_py.model.light import Light
from nau_py.model.linked import Project
from nau_py.model.values import Scalar

_NEVER_NEGATIVE = ("CONSTANT_ATT", "LINEAR_ATT", "QUADRATIC_ATT")
_LAST = {"POSITION": 1.0, "DIRECTION": 0.0}
"""Fourth component of these attributes; that of the file is ignored."""


@dataclass(slots=True)
class LightState:
    """The attribute values of a light, by name; vectors in world space."""

    name: str
    values: dict[str, tuple[Scalar, ...]] = field(default_factory=dict)

    def vector(self, name: str) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
        """Return the first three components of an attribute, float64 (3,)."""
        return np.array([float(v) for v in self.values[name][:3]])

    def set(self, name: str, parts: tuple[Scalar, ...]) -> None:
        """Set one attribute, and with DIRECTION also NORMALIZED_DIRECTION."""
        if name in _NEVER_NEGATIVE:
            parts = (max(float(parts[0]), 0.0),)
        elif name in _LAST:
            parts = (*parts[:3], _LAST[name])
        self.values[name] = parts
        if name == "DIRECTION":
            direction = self.vector(name)
            length = float(np.linalg.norm(direction))
            unit = direction / length if length > 0 else direction
            self.values["NORMALIZED_DIRECTION"] = (*(float(u) for u in unit), 0.0)


def make_light_state(project: Project, nodes: list[Light], name: str) -> LightState:
    """Make the state of the light ``name``; apply the nodes of this name in order."""
    state = LightState(name, {a.name: a.default for a in project.registry["LIGHT"] if a.default})
    for key, parts in list(state.values.items()):
        state.set(key, parts)
    for node in nodes:
        for key in node.settings:
            state.set(key, project.value(node, "LIGHT", key))
    return state

"""Lights as they are while a frame is drawn (nau-format.md, 9.2)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from nau_py.model.light import Light
from nau_py.model.linked import Project
from nau_py.model.values import Scalar

_NEVER_NEGATIVE = ("CONSTANT_ATT", "LINEAR_ATT", "QUADRATIC_ATT")


@dataclass(slots=True)
class LightState:
    """The attribute values of a light, by name; vectors in world space."""

    name: str
    values: dict[str, tuple[Scalar, ...]] = field(default_factory=dict)

    def vector(self, name: str) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
        """The first three components of an attribute."""
        return np.array([float(v) for v in self.values[name][:3]])


def light_state(project: Project, nodes: list[Light], name: str) -> LightState:
    """The state of the light ``name``; nodes of one name are applied in order."""
    set_ = project.registry["LIGHT"]
    values: dict[str, tuple[Scalar, ...]] = {a.name: a.default for a in set_ if a.default}
    for node in nodes:
        for key in node.settings:
            values[key] = project.value(node, "LIGHT", key)
    for key in _NEVER_NEGATIVE:
        values[key] = (max(float(values[key][0]), 0.0),)
    for key, last in (("POSITION", 1.0), ("DIRECTION", 0.0)):
        values[key] = (*values[key][:3], last)
    direction = np.array([float(v) for v in values["DIRECTION"][:3]])
    length = float(np.linalg.norm(direction))
    unit = direction / length if length > 0 else direction
    values["NORMALIZED_DIRECTION"] = (*(float(u) for u in unit), 0.0)
    return LightState(name, values)

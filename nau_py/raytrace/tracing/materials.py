"""Materials and lights as ray programs and scene tables read them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.model.attributes.color import COLOR
from nau_py.raytrace.tracing.ray_texture import RayTexture
from nau_py.scene.mesh import F32


@dataclass(frozen=True, slots=True)
class TracedMaterial:
    """A material at a hit: colours (RGBA, or one number for SHININESS) and textures by unit."""

    name: str
    colours: dict[str, tuple[float, ...]]
    textures: dict[int, RayTexture]
    variables: dict[str, NDArray[Any]] = field(default_factory=dict)

    def colour(self, name: str) -> tuple[float, ...]:
        """Return the values of a COLOR attribute; its default if the material has none."""
        found = self.colours.get(name)
        return found if found is not None else tuple(float(v) for v in COLOR.default(name))


@dataclass(frozen=True, slots=True)
class TracedLight:
    """A light of the pass: its attribute values by Nau's names."""

    name: str
    values: dict[str, tuple[Any, ...]]

    def vector(self, name: str) -> F32:
        """Return the first three components of an attribute, float32 (3,)."""
        return np.array(self.values[name][:3], np.float32)

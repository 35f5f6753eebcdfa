"""Materials of model files, and the names of default ones."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from nau_py.model.attributes.color import COLOR

QUAD_MATERIAL = "__Quad"
"""Material of a quad pass that names none."""
OBJ_MATERIAL = "DefaultOBJMaterial"
"""Material of faces in an OBJ file without a material library."""
PRIMITIVE_MATERIAL = "__Light Grey"
"""Material of built-in primitives that name none."""


def default_colours() -> dict[str, tuple[float, ...]]:
    """Return the defaults of the COLOR attributes."""
    return {a.name: tuple(float(v) for v in a.default) for a in COLOR}


@dataclass(slots=True)
class ModelMaterial:
    """A material of a model file: COLOR attributes and texture files by unit."""

    name: str
    colours: dict[str, tuple[float, ...]] = field(default_factory=dict)
    textures: dict[int, Path] = field(default_factory=dict)

"""Materials as model files bring them."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

QUAD_MATERIAL = "__Quad"
"""The material of a quad pass that names none."""
OBJ_MATERIAL = "DefaultOBJMaterial"
"""The material of faces in an OBJ file without a material library."""
PRIMITIVE_MATERIAL = "__Light Grey"
"""The material of built-in primitives that name none."""

DEFAULT_COLOURS: dict[str, tuple[float, ...]] = {
    "AMBIENT": (0.2, 0.2, 0.2, 1.0),
    "DIFFUSE": (0.8, 0.8, 0.8, 1.0),
    "SPECULAR": (0.0, 0.0, 0.0, 1.0),
    "EMISSION": (0.0, 0.0, 0.0, 1.0),
    "SHININESS": (0.0,),
}


@dataclass(slots=True)
class ModelMaterial:
    """A material of a model file: COLOR attributes and texture files by unit."""

    name: str
    colours: dict[str, tuple[float, ...]] = field(default_factory=dict)
    textures: dict[int, Path] = field(default_factory=dict)

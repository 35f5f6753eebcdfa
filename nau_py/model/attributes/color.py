"""COLOR attributes, the colours of a material (docs/format.md, 9.4).

These are Nau's. Built-in ray programs add their own (:mod:`nau_py.raytrace.programs.builtin`).
"""

from __future__ import annotations

from nau_py.model.attribute import AttributeSet, colour, number
from nau_py.model.values import DataType

COLOR = AttributeSet.of(
    "COLOR",
    [
        colour("AMBIENT", (0.2, 0.2, 0.2, 1.0), "Ambient colour.", unit_range=False),
        colour("DIFFUSE", (0.8, 0.8, 0.8, 1.0), "Diffuse colour.", unit_range=False),
        colour("SPECULAR", (0.0, 0.0, 0.0, 1.0), "Specular colour.", unit_range=False),
        colour("EMISSION", (0.0, 0.0, 0.0, 1.0), "Emitted colour.", unit_range=False),
        number("SHININESS", DataType.FLOAT, 0.0, "Phong exponent."),
    ],
)

"""COLOR attributes, the colours of a material (docs/format.md, 9.4)."""

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
        number(
            "ROUGHNESS",
            DataType.FLOAT,
            0.0,
            "nau_py: GGX roughness of `glossy`.",
            minimum=0.0,
            maximum=1.0,
        ),
        number(
            "INDEX_OF_REFRACTION",
            DataType.FLOAT,
            1.5,
            "nau_py: refractive index of `dielectric`.",
            minimum=0.1,
            maximum=10.0,
        ),
        colour(
            "ABSORPTION",
            (0.0, 0.0, 0.0, 1.0),
            "nau_py: what `dielectric` absorbs on the way, per world unit.",
            unit_range=False,
        ),
        number(
            "PRIORITY",
            DataType.INT,
            0,
            "nau_py: where dielectrics overlap, the one of highest priority is there.",
        ),
        *(
            colour(
                f"FLUORESCENCE_{band}",
                (0.0, 0.0, 0.0, 1.0),
                f"nau_py: what `fluorescent` emits for the {band.lower()} light that it absorbs.",
            )
            for band in ("RED", "GREEN", "BLUE")
        ),
    ],
)

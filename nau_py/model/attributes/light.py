"""LIGHT attributes (docs/format.md, 9.2)."""

from __future__ import annotations

from nau_py.model.attribute import AttributeSet, choice, colour, flag, number, vector
from nau_py.model.values import DataType

FLOAT = DataType.FLOAT

LIGHT = AttributeSet.of(
    "LIGHT",
    [
        vector("POSITION", (0.0, 0.0, 0.0, 1.0), "World space."),
        vector("DIRECTION", (0.0, 0.0, -1.0, 0.0), "Direction in which the light travels."),
        vector("SPOT_DIRECTION", (0.0, 0.0, -1.0, 0.0), "Axis of a spot light."),
        vector("NORMALIZED_DIRECTION", (0.0, 0.0, -1.0, 0.0), "Unit DIRECTION.", True),
        colour("COLOR", (1.0, 1.0, 1.0, 1.0), "Colour; without ``a`` its alpha is 0."),
        colour("AMBIENT", (0.2, 0.2, 0.2, 1.0), "Ambient colour."),
        number("SPOT_EXPONENT", FLOAT, 0.0, "Fall-off of a spot light."),
        number("SPOT_CUTOFF", FLOAT, 180.0, "Half angle, degrees; exactly 180 is not a spot."),
        number("CONSTANT_ATT", FLOAT, 1.0, "Constant attenuation; negative counts as 0."),
        number("LINEAR_ATT", FLOAT, 0.0, "Linear attenuation; negative counts as 0."),
        number("QUADRATIC_ATT", FLOAT, 0.0, "Quadratic attenuation; negative counts as 0."),
        choice(
            "SHAPE",
            "DIRECTIONAL",
            "DIRECTIONAL POINT SPOT RECTANGLE DISC SPHERE",
            "nau_py: the light as `direct` and `path` see it.",
        ),
        vector("EDGE_U", (1.0, 0.0, 0.0, 0.0), "nau_py: one side of a RECTANGLE about POSITION."),
        vector("EDGE_V", (0.0, 0.0, 1.0, 0.0), "nau_py: the other side of a RECTANGLE."),
        number("RADIUS", FLOAT, 1.0, "nau_py: of a SPHERE, or of a DISC across DIRECTION."),
        flag("ENABLED", True, "Informational only, as in Nau."),
        number("ID", DataType.INT, -1, "Index inside the running pass.", readonly=True),
    ],
)

"""VIEWPORT attributes (docs/format.md, 9.3)."""

from __future__ import annotations

from nau_py.model.attribute import Attribute, AttributeSet, colour, flag, number, vector
from nau_py.model.values import DataType

VIEWPORT = AttributeSet.of(
    "VIEWPORT",
    [
        Attribute(
            "ORIGIN",
            DataType.VEC2,
            (0.0, 0.0),
            "Lower left corner; below 1 a fraction of the window, else pixels.",
            minimum=0.0,
        ),
        Attribute(
            "SIZE",
            DataType.VEC2,
            (1.0, 1.0),
            "Extent; up to 1 a fraction of the window, else pixels.",
            minimum=0.0,
            keys="size",
        ),
        number("RATIO", DataType.FLOAT, 0.0, "Above 0: height = width / RATIO."),
        flag("FULL", True, "The whole window; ORIGIN, SIZE and RATIO set it false."),
        colour("CLEAR_COLOR", (0.0, 0.0, 0.0, 0.0), "Colour to clear with."),
        vector("ABSOLUTE_ORIGIN", (0.0, 0.0), "Pixels.", True),
        vector("ABSOLUTE_SIZE", (0.0, 0.0), "Pixels.", True),
        number("ABSOLUTE_RATIO", DataType.FLOAT, 0.0, "Width / height in pixels.", readonly=True),
    ],
)

"""RENDERER attributes (docs/format.md, 9.10)."""

from __future__ import annotations

from nau_py.model.attribute import Attribute, AttributeSet, flag, matrix, number
from nau_py.model.values import DataType

_MOUSE = ("MOUSE_LEFT_CLICK", "MOUSE_MIDDLE_CLICK", "MOUSE_RIGHT_CLICK", "MOUSE_POS")
_PRESSED = ("MOUSE_LEFT_PRESSED", "MOUSE_MIDDLE_PRESSED", "MOUSE_RIGHT_PRESSED")

RENDERER = AttributeSet.of(
    "RENDERER",
    [
        matrix("PROJECTION", "Camera to clip."),
        matrix("VIEW", "World to camera."),
        matrix("MODEL", "Object to world."),
        matrix("TEXTURE", "Identity."),
        matrix("VIEW_MODEL", "Object to camera."),
        matrix("PROJECTION_VIEW", "World to clip."),
        matrix("PROJECTION_VIEW_MODEL", "Object to clip."),
        matrix("TS05_PVM", "World to the unit cube; contains no model matrix, as in Nau."),
        matrix("NORMAL", "Object normals to camera space.", size=3),
        number(
            "TEXTURE_COUNT", DataType.INT, 0, "Bit mask of bound units; 0: none.", readonly=True
        ),
        number("LIGHT_COUNT", DataType.INT, 0, "Lights of the running pass.", readonly=True),
        number("FRAME_COUNT", DataType.UINT, 0, "Frames since load.", readonly=True),
        number("TIMER", DataType.FLOAT, 0.0, "Simulated time, milliseconds.", readonly=True),
        number("INSTANCE_COUNT", DataType.UINT, 0, "Of the running pass."),
        number("BUFFER_DRAW_INDIRECT", DataType.UINT, 0, "Of the running pass."),
        *(Attribute(name, DataType.IVEC2, (0, 0), "Pixels.") for name in _MOUSE),
        *(flag(name, False, "Button state.") for name in _PRESSED),
        flag("DEBUG_DRAW_CALL", False, "Unused.", readonly=True),
        flag("PRIMITVE_COUNTER_MODE", False, "Unused (spelt as in Nau)."),
    ],
)

"""PASS, process items and RENDER_TARGET attributes (docs/format.md, 9.8 and 9.9)."""

from __future__ import annotations

from nau_py.model.attribute import Attribute, AttributeSet, choice, colour, flag, number
from nau_py.model.attributes.state import COMPARISONS
from nau_py.model.values import DataType

_INT = DataType.INT
_UINT = DataType.UINT
_STENCIL = "KEEP ZERO REPLACE INCR INCR_WRAP DECR DECR_WRAP INVERT"
RUN_MODES = ("DONT_RUN", "RUN_ALWAYS", "SKIP_FIRST_FRAME", "RUN_ONCE", "RUN_EVEN", "RUN_ODD")

PASS = AttributeSet.of(
    "PASS",
    [
        flag("COLOR_CLEAR", True, "Clear colour before drawing."),
        flag("DEPTH_CLEAR", True, "Clear depth before drawing."),
        flag("STENCIL_CLEAR", True, "Clear stencil before drawing."),
        number("DEPTH_CLEAR_VALUE", DataType.FLOAT, 1.0, "Depth to clear with."),
        number("STENCIL_CLEAR_VALUE", _INT, 0, "Stencil to clear with."),
        colour("COLOR_CLEAR_VALUE", (0.0, 0.0, 0.0, 0.0), "Unused: the viewport's colour counts."),
        flag("COLOR_ENABLE", True, "Overridden by the material's state when drawing."),
        flag("DEPTH_ENABLE", True, "Overridden by the material's state when drawing."),
        flag("DEPTH_MASK", True, "False also blocks the depth clear."),
        choice("DEPTH_FUNC", "LESS", COMPARISONS, "Overridden by the material's state."),
        flag("DEPTH_CLAMPING", False, "No effect in class default."),
        flag("STENCIL_ENABLE", False, "Stencil test."),
        choice("STENCIL_FUNC", "ALWAYS", COMPARISONS, "Stencil comparison."),
        number("STENCIL_OP_REF", _INT, 0, "Stencil reference."),
        number("STENCIL_OP_MASK", _UINT, 255, "Stencil mask."),
        choice("STENCIL_FAIL", "KEEP", _STENCIL, "When the stencil test fails."),
        choice("STENCIL_DEPTH_FAIL", "KEEP", _STENCIL, "When the depth test fails."),
        choice("STENCIL_DEPTH_PASS", "KEEP", _STENCIL, "When both pass."),
        number("INSTANCE_COUNT", _UINT, 0, "Above 0: instanced drawing."),
        Attribute("camera", DataType.STRING, ("__nauDefault",), "Its camera.", reference="camera"),
        choice("TEST_MODE", "RUN_IF", "RUN_IF RUN_WHILE", "Set by testScript.", True),
        choice("RUN_MODE", "RUN_ALWAYS", " ".join(RUN_MODES), "Set by mode.", True),
        number("BUFFER_DRAW_INDIRECT", _UINT, 0, "OpenGL name.", readonly=True),
    ],
)


def _texture_item(type_: str) -> AttributeSet:
    return AttributeSet.of(
        type_,
        [
            flag("CLEAR", False, "Clear all levels to 0."),
            number("CLEAR_LEVEL", _INT, -1, "From 0: clear that level to 0."),
            flag("MIPMAP", False, "Generate mip levels."),
        ],
    )


def _buffer_item(type_: str) -> AttributeSet:
    return AttributeSet.of(type_, [flag("CLEAR", False, "Fill with zero.")])


PRE_TEXTURE = _texture_item("PASS_PRE_PROCESS_TEXTURE")
POST_TEXTURE = _texture_item("PASS_POST_PROCESS_TEXTURE")
PRE_BUFFER = _buffer_item("PASS_PRE_PROCESS_BUFFER")
POST_BUFFER = _buffer_item("PASS_POST_PROCESS_BUFFER")

RENDER_TARGET = AttributeSet.of(
    "RENDER_TARGET",
    [
        Attribute("SIZE", DataType.UIVEC2, (0, 0), "Width and height, pixels.", keys="size"),
        number("SAMPLES", _UINT, 0, "Above 1: multisampled."),
        number("LAYERS", _UINT, 1, "Above 1: layered."),
        number("LEVELS", _UINT, 0, "Above 0: mip levels of the colour textures."),
        colour("CLEAR_VALUES", (0.0, 0.0, 0.0, 0.0), "Colour to clear with."),
    ],
)

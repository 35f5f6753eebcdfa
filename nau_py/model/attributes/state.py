"""STATE attributes (docs/format.md, 9.5)."""

from __future__ import annotations

from nau_py.model.attribute import Attribute, AttributeSet, choice, colour, flag, number
from nau_py.model.values import DataType

COMPARISONS = "LESS NEVER ALWAYS LEQUAL EQUAL GEQUAL GREATER NOT_EQUAL"
_FACTORS = (
    "ZERO ONE SRC_COLOR ONE_MINUS_SRC_COLOR DST_COLOR ONE_MINUS_DST_COLOR SRC_ALPHA "
    "ONE_MINUS_SRC_ALPHA DST_ALPHA ONE_MINUS_DST_ALPHA SRC_ALPHA_SATURATE CONSTANT_COLOR "
    "ONE_MINUS_CONSTANT_COLOR CONSTANT_ALPHA ONE_MINUS_CONSTANT_ALPHA"
)

STATE = AttributeSet.of(
    "STATE",
    [
        flag("DEPTH_TEST", True, "Compare depths."),
        flag("DEPTH_MASK", True, "Write depths."),
        flag("CULL_FACE", True, "Leave out faces of CULL_TYPE."),
        flag("BLEND", False, "Blend with what is there."),
        flag("SAMPLE_SHADING", False, "Shade per sample."),
        choice("DEPTH_FUNC", "LESS", COMPARISONS, "When a depth passes."),
        choice("CULL_TYPE", "BACK", "FRONT BACK FRONT_AND_BACK", "Faces to leave out."),
        choice("ORDER_TYPE", "FRONT_TO_BACK", "FRONT_TO_BACK BACK_TO_FRONT", "Unused by Nau."),
        choice("BLEND_SRC", "ONE", _FACTORS, "Factor of the new colour."),
        choice("BLEND_DST", "ZERO", _FACTORS, "Factor of the old colour."),
        choice("BLEND_EQUATION", "ADD", "ADD SUBTRACT REVERSE_SUBTRACT MIN MAX", "Combination."),
        number("ORDER", DataType.INT, 0, "Drawing layer, ascending; negative is not drawn."),
        number("MIN_SAMPLE_SHADING", DataType.FLOAT, 1.0, "Fraction of samples to shade."),
        colour("BLEND_COLOR", (0.0, 0.0, 0.0, 0.0), "Constant colour of blending.", False),
        Attribute("COLOR_MASK_B4", DataType.BVEC4, (True, True, True, True), "Channels to write."),
    ],
)

"""CAMERA attributes (docs/format.md, 9.1)."""

from __future__ import annotations

from math import pi

from nau_py.model.attribute import (
    Attribute,
    AttributeSet,
    choice,
    flag,
    matrix,
    number,
    vector,
)
from nau_py.model.values import DataType

FLOAT = DataType.FLOAT

CAMERA = AttributeSet.of(
    "CAMERA",
    [
        vector("POSITION", (0.0, 0.0, 0.0, 1.0), "Eye point, world space; keeps VIEW."),
        vector("VIEW", (0.0, 0.0, -1.0, 0.0), "View direction, world space, any length."),
        vector("UP", (0.0, 1.0, 0.0, 0.0), "Up direction, world space."),
        vector(
            "LOOK_AT_POINT",
            (0.0, 0.0, -1.0, 1.0),
            "Point looked at: VIEW becomes point minus POSITION as it is when this tag is read.",
        ),
        vector("NORMALIZED_VIEW", (0.0, 0.0, -1.0, 0.0), "Unit view direction.", True),
        vector("NORMALIZED_UP", (0.0, 1.0, 0.0, 0.0), "Unit up direction.", True),
        vector("NORMALIZED_RIGHT", (1.0, 0.0, 0.0, 0.0), "Unit right direction.", True),
        number("FOV", FLOAT, 60.0, "Vertical field of view, degrees.", minimum=0.1, maximum=179.0),
        number("NEAR", FLOAT, 1.0, "Distance of the near plane, world units."),
        number("FAR", FLOAT, 10000.0, "Distance of the far plane, world units."),
        number("LEFT", FLOAT, -1.0, "Left of the orthographic window, world units."),
        number("RIGHT", FLOAT, 1.0, "Right of the orthographic window, world units."),
        number("TOP", FLOAT, 1.0, "Top of the orthographic window, world units."),
        number("BOTTOM", FLOAT, -1.0, "Bottom of the orthographic window, world units."),
        number("APERTURE", FLOAT, 0.0, "nau_py: radius of the lens of `thin_lens`, world units."),
        number("FOCUS_DISTANCE", FLOAT, 10.0, "nau_py: where `thin_lens` is sharp, along VIEW."),
        choice("TYPE", "PERSPECTIVE", "PERSPECTIVE ORTHO", "Kind of projection."),
        number("ZX_ANGLE", FLOAT, pi, "Angle about the vertical, radians; replaces VIEW."),
        number("ELEVATION_ANGLE", FLOAT, 0.0, "Angle above the horizon, radians; replaces VIEW."),
        Attribute(
            "viewport", DataType.STRING, ("__nauDefault",), "Its viewport.", reference="viewport"
        ),
        flag("DYNAMIC", False, "Physics only."),
        matrix("VIEW_MATRIX", "World to camera."),
        matrix("PROJECTION_MATRIX", "Camera to clip."),
        matrix("VIEW_INVERSE_MATRIX", "Camera to world."),
        matrix("PROJECTION_INVERSE_MATRIX", "Clip to camera."),
        matrix("PROJECTION_VIEW_MATRIX", "World to clip."),
        matrix("TS05_PVM_MATRIX", "World to the unit cube (shadow maps)."),
    ],
)

"""SCENE, SCENE_OBJECT, SPHERE and GRID attributes (docs/format.md, 9.11)."""

from __future__ import annotations

from nau_py.model.attribute import Attribute, AttributeSet, choice, matrix, number, vector
from nau_py.model.values import DataType

_ORDERS = "T_R_S T_S_R R_T_S R_S_T S_R_T S_T_R"


def _transform(axis: tuple[float, float, float]) -> list[Attribute]:
    return [
        vector("SCALE", (1.0, 1.0, 1.0, 1.0), "Factors along x, y, z."),
        vector("TRANSLATE", (0.0, 0.0, 0.0, 0.0), "World units."),
        vector("ROTATE", (*axis, 0.0), "Axis x, y, z and angle w in degrees."),
        choice("TRANSFORM_ORDER", "T_R_S", _ORDERS, "Matrix product as written."),
    ]


SCENE = AttributeSet.of(
    "SCENE",
    [
        *_transform((0.0, 1.0, 0.0)),
        matrix("TRANSFORM", "Scene to world."),
        *(vector(name, (0.0, 0.0, 0.0), "World space.", True) for name in ("BB_MIN", "BB_MAX")),
        vector("BB_CENTER", (0.0, 0.0, 0.0), "World space.", True),
        number("TRIANGLE_COUNT", DataType.UINT, 0, "Triangles.", readonly=True),
    ],
)
SCENE_OBJECT = AttributeSet.of("SCENE_OBJECT", _transform((0.0, 0.0, 1.0)))
SPHERE = AttributeSet.of(
    "SPHERE",
    [
        number("SLICES", DataType.UINT, 10, "Divisions about the axis.", minimum=2),
        number("STACKS", DataType.UINT, 10, "Divisions along the axis.", minimum=3),
    ],
)
GRID = AttributeSet.of(
    "GRID",
    [
        number("DIVISIONS", DataType.UINT, 10, "Cells a side.", minimum=1),
        number("LENGTH", DataType.FLOAT, 1.0, "Side, world units."),
    ],
)

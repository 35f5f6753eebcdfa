"""PHYSICS_MANAGER and PHYSICS_MATERIAL attributes (docs/format.md, section 5).

Most are registered by the engine's plug-ins for Bullet and PhysX; here they are only read. Units
are those of the scene, kilograms and seconds.
"""

from __future__ import annotations

from nau_py.model.attribute import Attribute, AttributeSet, choice, number, vector
from nau_py.model.values import DataType

_FLOAT = DataType.FLOAT
_CAMERA = {
    "TIME": 1 / 60,
    "PACE": 0.2,
    "MIN_PACE": 0.05,
    "HIT_MAGNITUDE": 100.0,
    "STEP_OFFSET": 0.2,
    "MASS": 10.0,
    "STATIC_FRICTION": 0.5,
    "DYNAMIC_FRICTION": 0.5,
    "RESTITUTION": 0.5,
    "RADIUS": 1.0,
    "HEIGHT": 1.0,
}
_NUMBERS = (
    "MASS STATIC_FRICTION DYNAMIC_FRICTION ROLLING_FRICTION FRICTION RESTITUTION SOLVER_FREQUENCY "
    "INERTIA_SCALE FRICTION_COEFFICIENT COLLISION_MASS_SCALE SELF_COLLISION_DISTANCE "
    "SELF_COLLISION_STIFFNESS VITERATIONS PITERATIONS PACE HIT_MAGNITUDE HEIGHT RADIUS STEP_OFFSET "
    "MAX_PARTICLES NBPARTICLES"
)
_VECTORS = "INERTIA VERTICAL_STRETCH HORIZONTAL_STRETCH SHEARING BENDING IMPULSE"

PHYSICS_MANAGER = AttributeSet.of(
    "PHYSICS_MANAGER",
    [
        vector("GRAVITY", (0.0, -9.8, 0.0, 0.0), "Acceleration, world space."),
        number("TIME_STEP", _FLOAT, 1 / 60, "Seconds from step to step."),
        *(number(f"CAMERA_{n}", _FLOAT, v, "Of a dynamic camera.") for n, v in _CAMERA.items()),
        vector("CAMERA_UP", (0.0, 1.0, 0.0, 1.0), "Of a dynamic camera."),
    ],
)
PHYSICS_MATERIAL = AttributeSet.of(
    "PHYSICS_MATERIAL",
    [
        choice("SCENE_TYPE", "STATIC", "STATIC RIGID CLOTH PARTICLES CHARACTER DEBUG", "Kind."),
        choice("SCENE_SHAPE", "CUSTOM", "CUSTOM BOX SPHERE CAPSULE", "Shape that collides."),
        choice(
            "SCENE_CONDITION",
            "NONE",
            "GT LT EGT ELT EQ NONE",
            "Condition of the held vertices.",
        ),
        vector("SCENE_CONDITION_VALUE", (0.0, 0.0, 0.0, 0.0), "Reference of the condition."),
        vector("DIRECTION", (0.0, 0.0, 0.0, 1.0), "Direction in which a character looks."),
        vector("UP", (0.0, 1.0, 0.0, 1.0), "Up of a character."),
        Attribute("BUFFER", DataType.STRING, (), "Buffer that takes the particles' positions."),
        *(number(name, _FLOAT, 1.0, "See the plug-in.") for name in _NUMBERS.split()),
        *(vector(name, (1.0, 1.0, 1.0, 1.0), "See the plug-in.") for name in _VECTORS.split()),
    ],
)

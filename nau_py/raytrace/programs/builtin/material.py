"""``material``: the colour of a material's own GLSL program. The pass makes it: it needs OpenGL."""

from __future__ import annotations

from nau_py.raytrace.programs.description import CLOSEST_HIT, BuiltInProgram

PROGRAM = BuiltInProgram(
    "material",
    CLOSEST_HIT,
    "The colour that the material's own GLSL program gives, with the ray's origin for its eye.",
)

"""``blinn_phong``: the default material with Blinn's highlight."""

from __future__ import annotations

from typing import Any

from nau_py.raytrace.kernels.core.jit import V3, inner
from nau_py.raytrace.kernels.core.vec import add, dot, normalize, scale
from nau_py.raytrace.programs.builtin.lambert import shade_default
from nau_py.raytrace.programs.builtin.phong import add_lobe
from nau_py.raytrace.programs.description import CLOSEST_HIT, BuiltInProgram, LightUse


@inner
def add_blinn_highlight(lit: V3, hit: Any, to_light: V3, colour: V3) -> V3:
    """Add the highlight about the half vector of light and view."""
    away = scale(hit.direction, -1.0)
    cosine = dot(normalize(add(to_light, away)), hit.normal)
    return add_lobe(lit, hit.material, cosine, colour)


@inner
def shade_blinn_phong(scene: Any, tile: Any, ray_type: int, path: Any, hit: Any) -> bool:
    """Add diffuse light and Blinn's highlight."""
    shade_default(scene, tile, ray_type, path, hit, add_blinn_highlight)
    return False


PROGRAM = BuiltInProgram(
    "blinn_phong",
    CLOSEST_HIT,
    "As `phong`, with Blinn's half vector.",
    shade_blinn_phong,
    lights=LightUse.FIRST,
)

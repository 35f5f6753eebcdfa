"""``phong``: the default material with Phong's highlight."""

from __future__ import annotations

from typing import Any

from nau_py.raytrace.kernels.core.jit import V3, inner
from nau_py.raytrace.kernels.core.tables import specular_of
from nau_py.raytrace.kernels.core.vec import add, dot, multiply, reflect, scale
from nau_py.raytrace.programs.builtin.lambert import shade_default
from nau_py.raytrace.programs.description import CLOSEST_HIT, BuiltInProgram, LightUse


@inner
def add_lobe(lit: V3, material: Any, cosine: float, colour: V3) -> V3:
    """Add SPECULAR cos^SHININESS of the light's colour."""
    if cosine > 0.0:
        shine = cosine ** float(material.shininess)
        return add(lit, scale(multiply(specular_of(material), colour), shine))
    return lit


@inner
def add_phong_highlight(lit: V3, hit: Any, to_light: V3, colour: V3) -> V3:
    """Add the highlight about the mirror direction of the light."""
    away = scale(hit.direction, -1.0)
    cosine = dot(reflect(scale(to_light, -1.0), hit.normal), away)
    return add_lobe(lit, hit.material, cosine, colour)


@inner
def shade_phong(scene: Any, tile: Any, ray_type: int, path: Any, hit: Any) -> bool:
    """Add diffuse light and Phong's highlight."""
    shade_default(scene, tile, ray_type, path, hit, add_phong_highlight)
    return False


PROGRAM = BuiltInProgram(
    "phong",
    CLOSEST_HIT,
    "As `lambert`, plus SPECULAR times Phong's highlight of SHININESS.",
    shade_phong,
    lights=LightUse.FIRST,
)

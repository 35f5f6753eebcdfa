"""Lights: the pass's own, and emissive triangles.

A LIGHT's COLOR is what a white diffuse surface facing it shows, as in rasterisation. One with a
shape is the mean of point lights over its area, so that it tends to the point light as it shrinks.
"""

from __future__ import annotations

from math import pi, sqrt
from typing import Any

import numpy as np

from nau_py.raytrace.kernels.core.jit import V3, inner
from nau_py.raytrace.kernels.core.memory import f64, i32
from nau_py.raytrace.kernels.core.sampling import sample_disk, sample_sphere
from nau_py.raytrace.kernels.core.tables import (
    DIRECTIONAL,
    DISC,
    RECTANGLE,
    SPHERE,
    attenuation_of,
    colour_of,
    direction_of,
    edge_u_of,
    edge_v_of,
    position_of,
    spot_of,
)
from nau_py.raytrace.kernels.core.vec import add, cross, dot, normalize, scale, subtract
from nau_py.raytrace.kernels.geometry.surface import load_corner

TINY = 1e-12
"""Squared distance, relative to coordinates, below which a light is on the surface itself."""


@inner
def sample_light_point(light: Any, x: float, y: float) -> V3:
    """A uniform point of the light's shape."""
    p = position_of(light)
    if light.shape == RECTANGLE:
        u, v = scale(edge_u_of(light), x - 0.5), scale(edge_v_of(light), y - 0.5)
        return add(p, add(u, v))
    if light.shape == DISC:
        a, b = sample_disk(x, y)
        return add(p, add(scale(edge_u_of(light), a), scale(edge_v_of(light), b)))
    if light.shape == SPHERE:
        return add(p, scale(sample_sphere(x, y), light.radius))
    return p


@inner
def sample_light(light: Any, position: V3, x: float, y: float) -> tuple[V3, float, V3]:
    """Vector to a point of the light, its length or infinity, and the colour that arrives.

    Attenuation and spot cone are Nau's: 1 / (c + l d + q d²), cos^exponent inside the cutoff. On
    the light itself nothing arrives.
    """
    colour = colour_of(light)
    if light.shape == DIRECTIONAL:
        return scale(direction_of(light), -1.0), np.inf, colour
    to = subtract(sample_light_point(light, x, y), position)
    distance2 = dot(to, to)
    if not distance2 > TINY * max(1.0, dot(position, position)):
        return (0.0, 0.0, 0.0), 0.0, (0.0, 0.0, 0.0)
    d = sqrt(distance2)
    c, linear, q = attenuation_of(light)
    below = c + linear * d + q * distance2
    factor = 1.0 / below if below > 0.0 else 0.0
    if light.cutoff > -1.0:
        along = -dot(to, spot_of(light)) / d
        factor *= along**light.exponent if along >= max(light.cutoff, 0.0) and along > 0 else 0.0
    return to, d, scale(colour, factor)


@inner
def sample_emitter(scene: Any, choice: float, x: float, y: float) -> tuple[int, V3, V3, float]:
    """Triangle, point, unit normal and density over area of a point of the emissive triangles."""
    low, high = 0, scene.emitters_count - 1
    while low < high:  # the last entry whose cumulative power does not exceed the choice
        middle = (low + high + 1) // 2
        if f64(scene.emitter_cdf, middle) <= choice:
            low = middle
        else:
            high = middle - 1
    triangle = i32(scene.emitters, low)
    root = sqrt(x)
    u, v = root * (1.0 - y), root * y
    a, b, c = (
        load_corner(scene, triangle, 0),
        load_corner(scene, triangle, 1),
        load_corner(scene, triangle, 2),
    )
    p = add(a, add(scale(subtract(b, a), u), scale(subtract(c, a), v)))
    n = normalize(cross(subtract(b, a), subtract(c, a)))
    return triangle, p, n, f64(scene.emitter_pdf, triangle)


@inner
def weigh_strategies(a: float, b: float) -> float:
    """The power heuristic for two strategies (Veach 1997, 9.2.4)."""
    if not a > 0.0:
        return 0.0
    r = b / a
    return 1.0 / (1.0 + r * r)


INVERSE_PI = 1.0 / pi

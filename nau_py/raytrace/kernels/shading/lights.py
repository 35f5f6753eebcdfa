"""Lights of the pass.

A LIGHT's COLOR is the colour of a white diffuse surface that faces it, as in rasterisation. A light
with a shape is the mean of point lights over its area, so that it tends to the point light as it
shrinks.
"""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt
from typing import Any

import numpy as np

from nau_py.raytrace.kernels.core.jit import V3, inner
from nau_py.raytrace.kernels.core.sampling import sample_2d, sample_disk, sample_sphere
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
    light_at,
    position_of,
    spot_of,
)
from nau_py.raytrace.kernels.core.vec import add, dot, multiply, scale, subtract
from nau_py.raytrace.kernels.intersect.embree import INFINITE
from nau_py.raytrace.kernels.shading.radiance import add_light

TINY = 1e-12
"""Squared distance, relative to coordinates, below which a light is on the surface itself."""
LIGHT_DIMENSION = 0x1000
"""First dimension of light samples: 64 lights a depth."""


@inner
def sample_light_point(light: Any, x: float, y: float) -> V3:
    """Sample a uniform point of the light's shape."""
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
    """Sample a point of the light. Return the vector to it, its length or infinity, and the colour
    that arrives.

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
def count_light_samples(scene: Any, light: Any) -> int:
    """Return the number of shadow rays for a light: more than one only for a light with area."""
    return max(int(scene.light_samples), 1) if light.shape >= RECTANGLE else 1


@inner
def reflect_diffuse(albedo: V3, direction: V3, length: float) -> V3:
    """Return π times the BRDF of a diffuse surface, which does not depend on the direction."""
    return albedo


@inner
def sample_lights(
    scene: Any,
    tile: Any,
    ray_type: int,
    path: Any,
    origin: V3,
    normal: V3,
    reflect: Callable[[Any, V3, float], V3],
    lobe: Any,
) -> None:
    """Add the light of every light of the pass, with shadows.

    ``reflect(lobe, direction, length)`` returns π times the BRDF for light from ``direction``, a
    vector of that length.
    """
    for index in range(scene.lights_count):
        light = light_at(scene.lights, index)
        samples = count_light_samples(scene, light)
        dimension = np.uint32(LIGHT_DIMENSION + path.depth * 64 + index)
        for k in range(samples):
            number = np.uint32(path.sample * samples + k)
            x, y = sample_2d(scene.seed, path.pixel, number, dimension)
            to, distance, colour = sample_light(light, origin, x, y)
            length = distance if distance < INFINITE else 1.0
            if not length > 0.0:
                continue
            cosine = dot(normal, to) / length
            if not cosine > 0.0:
                continue
            tmax = 1.0 if distance < INFINITE else INFINITE
            reflected = reflect(lobe, to, length)
            brought = scale(multiply(reflected, colour), cosine / samples)
            add_light(scene, tile, ray_type, path, index, origin, to, tmax, brought)

"""Step 8: several rays a pixel, each in its own cell of a grid."""

import numpy as np


def dot(a, b):
    return (a * b).sum(axis=-1)


def camera(launch):
    """Ray generation: each sample has its own cell of a grid over the pixel, and a place in it."""
    side = round(launch.samples**0.5)
    side = side if side * side == launch.samples else 1  # of other numbers there is no grid
    x = launch.x + (launch.sample % side + launch.random(0)) / side
    y = launch.y + (launch.sample // side % side + launch.random(1)) / side
    origin, direction = launch.camera_rays(x, y)
    return launch.trace("Phong", origin, direction)


def base(hits):
    """The colour of the surface: DIFFUSE times the texture of unit 0."""
    return hits.color("DIFFUSE") * hits.texture(0)[:, :3]


def to_sun(hits):
    """Unit vector towards the sun."""
    direction = -hits.lights[0].vector("DIRECTION")
    return direction / np.sqrt(dot(direction, direction))


def shade(hits):
    """Closest hit: diffuse light with a shadow ray, and a little from everywhere."""
    light = to_sun(hits)
    cosine = np.maximum(dot(hits.facing_normal, light), 0)
    seen = hits.trace("Shadow", light, kind="shadow", where=cosine > 0)[:, 0]
    return base(hits) * (0.3 + 0.9 * cosine * seen)[:, None]


def solid(hits):
    """Any hit: the grilles' holes let rays through."""
    return hits.texture(0)[:, 3] > 0.25


def sky(rays):
    """Miss: a pale sky, brighter at the horizon."""
    up = np.clip(rays.direction[:, 1:2], 0, 1)
    return np.float32([0.85, 0.9, 0.95]) * (1 - up) + np.float32([0.35, 0.6, 0.95]) * up


def lit(rays):
    """Miss of a shadow ray: nothing is in the way."""
    return np.float32([1, 1, 1])

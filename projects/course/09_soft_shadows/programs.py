"""Step 9: a light with a size; each sample asks for another point of it."""

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


def towards_sun(hits):
    """Unit vectors to points of the sun's disc, whose radius is ``sun_radius`` at distance 1."""
    axis = -hits.lights[0].vector("DIRECTION")
    axis = axis / np.sqrt(dot(axis, axis))
    side = np.cross(axis, np.float32([0, 1, 0]) if abs(axis[1]) < 0.9 else np.float32([1, 0, 0]))
    side = (side / np.sqrt(dot(side, side))).astype(np.float32)
    up = np.cross(axis, side).astype(np.float32)
    radius = float(hits.variables["sun_radius"][0]) * np.sqrt(hits.random(2))
    angle = 2 * np.pi * hits.random(3)
    offset = radius[:, None] * (np.cos(angle)[:, None] * side + np.sin(angle)[:, None] * up)
    towards = axis + offset
    return towards / np.sqrt(dot(towards, towards))[:, None]


def shade(hits):
    """Closest hit: diffuse light from one point of the sun a sample, with a shadow ray."""
    light = towards_sun(hits)
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

"""Step 11: how much of the sky a point sees within a distance."""

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


def frame(axis):
    """Two unit vectors across each of ``axis``, (n, 3)."""
    helper = np.where(np.abs(axis[:, :1]) < 0.9, np.float32([1, 0, 0]), np.float32([0, 1, 0]))
    side = np.cross(axis, helper)
    side = side / np.sqrt(dot(side, side))[:, None]
    return side.astype(np.float32), np.cross(axis, side).astype(np.float32)


def hemisphere(hits):
    """A direction above each surface, with the density of its cosine: a disc lifted to a sphere."""
    s, t = frame(hits.facing_normal)
    radius, angle = np.sqrt(hits.random(2)), 2 * np.pi * hits.random(3)
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    z = np.sqrt(np.maximum(1 - radius**2, 0))
    out = x[:, None] * s + y[:, None] * t + z[:, None] * hits.facing_normal
    return out.astype(np.float32)


def shade(hits):
    """Closest hit: one ray into the hemisphere a sample; white where it gets far enough."""
    reach = np.full(len(hits), float(hits.variables["reach"][0]), np.float32)
    return base(hits) * hits.trace("Shadow", hemisphere(hits), reach, kind="occlusion")[:, :1]


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

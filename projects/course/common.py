"""Functions that several steps of the course share.

Steps import them by name, and project files bind the ray programs among them.
"""

import numpy as np

INDEX = 1.5
"""Index of refraction of the glass."""


def dot(a, b):
    """Return the dot products of vectors (n, 3)."""
    return (a * b).sum(axis=-1)


def camera(launch):
    """Ray generation: one ray through the centre of each pixel."""
    origin, direction = launch.camera_rays(launch.x + 0.5, launch.y + 0.5)
    return launch.trace("Phong", origin, direction)


def sky(rays):
    """Miss: a pale sky, brighter at the horizon."""
    up = np.clip(rays.direction[:, 1:2], 0, 1)
    return np.float32([0.85, 0.9, 0.95]) * (1 - up) + np.float32([0.35, 0.6, 0.95]) * up


def lit(rays):
    """Miss of a shadow ray: nothing is in the way."""
    return np.float32([1, 1, 1])


def base(hits):
    """Return the colour of the surface: DIFFUSE times the texture of unit 0."""
    return hits.color("DIFFUSE") * hits.texture(0)[:, :3]


def to_sun(hits):
    """Return the unit vector towards the sun."""
    direction = -hits.lights[0].vector("DIRECTION")
    return direction / np.sqrt(dot(direction, direction))


def reflect(d, n):
    """Return the directions ``d``, mirrored by surfaces with unit normals ``n``, (n, 3)."""
    return d - 2 * dot(d, n)[:, None] * n


def frame(axis):
    """Return two unit vectors at right angles to each other and to each of ``axis``, (n, 3)."""
    helper = np.where(np.abs(axis[:, :1]) < 0.9, np.float32([1, 0, 0]), np.float32([0, 1, 0]))
    side = np.cross(axis, helper)
    side = side / np.sqrt(dot(side, side))[:, None]
    return side.astype(np.float32), np.cross(axis, side).astype(np.float32)


def hemisphere(hits):
    """Return a random direction above each surface, with a density proportional to its cosine.

    A point of a disc is lifted to the sphere above it (Malley's method).
    """
    s, t = frame(hits.facing_normal)
    radius, angle = np.sqrt(hits.random(2)), 2 * np.pi * hits.random(3)
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    z = np.sqrt(np.maximum(1 - radius**2, 0))
    out = x[:, None] * s + y[:, None] * t + z[:, None] * hits.facing_normal
    return out.astype(np.float32)

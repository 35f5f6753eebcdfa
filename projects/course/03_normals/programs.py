"""Step 3: normals and a light: Lambert's cosine."""

import numpy as np


def dot(a, b):
    return (a * b).sum(axis=-1)


def camera(launch):
    """Ray generation: one ray through the centre of each pixel."""
    origin, direction = launch.camera_rays(launch.x + 0.5, launch.y + 0.5)
    return launch.trace("Phong", origin, direction)


def base(hits):
    """The colour of the surface: DIFFUSE times the texture of unit 0."""
    return hits.color("DIFFUSE") * hits.texture(0)[:, :3]


def to_sun(hits):
    """Unit vector towards the sun."""
    direction = -hits.lights[0].vector("DIRECTION")
    return direction / np.sqrt(dot(direction, direction))


def shade(hits):
    """Closest hit: as bright as the light falls upright, and a little from everywhere."""
    cosine = np.maximum(dot(hits.facing_normal, to_sun(hits)), 0)
    return base(hits) * (0.3 + 0.9 * cosine)[:, None]


def sky(rays):
    """Miss: a pale sky, brighter at the horizon."""
    up = np.clip(rays.direction[:, 1:2], 0, 1)
    return np.float32([0.85, 0.9, 0.95]) * (1 - up) + np.float32([0.35, 0.6, 0.95]) * up

"""Step 2: hits interpolate texture coordinates; textures are looked up with them."""

import numpy as np


def camera(launch):
    """Ray generation: one ray through the centre of each pixel."""
    origin, direction = launch.camera_rays(launch.x + 0.5, launch.y + 0.5)
    return launch.trace("Phong", origin, direction)


def textured(hits):
    """Closest hit: DIFFUSE times the texture of unit 0, white where there is none."""
    return hits.color("DIFFUSE") * hits.texture(0)[:, :3]


def sky(rays):
    """Miss: a pale sky, brighter at the horizon."""
    up = np.clip(rays.direction[:, 1:2], 0, 1)
    return np.float32([0.85, 0.9, 0.95]) * (1 - up) + np.float32([0.35, 0.6, 0.95]) * up

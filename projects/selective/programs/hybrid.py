"""The ray programs of the selective demo, as a user would write them; alpha test and visibility are
built in.

Each one works on a batch: `hits` holds n hits on one material, arrays have the shape (n,) or
(n, 3), and the result is the colour of each ray.
"""

import numpy as np

AMBIENT = 0.3


def dot(a, b):
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2]


def pinhole_camera(launch):
    """Ray generation: one ray a sample, jittered inside its cell of a grid over the pixel."""
    side = round(launch.samples**0.5)
    side = side if side * side == launch.samples else 1  # other numbers have no grid
    dx, dy = np.full(len(launch), 0.5), np.full(len(launch), 0.5)
    if launch.samples > 1:
        dx = (launch.sample % side + launch.random(0)) / side
        dy = (launch.sample // side % side + launch.random(1)) / side
    origin, direction = launch.camera_rays(launch.x + dx, launch.y + dy)
    return launch.trace("Radiance", origin, direction)


def shade(hits):
    """Closest hit: diffuse with a shadow ray, and the texture of unit 0."""
    to_light = -hits.variables["lightDirection"][:3].astype(np.float32)
    to_light /= np.sqrt(dot(to_light, to_light))
    cosine = np.maximum(dot(hits.facing_normal, to_light), 0)
    seen = hits.trace("Shadow", to_light, kind="shadow", where=cosine > 0)[:, 0]
    light = hits.variables["lightColor"][:3].astype(np.float32)
    base = hits.variables["diffuse"][:3].astype(np.float32) * hits.texture(0)[:, :3]
    return base * (light * (cosine * seen)[:, None] + AMBIENT)


def glass(hits):
    """Closest hit: the specular colour times the reflection, over a dark interior."""
    normal = hits.facing_normal
    mirrored = hits.direction - 2 * dot(hits.direction, normal)[:, None] * normal
    reflection = hits.trace("Radiance", mirrored, kind="reflection")[:, :3]
    specular = hits.variables["specular"][:3].astype(np.float32)
    return hits.variables["diffuse"][:3].astype(np.float32) + specular * reflection


def sky(rays):
    """Miss: the clear colour."""
    return rays.clear_color[:3]


def exception(launch):
    """Exception: the colour of a failed sample."""
    return np.array([1.0, 0.0, 1.0])

"""Step 7: mirrors and glass; both send rays on, up to MAX_DEPTH."""

import numpy as np

INDEX = 1.5
"""Index of refraction of the glass."""


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
    """Closest hit: diffuse light with a shadow ray, and a little from everywhere."""
    light = to_sun(hits)
    cosine = np.maximum(dot(hits.facing_normal, light), 0)
    seen = hits.trace("Shadow", light, kind="shadow", where=cosine > 0)[:, 0]
    return base(hits) * (0.3 + 0.9 * cosine * seen)[:, None]


def reflect(d, n):
    return d - 2 * dot(d, n)[:, None] * n


def mirror(hits):
    """Closest hit of a mirror: SPECULAR times what the mirror direction sees."""
    seen = hits.trace("Phong", reflect(hits.direction, hits.facing_normal), kind="reflection")
    return hits.color("SPECULAR") * seen[:, :3]


def glass(hits):
    """Closest hit of glass: reflection and refraction, shared by Schlick's approximation."""
    d, n = hits.direction, hits.facing_normal
    entering = dot(d, hits.face_normal) < 0
    eta = np.where(entering, 1 / INDEX, INDEX).astype(np.float32)
    cosine = np.clip(-dot(d, n), 0, 1)
    behind = 1 - eta**2 * (1 - cosine**2)  # of the squared cosine; below 0 all is reflected
    root = np.sqrt(np.maximum(behind, 0))
    r0 = ((1 - INDEX) / (1 + INDEX)) ** 2
    share = r0 + (1 - r0) * (1 - np.where(entering, cosine, root)) ** 5
    share = np.where(behind < 0, 1, share)[:, None]
    refracted = eta[:, None] * d + (eta * cosine - root)[:, None] * n
    through = hits.trace("Phong", refracted, kind="refraction", where=behind > 0)[:, :3]
    mirrored = hits.trace("Phong", reflect(d, n), kind="reflection")[:, :3]
    return share * mirrored + (1 - share) * through


def clear(hits):
    """Any hit of shadow rays: glass lets the light through."""
    return np.zeros(len(hits), bool)


def sky(rays):
    """Miss: a pale sky, brighter at the horizon."""
    up = np.clip(rays.direction[:, 1:2], 0, 1)
    return np.float32([0.85, 0.9, 0.95]) * (1 - up) + np.float32([0.35, 0.6, 0.95]) * up


def lit(rays):
    """Miss of a shadow ray: nothing is in the way."""
    return np.float32([1, 1, 1])

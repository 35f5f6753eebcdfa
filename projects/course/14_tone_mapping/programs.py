"""Step 14: as step 13; the brightness of the picture is the work of the last pass."""

import numpy as np

INDEX = 1.5
"""Index of refraction of the glass."""


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
    """Closest hit: sunlight with a shadow ray, and one ray into the hemisphere for all the rest."""
    light = to_sun(hits)
    cosine = np.maximum(dot(hits.facing_normal, light), 0)
    seen = hits.trace("Shadow", light, kind="shadow", where=cosine > 0)[:, 0]
    sunlight = float(hits.variables["sun"][0]) * cosine * seen
    around = hits.trace("Phong", hemisphere(hits), kind="indirect")[:, :3]
    return base(hits) * (sunlight[:, None] + around)


def reflect(d, n):
    return d - 2 * dot(d, n)[:, None] * n


def mirror(hits):
    """Closest hit of a mirror: SPECULAR times what the mirror direction sees."""
    seen = hits.trace("Phong", reflect(hits.direction, hits.facing_normal), kind="reflection")
    return hits.color("SPECULAR") * seen[:, :3]


def glass(hits):
    """Closest hit of glass: reflects or refracts, by chance, in Fresnel's proportion (Schlick)."""
    d, n = hits.direction, hits.facing_normal
    entering = dot(d, hits.face_normal) < 0
    eta = np.where(entering, 1 / INDEX, INDEX).astype(np.float32)
    cosine = np.clip(-dot(d, n), 0, 1)
    behind = 1 - eta**2 * (1 - cosine**2)
    root = np.sqrt(np.maximum(behind, 0))
    r0 = ((1 - INDEX) / (1 + INDEX)) ** 2
    share = r0 + (1 - r0) * (1 - np.where(entering, cosine, root)) ** 5
    mirrored = (hits.random(6) < share) | (behind < 0)
    refracted = eta[:, None] * d + (eta * cosine - root)[:, None] * n
    away = np.where(mirrored[:, None], reflect(d, n), refracted).astype(np.float32)
    return hits.trace("Phong", away, kind="refraction")[:, :3]


def dimmed(hits):
    """Any hit of shadow rays: glass lets most of the light through."""
    return hits.random(7) < 0.1


def sky(rays):
    """Miss: a pale sky, brighter at the horizon."""
    up = np.clip(rays.direction[:, 1:2], 0, 1)
    return np.float32([0.4, 0.43, 0.45]) * (1 - up) + np.float32([0.2, 0.3, 0.45]) * up


def lit(rays):
    """Miss of a shadow ray: nothing is in the way."""
    return np.float32([1, 1, 1])

"""Step 13: all light: one ray a bounce, many paths a pixel."""

import numpy as np

from common import INDEX, base, dot, hemisphere, reflect, to_sun


def shade(hits):
    """Closest hit: sunlight with a shadow ray, and one ray into the hemisphere for all the rest."""
    light = to_sun(hits)
    cosine = np.maximum(dot(hits.facing_normal, light), 0)
    seen = hits.trace("Shadow", light, kind="shadow", where=cosine > 0)[:, 0]
    sunlight = float(hits.variables["sun"][0]) * cosine * seen
    around = hits.trace("Phong", hemisphere(hits), kind="indirect")[:, :3]
    return base(hits) * (sunlight[:, None] + around)


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

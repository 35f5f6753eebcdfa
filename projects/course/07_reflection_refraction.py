"""Step 7: mirrors and glass; both send rays on, up to MAX_DEPTH."""

import numpy as np

from common import INDEX, dot, reflect


def mirror(hits):
    """Closest hit of a mirror: SPECULAR times the colour in the mirror direction."""
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

"""Step 10: mirrors that scatter: directions about the mirror direction."""

import numpy as np

from common import dot, frame, reflect


def glossy(hits):
    """Closest hit of brushed metal: a ray about the mirror direction, by Phong's lobe."""
    axis = reflect(hits.direction, hits.facing_normal)
    exponent = float(hits.variables["glossiness"][0])
    cosine = hits.random(4) ** (1 / (exponent + 1))
    sine, angle = np.sqrt(1 - cosine**2), 2 * np.pi * hits.random(5)
    s, t = frame(axis)
    lobe = cosine[:, None] * axis
    lobe = lobe + (sine * np.cos(angle))[:, None] * s + (sine * np.sin(angle))[:, None] * t
    above = dot(lobe, hits.facing_normal) > 0
    seen = hits.trace("Phong", lobe.astype(np.float32), kind="reflection", where=above)
    return hits.color("SPECULAR") * seen[:, :3]

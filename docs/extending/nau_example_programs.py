"""Ray programs: a closest-hit program that paints in three steps of light."""

from __future__ import annotations

import numpy as np

STEPS = 3


def shade(hits):
    """Closest hit: the diffuse colour, times the cosine to the first light in steps."""
    to_light = -np.asarray(hits.lights[0].values["DIRECTION"][:3], np.float32)
    to_light /= np.linalg.norm(to_light)
    cosine = np.maximum(hits.facing_normal @ to_light, 0)
    steps = np.ceil(cosine * STEPS) / STEPS
    return hits.color("DIFFUSE")[..., :3] * (0.2 + 0.8 * steps[:, None])

"""Step 3: normals and a light: Lambert's cosine."""

import numpy as np

from common import base, dot, to_sun


def shade(hits):
    """Closest hit: diffuse light by the cosine of its angle, and a little from everywhere."""
    cosine = np.maximum(dot(hits.facing_normal, to_sun(hits)), 0)
    return base(hits) * (0.3 + 0.9 * cosine)[:, None]

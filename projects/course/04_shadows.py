"""Step 4: a second ray type finds out if the light is visible."""

import numpy as np

from common import base, dot, to_sun


def shade(hits):
    """Closest hit: diffuse light with a shadow ray, and a little from everywhere."""
    light = to_sun(hits)
    cosine = np.maximum(dot(hits.facing_normal, light), 0)
    seen = hits.trace("Shadow", light, kind="shadow", where=cosine > 0)[:, 0]
    return base(hits) * (0.3 + 0.9 * cosine * seen)[:, None]

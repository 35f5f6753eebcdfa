"""Step 11: the part of the sky that is open within a distance."""

import numpy as np

from common import base, hemisphere


def shade(hits):
    """Closest hit: one ray into the hemisphere a sample; white if it gets far enough."""
    reach = np.full(len(hits), float(hits.variables["reach"][0]), np.float32)
    return base(hits) * hits.trace("Shadow", hemisphere(hits), reach, kind="occlusion")[:, :1]

"""Step 6: rays go on through glass, straight; its shadow is pale."""

import numpy as np


def tinted(hits):
    """Closest hit of glass: the colour behind it, straight on, dimmed by its own."""
    behind = hits.trace("Phong", hits.direction, kind="refraction")[:, :3]
    return np.float32([0.75, 0.9, 0.85]) * behind


def dimmed(hits):
    """Any hit of shadow rays: one in four stops at each side of the glass."""
    return hits.random(7) < 0.25

"""Step 9: a light with a size; each sample takes another point of it."""

import numpy as np

from common import base, dot


def towards_sun(hits):
    """Return unit vectors to points of the sun's disc, of radius ``sun_radius`` at distance 1."""
    axis = -hits.lights[0].vector("DIRECTION")
    axis = axis / np.sqrt(dot(axis, axis))
    side = np.cross(axis, np.float32([0, 1, 0]) if abs(axis[1]) < 0.9 else np.float32([1, 0, 0]))
    side = (side / np.sqrt(dot(side, side))).astype(np.float32)
    up = np.cross(axis, side).astype(np.float32)
    radius = float(hits.variables["sun_radius"][0]) * np.sqrt(hits.random(2))
    angle = 2 * np.pi * hits.random(3)
    offset = radius[:, None] * (np.cos(angle)[:, None] * side + np.sin(angle)[:, None] * up)
    towards = axis + offset
    return towards / np.sqrt(dot(towards, towards))[:, None]


def shade(hits):
    """Closest hit: diffuse light from one point of the sun a sample, with a shadow ray."""
    light = towards_sun(hits)
    cosine = np.maximum(dot(hits.facing_normal, light), 0)
    seen = hits.trace("Shadow", light, kind="shadow", where=cosine > 0)[:, 0]
    return base(hits) * (0.3 + 0.9 * cosine * seen)[:, None]

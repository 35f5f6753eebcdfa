"""Step 12: a lens with a size: only surfaces at one distance are sharp."""

import numpy as np

from common import dot


def camera(launch):
    """Ray generation: from the lens to the point in which the pixel's ray meets the sharp plane."""
    side = round(launch.samples**0.5)
    side = side if side * side == launch.samples else 1  # other numbers have no grid
    x = launch.x + (launch.sample % side + launch.random(0)) / side
    y = launch.y + (launch.sample // side % side + launch.random(1)) / side
    origin, direction = launch.camera_rays(x, y)
    forward, right, up = (launch.variables[k][:3] for k in ("view", "right", "up"))
    sharp = (
        origin
        + direction * (float(launch.variables["focus"][0]) / dot(direction, forward))[:, None]
    )
    radius = float(launch.variables["aperture"][0]) * np.sqrt(launch.random(2))
    angle = 2 * np.pi * launch.random(3)
    lens = (radius * np.cos(angle))[:, None] * right + (radius * np.sin(angle))[:, None] * up
    start = (origin + lens).astype(np.float32)
    towards = sharp - start
    return launch.trace("Phong", start, towards / np.sqrt(dot(towards, towards))[:, None])

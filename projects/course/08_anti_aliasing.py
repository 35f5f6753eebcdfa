"""Step 8: several rays a pixel, each in its own cell of a grid."""


def camera(launch):
    """Ray generation: each sample has its own cell of a grid over the pixel, and a place in it."""
    side = round(launch.samples**0.5)
    side = side if side * side == launch.samples else 1  # other numbers have no grid
    x = launch.x + (launch.sample % side + launch.random(0)) / side
    y = launch.y + (launch.sample // side % side + launch.random(1)) / side
    origin, direction = launch.camera_rays(x, y)
    return launch.trace("Phong", origin, direction)

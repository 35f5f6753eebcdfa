"""``pinhole``: camera rays through one point."""

from __future__ import annotations

from typing import Any

import numpy as np

from nau_py.raytrace.kernels.core.jit import V3, inner
from nau_py.raytrace.kernels.path.camera import compute_camera_ray
from nau_py.raytrace.programs.description import RAY_GENERATION, BuiltInProgram


@inner
def generate_pinhole(
    camera: Any, seed: np.uint32, pixel: np.uint32, sample: np.uint32, x: float, y: float
) -> tuple[V3, V3]:
    """Return origin and direction of the ray through image point (x, y), in pixels."""
    return compute_camera_ray(camera, x, y, 0.0, 0.0)


PROGRAM = BuiltInProgram(
    "pinhole",
    RAY_GENERATION,
    "One ray through each sample of the pass camera, of the first ray type.",
    generate_pinhole,
)

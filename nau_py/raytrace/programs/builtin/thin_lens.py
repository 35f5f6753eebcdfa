"""``thin_lens``: camera rays through the points of a lens."""

from __future__ import annotations

from typing import Any

import numpy as np

from nau_py.raytrace.kernels.core.jit import V3, inner
from nau_py.raytrace.kernels.core.sampling import sample_2d, sample_disk
from nau_py.raytrace.kernels.path.camera import compute_camera_ray
from nau_py.raytrace.programs.description import RAY_GENERATION, BuiltInProgram, Effect

LENS_DIMENSION = np.uint32(2)
"""Dimension of the lens sample; 0 and 1 are those of the sample in the pixel."""


@inner
def generate_thin_lens(
    camera: Any, seed: np.uint32, pixel: np.uint32, sample: np.uint32, x: float, y: float
) -> tuple[V3, V3]:
    """Return origin and direction of a ray through image point (x, y), in pixels, and a random
    point of the lens."""
    a, b = sample_2d(seed, pixel, sample, LENS_DIMENSION)
    lx, ly = sample_disk(a, b)
    return compute_camera_ray(camera, x, y, lx, ly)


PROGRAM = BuiltInProgram(
    "thin_lens",
    RAY_GENERATION,
    "As `pinhole`, through a lens of the camera's APERTURE, sharp at FOCUS_DISTANCE.",
    generate_thin_lens,
    effects=(Effect("depth_of_field", ("APERTURE",)),),
    without_effects="pinhole",
)

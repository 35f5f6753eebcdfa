"""Random numbers for Python programs, keyed by (seed, pixel, sample, dimension), not call order."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.kernels.path.hit_arrays import fill_uniforms

U32 = NDArray[np.uint32]


def sample_uniform(seed: int, pixel: U32, sample: U32, dimension: int) -> NDArray[np.float32]:
    """Return numbers in [0, 1), float32 (n,), for uint32 (n,) pixels and samples."""
    result = np.empty(len(pixel), np.float32)
    fill_uniforms(seed & 0xFFFFFFFF, pixel, sample, dimension & 0xFFFFFFFF, result)
    return result

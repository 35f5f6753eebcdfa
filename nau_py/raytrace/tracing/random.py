"""Random numbers keyed by (seed, pixel, sample, dimension), never by call order, for programs."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.kernels.path.hit_arrays import fill_uniforms

U32 = NDArray[np.uint32]


def uniform(seed: int, pixel: U32, sample: U32, dimension: int) -> NDArray[np.float32]:
    """Numbers in [0, 1), float32 (n,), for uint32 (n,) pixels and samples."""
    result = np.empty(len(pixel), np.float32)
    fill_uniforms(seed & 0xFFFFFFFF, pixel, sample, dimension & 0xFFFFFFFF, result)
    return result

"""Weights to samples: the number of samples that each selected pixel gets."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.selection.pixels import I64

SAMPLES = "spp"
"""Value of ``weight`` for which weights mean samples; by default they blend colours."""


def distribute_samples(
    mask: NDArray[Any] | None, pixels: I64, samples: int, meaning: str | None
) -> I64 | None:
    """Return the samples of each pixel, int64 (n,), or None for ``samples`` in every pixel.

    ``mask`` (height, width) holds weights, ``pixels`` (n,) flat indices into it. With ``meaning``
    "spp" a pixel gets weight · samples, rounded, at least 1; weights are clamped to 0..1.
    """
    if mask is None or meaning != SAMPLES:
        return None
    weights = np.clip(mask.reshape(-1)[pixels].astype(np.float64), 0.0, 1.0)
    return np.maximum(np.rint(weights * samples), 1).astype(np.int64)

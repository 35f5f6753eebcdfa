"""Weights to pixels: the pixels that a mask selects."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

I64 = NDArray[np.int64]


def select_pixels(mask: NDArray[Any] | None, width: int, height: int) -> I64:
    """Return the flat indices (row · width + column, row 0 at the bottom) of the pixels to trace.

    ``mask`` (height, width): pixels with a weight above 0; None selects all.
    """
    if mask is None:
        return np.arange(width * height)
    return np.flatnonzero(mask.reshape(-1) > 0)

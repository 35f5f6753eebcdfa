"""Vector arithmetic on batches, written so that a result never depends on the batch size.

Every operation is elementwise: no matrix product and no reduction whose order numpy chooses.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating[Any]]
F32 = NDArray[np.float32]
Mask = NDArray[np.bool_]


def dot(a: Array, b: Array) -> Array:
    """Dot products of two (n, 3) batches, (n,)."""
    return a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1] + a[:, 2] * b[:, 2]


def normalize(a: Array) -> Array:
    """Unit vectors, (n, 3); zero vectors stay zero."""
    length = np.sqrt(dot(a, a))
    return a / np.where(length > 0, length, 1)[:, None]


def cross(a: Array, b: Array) -> Array:
    """Cross products of two (n, 3) batches."""
    return np.stack(
        [
            a[:, 1] * b[:, 2] - a[:, 2] * b[:, 1],
            a[:, 2] * b[:, 0] - a[:, 0] * b[:, 2],
            a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0],
        ],
        axis=1,
    )


def reflect(direction: Array, normal: Array) -> Array:
    """Mirror directions about unit normals: d - 2 (d·n) n, (n, 3)."""
    return direction - 2 * dot(direction, normal)[:, None] * normal

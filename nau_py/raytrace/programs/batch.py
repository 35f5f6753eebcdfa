"""The built-in programs as the engine runs them: codes of kernels, and the few in Python."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.kernels.core.codes import ANY_HIT_CODES, CLOSEST_CODES, MISS_CODES
from nau_py.raytrace.programs.description import (
    ANY_HIT,
    CLOSEST_HIT,
    EXCEPTION,
    MISS,
    RAY_GENERATION,
)

PINHOLE, THIN_LENS = 1, 2


def magenta(launch: object) -> NDArray[np.float32]:
    """Paints failed samples magenta."""
    return np.array([1.0, 0.0, 1.0, 1.0], np.float32)


CODES: dict[str, dict[str, int]] = {
    RAY_GENERATION: {"pinhole": PINHOLE, "thin_lens": THIN_LENS},
    CLOSEST_HIT: CLOSEST_CODES,
    ANY_HIT: ANY_HIT_CODES,
    MISS: MISS_CODES,
}
"""Code by kind and name of the compiled programs."""
FUNCTIONS: dict[str, dict[str, Callable[[Any], Any]]] = {EXCEPTION: {"magenta": magenta}}
"""Those written in Python, by kind and name."""

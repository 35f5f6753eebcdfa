"""``magenta``: the colour of failed samples."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.programs.description import EXCEPTION, BuiltInProgram


def return_magenta(launch: Any) -> NDArray[np.float32]:
    """Return magenta, RGBA float32 (4,)."""
    return np.array([1.0, 0.0, 1.0, 1.0], np.float32)


PROGRAM = BuiltInProgram(
    "magenta", EXCEPTION, "Paints failed samples magenta.", function=return_magenta
)

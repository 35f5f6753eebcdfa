"""``one_sided``: hits on back faces are ignored."""

from __future__ import annotations

from typing import Any

import numpy as np

from nau_py.raytrace.kernels.core.jit import V3, inner
from nau_py.raytrace.kernels.core.vec import dot
from nau_py.raytrace.kernels.geometry.surface import locate_point
from nau_py.raytrace.programs.description import ANY_HIT, BuiltInProgram


@inner
def accept_front_face(
    scene: Any, material: Any, triangle: int, u: float, v: float, direction: V3,
    pixel: np.uint32, sample: np.uint32, depth: int,
) -> float:  # fmt: skip
    """Return 1 for a front face, 0 for a back face."""
    return 1.0 if dot(locate_point(scene, triangle, u, v)[1], direction) < 0.0 else 0.0


PROGRAM = BuiltInProgram(
    "one_sided",
    ANY_HIT,
    "Ignores hits on back faces, as rasterisation culls them.",
    accept_front_face,
    geometric=True,
)

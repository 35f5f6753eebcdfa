"""``alpha_test``: hits on texels of little alpha are ignored."""

from __future__ import annotations

from typing import Any

import numpy as np

from nau_py.raytrace.kernels.core.jit import V3, inner
from nau_py.raytrace.kernels.geometry.surface import evaluate_alpha
from nau_py.raytrace.programs.description import ANY_HIT, AlphaTest, BuiltInProgram

ALPHA_THRESHOLD = 0.25
"""Alpha up to which hits are ignored."""


@inner
def accept_opaque(
    scene: Any, material: Any, triangle: int, u: float, v: float, direction: V3,
    pixel: np.uint32, sample: np.uint32, depth: int,
) -> float:  # fmt: skip
    """Return 1 where the texture's alpha is above the threshold, else 0."""
    alpha = evaluate_alpha(scene, material, triangle, u, v)
    return 1.0 if alpha > ALPHA_THRESHOLD else 0.0


PROGRAM = BuiltInProgram(
    "alpha_test",
    ANY_HIT,
    f"Ignores hits where the texture of unit 0 has alpha up to {ALPHA_THRESHOLD}.",
    accept_opaque,
    alpha=AlphaTest(above=ALPHA_THRESHOLD, uses_diffuse=False),
)

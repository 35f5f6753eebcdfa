"""``stochastic_alpha``: hits accepted with the probability of their alpha."""

from __future__ import annotations

from typing import Any

import numpy as np

from nau_py.raytrace.kernels.core.jit import V3, inner
from nau_py.raytrace.kernels.core.sampling import sample_1d
from nau_py.raytrace.programs.builtin.transparency import evaluate_transparency
from nau_py.raytrace.programs.description import ANY_HIT, AlphaTest, BuiltInProgram

_DIMENSION = 0x40000000
_DEPTHS = 32
"""Depths with random numbers of their own."""


@inner
def accept_by_chance(
    scene: Any, material: Any, triangle: int, u: float, v: float, direction: V3,
    pixel: np.uint32, sample: np.uint32, depth: int,
) -> float:  # fmt: skip
    """Return 1 with the probability of the alpha, else 0.

    Random numbers are keyed by the triangle, so that the result does not depend on the order in
    which Embree finds the hits.
    """
    alpha = evaluate_transparency(scene, material, triangle, u, v, direction, pixel, sample, depth)
    key = np.uint32(_DIMENSION + triangle * _DEPTHS + min(depth, _DEPTHS - 1))
    return 1.0 if sample_1d(scene.seed, pixel, sample, key) < alpha else 0.0


PROGRAM = BuiltInProgram(
    "stochastic_alpha",
    ANY_HIT,
    "Accepts hits with the probability of their alpha: texture of unit 0 times DIFFUSE.",
    accept_by_chance,
    alpha=AlphaTest(),
)

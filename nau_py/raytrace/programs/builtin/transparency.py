"""``transparency``: hits that let a part of the light pass."""

from __future__ import annotations

from typing import Any

import numpy as np

from nau_py.raytrace.kernels.core.jit import V3, inner
from nau_py.raytrace.kernels.core.tables import diffuse_of
from nau_py.raytrace.kernels.geometry.surface import evaluate_alpha
from nau_py.raytrace.programs.description import ANY_HIT, AlphaTest, BuiltInProgram


@inner
def evaluate_transparency(
    scene: Any, material: Any, triangle: int, u: float, v: float, direction: V3,
    pixel: np.uint32, sample: np.uint32, depth: int,
) -> float:  # fmt: skip
    """Return the alpha of texture and DIFFUSE."""
    alpha = evaluate_alpha(scene, material, triangle, u, v)
    part: float = min(max(alpha * diffuse_of(material)[3], 0.0), 1.0)
    return part


PROGRAM = BuiltInProgram(
    "transparency",
    ANY_HIT,
    "Blends by alpha (texture of unit 0 times DIFFUSE): the rest of the ray goes on.",
    evaluate_transparency,
    alpha=AlphaTest(),
    partial=True,
)

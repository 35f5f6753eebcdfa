"""The mask of a raytrace pass over the picture."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.diagnostics.diagnostic import error
from nau_py.diagnostics.errors import NauError
from nau_py.diagnostics.location import NOWHERE
from nau_py.graph.plan import Plan
from nau_py.model.raytrace import RaytracePass
from nau_py.raytrace.selection.mask import read_mask

TINT = (1.0, 0.1, 0.6)
STRENGTH = 0.6


def mask_overlay(image: NDArray[Any], targets: dict[str, NDArray[Any]], plan: Plan) -> NDArray[Any]:
    """``image`` (h, w, 4) with the traced pixels tinted by their weight, same dtype.

    Raises :class:`~nau_py.NauError` where the pipeline traces without a mask.
    """
    for step in plan.running:
        pass_ = step.pass_
        weights = read_mask(pass_, targets) if isinstance(pass_, RaytracePass) else None
        if weights is not None:
            return _tinted(image, np.clip(weights.astype(np.float64), 0, 1))
    raise NauError(
        error(
            "E004",
            plan.steps[0].pass_.location if plan.steps else NOWHERE,
            f"pipeline '{plan.pipeline}' has no raytrace pass with a mask to show",
        )
    )


def _tinted(image: NDArray[Any], weight: NDArray[np.float64]) -> NDArray[Any]:
    rows = (np.arange(image.shape[0]) * weight.shape[0]) // image.shape[0]
    columns = (np.arange(image.shape[1]) * weight.shape[1]) // image.shape[1]
    share = (weight[rows][:, columns] * STRENGTH)[..., None]
    scale = 255.0 if image.dtype == np.uint8 else 1.0
    colour = image[..., :3] * (1 - share) + np.array(TINT) * scale * share
    result = image.copy()
    result[..., :3] = np.rint(colour) if image.dtype == np.uint8 else colour
    return result

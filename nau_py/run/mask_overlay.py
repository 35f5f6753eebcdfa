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
from nau_py.reporting.pixels import tint


def mask_overlay(image: NDArray[Any], targets: dict[str, NDArray[Any]], plan: Plan) -> NDArray[Any]:
    """Return ``image`` (h, w, 4) with the traced pixels tinted by their weight, same dtype.

    Raises :class:`~nau_py.NauError` if the pipeline traces without a mask.
    """
    for step in plan.running:
        pass_ = step.pass_
        weights = read_mask(pass_, targets) if isinstance(pass_, RaytracePass) else None
        if weights is not None:
            return tint(image, np.clip(weights.astype(np.float64), 0, 1))
    raise NauError(
        error(
            "E004",
            plan.steps[0].pass_.location if plan.steps else NOWHERE,
            f"pipeline '{plan.pipeline}' has no raytrace pass with a mask to show",
        )
    )

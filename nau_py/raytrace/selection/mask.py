"""The mask of a raytrace pass, read from the texture that holds it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.model.raytrace import RaytracePass, component


def read_mask(pass_: RaytracePass, textures: Mapping[str, NDArray[Any]]) -> NDArray[Any] | None:
    """Return the weights of a pass, (height, width), or None for a pass without a mask.

    ``textures``: images (height, width, channels) by texture name; rows keep their order. 8-bit
    values become float64 in 0..1, others are returned as they are. None also if the texture of the
    mask is missing.
    """
    source = pass_.mask
    values = textures.get(source.texture or "") if source is not None else None
    if source is None or values is None:
        return None
    weights = values[..., component(source.mask, values.shape[2])]
    return weights.astype(np.float64) / 255 if weights.dtype == np.uint8 else weights


def force_mask(pass_: RaytracePass, values: NDArray[Any], weight: float) -> NDArray[Any]:
    """Return a copy of the mask's texture (height, width, channels) with ``weight`` everywhere."""
    source = pass_.mask
    forced = values.copy()
    if source is not None:
        forced[..., component(source.mask, values.shape[2])] = weight
    return forced

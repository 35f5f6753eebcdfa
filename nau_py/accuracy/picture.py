"""Frames as pictures for comparison."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from PIL import Image

from nau_py.accuracy.metrics import F64, Mask
from nau_py.model.knob import pick_raytrace_passes
from nau_py.model.pipeline import Pipeline
from nau_py.raytrace.selection.mask import read_mask

if TYPE_CHECKING:
    from nau_py.run.frame import Frame


def to_picture(frame: Frame, shown: bool) -> F64:
    """Return the RGB of a frame, float64 (h, w, 3); ``shown``: clamp to 0..1, as a window does."""
    values = frame.image.astype(np.float64)
    if frame.image.dtype.kind in "iu":
        values /= float(np.iinfo(frame.image.dtype).max)
    if values.shape[2] < 3:
        values = np.repeat(values[:, :, :1], 3, axis=2)
    values = values[:, :, :3]
    return np.clip(values, 0.0, 1.0) if shown else values


def enlarge(image: F64, shape: tuple[int, int]) -> F64:
    """Resize ``image`` to (height, width) by bilinear interpolation."""
    if image.shape[:2] == shape:
        return image
    size = shape[1], shape[0]
    planes = [
        np.asarray(
            Image.fromarray(np.ascontiguousarray(image[:, :, k], np.float32)).resize(
                size, Image.Resampling.BILINEAR
            )
        )
        for k in range(image.shape[2])
    ]
    return np.stack(planes, axis=2).astype(np.float64)


def find_traced_pixels(frame: Frame, pipeline: Pipeline) -> Mask | None:
    """Return the pixels that the mask of the raytrace pass selects, bool (h, w), row 0 at the top;
    None without a mask."""
    for pass_ in pick_raytrace_passes(pipeline.passes):
        weights = read_mask(pass_, frame.targets)
        if weights is not None:
            return np.asarray(weights > 0)
    return None

"""A finished frame."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.reporting.notebook import frame_html
from nau_py.reporting.pixels import encode_png


@dataclass(slots=True)
class Frame:
    """A finished frame.

    ``image``: the picture, uint8 (height, width, 4), row 0 at the top; float32 where a pipeline
    without a window pass ends in a float target. ``targets``: every texture that a pass writes,
    by qualified name, (height, width, channels), row 0 at the top, native dtype.
    ``report``: work and time of the frame; the schema is in docs/report.md. ``samples`` and
    ``error``: of each pixel of the raytrace pass's target, the samples taken, int32, and the
    estimated standard error of its colour, root mean square over RGB, float32, (height, width),
    row 0 at the top; None where nothing was traced.
    """

    index: int
    image: NDArray[Any]
    targets: dict[str, NDArray[Any]]
    report: dict[str, Any]
    samples: NDArray[np.int32] | None = None
    error: NDArray[np.float32] | None = None

    def _repr_png_(self) -> bytes:
        """Return the picture, for notebooks."""
        return encode_png(self.image)

    def _repr_html_(self) -> str:
        """Return the picture and the cost of each pass, for notebooks."""
        return frame_html(self.image, self.report)

"""Pose animation: vertices moved by weighted offsets (docs/format.md, 10.5 and 11.8)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class PoseTrack:
    """Poses of one mesh over time.

    ``offsets`` float32 (poses, vertices, 3), object space; ``times`` float64 (keys,), seconds;
    ``influences`` float64 (keys, poses); ``length`` of the animation, seconds.
    """

    offsets: NDArray[np.float32]
    times: NDArray[np.float64]
    influences: NDArray[np.float64]
    length: float

    def offset(self, time: float) -> NDArray[np.float32]:
        """Sum the weighted offsets at ``time``, float32 (vertices, 3).

        The weights are linear between keys. As in Nau the sum is 0 before the first key and after
        the last.
        """
        after = int(np.searchsorted(self.times, time, side="left"))
        if after == 0 or after == len(self.times):
            return np.zeros(self.offsets.shape[1:], np.float32)
        part = (time - self.times[after - 1]) / (self.times[after] - self.times[after - 1])
        weights = (1 - part) * self.influences[after - 1] + part * self.influences[after]
        return np.asarray(np.tensordot(weights.astype(np.float32), self.offsets, 1), np.float32)

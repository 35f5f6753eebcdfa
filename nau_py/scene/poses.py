"""Pose animation: vertices moved by weighted offsets (docs/format.md, 10.5 and 11.8)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nau_py.scene.mesh import F32, F64


@dataclass(frozen=True, slots=True)
class PoseTrack:
    """Of one object: ``offsets`` float32 (poses, vertices, 3), object space; ``times`` float64
    (keys,), seconds; ``influences`` float64 (keys, poses)."""

    offsets: F32
    times: F64
    influences: F64

    def offset(self, time: float) -> F32:
        """The sum of offsets at ``time``, (vertices, 3): linear between keys; none before the first
        key and after the last, as in Nau."""
        after = int(np.searchsorted(self.times, time, side="left"))
        if after == 0 or after == len(self.times):
            return np.zeros(self.offsets.shape[1:], np.float32)
        part = (time - self.times[after - 1]) / (self.times[after] - self.times[after - 1])
        weights = (1 - part) * self.influences[after - 1] + part * self.influences[after]
        return np.asarray(np.tensordot(weights.astype(np.float32), self.offsets, 1), np.float32)


@dataclass(frozen=True, slots=True)
class PoseAnimation:
    """Tracks by the index of the object in its file, and how long they take, seconds."""

    length: float
    tracks: dict[int, PoseTrack]

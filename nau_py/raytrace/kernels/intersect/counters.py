"""Counters of a tile: rays by kind, rays that are not sent, cycles spent in Embree."""

from __future__ import annotations

from math import isfinite
from typing import Any

from nau_py.raytrace.kernels.core.jit import V3, inner, read_cycles
from nau_py.raytrace.kernels.core.memory import i64, put_i64
from nau_py.raytrace.kernels.core.tables import IN_EMBREE, NONFINITE
from nau_py.raytrace.kernels.core.vec import dot


@inner
def increment_counter(tile: Any, slot: int) -> None:
    """Add 1 to the counter ``slot``."""
    put_i64(tile.counts, slot, i64(tile.counts, slot) + 1)


@inner
def add_ray_cycles(tile: Any, since: int) -> None:
    """Add the processor cycles since ``since`` to those that rays took."""
    put_i64(tile.counts, IN_EMBREE, i64(tile.counts, IN_EMBREE) + read_cycles() - since)


@inner
def is_skipped(scene: Any, kind: int) -> bool:
    """Test if rays of ``kind`` are left out of this launch."""
    return (scene.skipped >> kind) & 1 != 0


@inner
def is_finite(v: V3) -> bool:
    """Test if all components are finite."""
    return isfinite(v[0]) and isfinite(v[1]) and isfinite(v[2])


@inner
def check_ray(tile: Any, origin: V3, direction: V3) -> bool:
    """Test if Embree may get this ray. Count a ray that is not finite or has no direction."""
    if is_finite(origin) and is_finite(direction) and dot(direction, direction) > 0.0:
        return True
    increment_counter(tile, NONFINITE)
    return False

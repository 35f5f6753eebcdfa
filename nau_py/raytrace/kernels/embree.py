"""Single rays through Embree's C functions, called from compiled code.

The symbols are found by name: ``raytrace/accel.py`` loads the library before any kernel runs.
"""

from __future__ import annotations

from typing import Any

from numba import types

from nau_py.raytrace.kernels.jit import V3, inner
from nau_py.raytrace.kernels.memory import f32, i32, put_f32, put_i32

_ARGUMENTS = (types.uintp, types.uintp, types.uintp)
rtcIntersect1 = types.ExternalFunction("rtcIntersect1", types.void(*_ARGUMENTS))
rtcOccluded1 = types.ExternalFunction("rtcOccluded1", types.void(*_ARGUMENTS))
INVALID = -1
"""RTC_INVALID_GEOMETRY_ID, as an int32."""
RAY_FLOATS = 32
"""Size of the ray buffer, float32: RTCRayHit with room to spare."""
INFINITE = float("inf")


@inner
def _fill(ray: int, origin: V3, direction: V3, tmax: float) -> None:
    """RTCRay of rtcore_ray.h: origin, tnear, direction, time, tfar, mask, id, flags."""
    put_f32(ray, 0, origin[0])
    put_f32(ray, 1, origin[1])
    put_f32(ray, 2, origin[2])
    put_f32(ray, 3, 0.0)
    put_f32(ray, 4, direction[0])
    put_f32(ray, 5, direction[1])
    put_f32(ray, 6, direction[2])
    put_f32(ray, 7, 0.0)
    put_f32(ray, 8, tmax)
    put_i32(ray, 9, -1)
    put_i32(ray, 10, 0)
    put_i32(ray, 11, 0)


@inner
def _clear(ray: int) -> None:
    put_i32(ray, 18, INVALID)
    put_i32(ray, 19, INVALID)
    put_i32(ray, 20, INVALID)


@inner
def nearest(scene: Any, ray: int, origin: V3, direction: V3, tmax: float) -> int:
    """The first triangle that a finite ray hits, or -1; ``hit`` then tells t, u and v.

    What stands still and what moves lie in two scenes: the nearer hit counts, at equal distance
    the moving one.
    """
    found = -1
    _fill(ray, origin, direction, tmax)
    _clear(ray)
    if scene.standing != 0:
        rtcIntersect1(scene.standing, ray, 0)
        if i32(ray, 18) != INVALID:
            found = i32(ray, 17)
    if scene.moving != 0:
        _clear(ray)
        rtcIntersect1(scene.moving, ray, 0)
        if i32(ray, 18) != INVALID:
            found = i32(ray, 17) + scene.first_moving
    # beyond about 1e18 Embree's distances overflow: such a hit is none
    return found if f32(ray, 8) < INFINITE else -1


@inner
def hit(ray: int) -> V3:
    """Distance and barycentrics of the hit that ``nearest`` found."""
    return f32(ray, 8), f32(ray, 15), f32(ray, 16)


@inner
def blocked(scene: Any, ray: int, origin: V3, direction: V3, tmax: float) -> bool:
    """Whether a finite ray hits anything before ``tmax``. Embree says so by tfar = -inf."""
    if scene.standing != 0:
        _fill(ray, origin, direction, tmax)
        rtcOccluded1(scene.standing, ray, 0)
        if f32(ray, 8) < 0.0:
            return True
    if scene.moving != 0:
        _fill(ray, origin, direction, tmax)
        rtcOccluded1(scene.moving, ray, 0)
        return bool(f32(ray, 8) < 0.0)
    return False

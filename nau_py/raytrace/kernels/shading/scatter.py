"""Steps that continue a path at a surface: mirror and diffuse directions, ignored hits."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np

from nau_py.raytrace.kernels.core.jit import V3, inner
from nau_py.raytrace.kernels.core.sampling import sample_2d, sample_hemisphere
from nau_py.raytrace.kernels.core.tables import (
    INDIRECT,
    REFLECTION,
    TRACE,
    heading_of,
    set_heading,
    set_origin,
)
from nau_py.raytrace.kernels.core.vec import dot, from_frame, make_frame, reflect
from nau_py.raytrace.kernels.geometry.surface import (
    face_forward,
    keep_above,
    locate_point,
    offset_origin,
)
from nau_py.raytrace.kernels.intersect.embree import INFINITE
from nau_py.raytrace.kernels.shading.radiance import scale_weight

ROULETTE_DEPTH = 4
"""Depth from which diffuse paths end by Russian roulette."""
HIT_DIMENSIONS = 16
"""Dimensions of a hit, by depth."""
FIRST, SECOND, THIRD, FOURTH = 0, 1, 2, 3
"""Dimensions of a hit: direction, emitter point, choices, band."""
INVERSE_PI = 1.0 / pi


@inner
def hit_dimension(path: Any, which: int) -> np.uint32:
    """Return the dimension of a random number at the present depth of a path."""
    return np.uint32(HIT_DIMENSIONS * path.depth + which)


@inner
def leave_surface(path: Any, hit: Any, direction: V3, kind: int) -> None:
    """Continue the path from a hit along the unit ``direction``, as a ray of ``kind``."""
    set_origin(path, offset_origin(hit.position, hit.face, hit.bound, direction))
    set_heading(path, direction)
    path.tmax = INFINITE
    path.travelled = 0.0
    path.depth += 1
    path.layers = 0
    path.kind = kind
    path.status = TRACE


@inner
def pass_hit(scene: Any, path: Any) -> None:
    """Continue the path behind an ignored hit, in the same direction."""
    p, n, bound = locate_point(scene, int(path.triangle), float(path.u), float(path.v))
    set_origin(path, offset_origin(p, n, bound, heading_of(path)))
    path.tmax = max(path.tmax - path.t, np.float32(0.0))
    path.travelled += path.t
    path.layers += 1
    path.status = TRACE


@inner
def is_significant(scene: Any, throughput: float) -> bool:
    """Test if a specular chain of this weight continues."""
    return throughput > 0.0 and throughput >= scene.negligible


@inner
def continue_mirrored(scene: Any, path: Any, hit: Any, specular: V3) -> bool:
    """Continue the path in the mirror direction, weighted by ``specular``.

    Return True if its weight is significant.
    """
    going = is_significant(scene, scale_weight(path, specular))
    d = hit.direction
    direction = keep_above(reflect(d, hit.normal), face_forward(hit.face, d))
    path.pdf = 0.0
    leave_surface(path, hit, direction, REFLECTION)
    return going


@inner
def survive_roulette(scene: Any, path: Any, largest: float) -> bool:
    """Play Russian roulette with a deep path whose largest weight is ``largest``; a survivor's
    weight grows. Return False if the path ends."""
    if path.depth >= ROULETTE_DEPTH:
        survival = min(max(largest, 0.05), 0.95)
        chance = sample_2d(scene.seed, path.pixel, path.sample, hit_dimension(path, THIRD))[1]
        if chance >= survival:
            return False
        more = 1.0 / survival
        scale_weight(path, (more, more, more))
    return True


@inner
def sample_cosine_direction(scene: Any, path: Any, hit: Any) -> tuple[V3, float]:
    """Sample a direction with density cos/π about the normal. Return it, and its cosine; 0 for a
    direction below the face."""
    s, t = make_frame(hit.normal)
    x, y = sample_2d(scene.seed, path.pixel, path.sample, hit_dimension(path, FIRST))
    out = sample_hemisphere(x, y)
    direction = from_frame(s, t, hit.normal, out[0], out[1], out[2])
    if not (dot(direction, face_forward(hit.face, hit.direction)) > 0.0 and out[2] > 0.0):
        return direction, 0.0
    return direction, out[2]


@inner
def leave_diffusely(path: Any, hit: Any, direction: V3, cosine: float) -> None:
    """Continue the path along a direction from ``sample_cosine_direction``."""
    path.pdf = cosine * INVERSE_PI
    path.scattered = 1
    leave_surface(path, hit, direction, INDIRECT)


@inner
def continue_diffusely(scene: Any, path: Any, hit: Any, albedo: V3) -> bool:
    """Continue the path from a diffuse surface in a cosine-weighted direction.

    Return False if the path ends: without weight, by Russian roulette, or below the face.
    """
    largest = scale_weight(path, albedo)
    if not (largest > 0.0 and survive_roulette(scene, path, largest)):
        return False
    direction, cosine = sample_cosine_direction(scene, path, hit)
    if not cosine > 0.0:
        return False
    leave_diffusely(path, hit, direction, cosine)
    return True

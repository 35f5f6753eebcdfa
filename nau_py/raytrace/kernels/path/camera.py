"""Generation of camera rays: sample positions in a pixel, pinhole and thin lens."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.kernels.core.jit import V3, inner, kernel
from nau_py.raytrace.kernels.core.kernel_tables import RAY_GENERATION_KERNELS
from nau_py.raytrace.kernels.core.memory import field_reader
from nau_py.raytrace.kernels.core.sampling import sample_1d, sample_2d
from nau_py.raytrace.kernels.core.tables import (
    PRIMARY,
    TRACE,
    set_heading,
    set_media,
    set_origin,
    set_weight,
)
from nau_py.raytrace.kernels.core.vec import add, dot, normalize, scale, subtract

CAMERA = np.dtype(
    [
        ("position", "f8", 3),
        ("forward", "f8", 3),
        ("right", "f8", 3),
        ("up", "f8", 3),
        ("base", "f8", 2),
        ("step", "f8", 2),
        ("near", "f8"),
        ("aperture", "f8"),
        ("focus", "f8"),
        ("ortho", "i4"),
    ],
    align=True,
)
"""``base`` and ``step``: image plane coordinates (at distance 1 for perspective) of the target's
lower left corner, and the size of a pixel there. ``aperture``: radius of the lens; ``focus``:
distance along ``forward`` at which it is sharp."""

_position, _forward = field_reader(CAMERA, "position"), field_reader(CAMERA, "forward")
_right, _up = field_reader(CAMERA, "right"), field_reader(CAMERA, "up")
_base, _step = field_reader(CAMERA, "base"), field_reader(CAMERA, "step")

_generate_ray = RAY_GENERATION_KERNELS.run
CENTRE, JITTER, STRATA, SOBOL = range(4)
"""Sample positions in a pixel: its centre, random, stratified, a Sobol sequence."""
ITEM = np.dtype([("pixel", "i8"), ("first", "i4"), ("count", "i4")], align=True)
"""A pixel to sample: flat index (row · width + column), first sample number, sample count."""


@inner
def compute_camera_ray(camera: Any, x: float, y: float, lx: float, ly: float) -> tuple[V3, V3]:
    """Compute origin on the near plane and unit direction of the ray through image point (x, y).

    (x, y) in pixels; (lx, ly): a point of the unit disk on the lens. Thin lens: Kolb, Mitchell,
    Hanrahan, *A Realistic Camera Model for Computer Graphics*, 1995.
    """
    base, step = _base(camera), _step(camera)
    sx, sy = base[0] + x * step[0], base[1] + y * step[1]
    forward, right, up = _forward(camera), _right(camera), _up(camera)
    across = add(scale(right, sx), scale(up, sy))
    position = _position(camera)
    if camera.ortho:
        return add(position, add(scale(forward, camera.near), across)), forward
    plane = add(forward, across)
    if not camera.aperture > 0.0:
        return add(position, scale(plane, camera.near)), normalize(plane)
    sharp = add(position, scale(plane, camera.focus))
    offset = add(scale(right, camera.aperture * lx), scale(up, camera.aperture * ly))
    lens = add(position, offset)
    d = normalize(subtract(sharp, lens))
    return add(lens, scale(d, camera.near / dot(d, forward))), d


@kernel
def compute_camera_rays(
    cameras: Any,
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    origin: NDArray[np.float32],
    direction: NDArray[np.float32],
) -> None:
    """Compute the rays through image points (n,), through the centre of the lens."""
    for i in range(x.shape[0]):
        o, d = compute_camera_ray(cameras[0], x[i], y[i], 0.0, 0.0)
        for k in range(3):
            origin[i, k] = o[k]
            direction[i, k] = d[k]


@inner
def reset_path(path: Any) -> None:
    """Set the state of a new path: weight 1, in vacuum."""
    set_weight(path, (1.0, 1.0, 1.0, 1.0))
    set_media(path, (-1, -1, -1, -1))
    path.tmax = np.inf
    path.travelled = 0.0
    path.pdf = 0.0
    path.initial = 0.0
    path.depth = 1
    path.layers = 0
    path.band = -1
    path.scattered = 0
    path.kind = PRIMARY
    path.status = TRACE


@inner
def start_camera_path(
    camera: Any,
    code: int,
    rule: int,
    side: int,
    seed: np.uint32,
    width: int,
    flat: int,
    number: int,
    at: int,
    path: Any,
) -> None:
    """Start ``path`` as sample ``number`` of pixel ``flat``, whose radiance goes to row ``at``.

    ``code``: of the ray generation program; ``rule``: CENTRE, JITTER, STRATA or SOBOL;
    ``side``: strata along a side of the pixel.
    """
    pixel, sample = np.uint32(flat), np.uint32(number)
    reset_path(path)
    dx, dy = 0.5, 0.5
    if rule == SOBOL:
        dx, dy = sample_2d(seed, pixel, sample, np.uint32(0))
    elif rule != CENTRE:
        dx = sample_1d(seed, pixel, sample, np.uint32(0))
        dy = sample_1d(seed, pixel, sample, np.uint32(1))
        if rule == STRATA:
            dx = min((number % side + dx) / side, 0.99999994)
            dy = min((number // side % side + dy) / side, 0.99999994)
    row = int(flat / width)  # exact below 2^53, and faster than integer division
    x, y = flat - row * width + dx, row + dy
    o, d = _generate_ray(code, camera, seed, pixel, sample, x, y)
    set_origin(path, o)
    set_heading(path, d)
    path.index = at
    path.pixel = pixel
    path.sample = sample


@kernel
def generate_camera_rays(
    cameras: Any,
    code: int,
    rule: int,
    side: int,
    seed: np.uint32,
    width: int,
    items: Any,
    queue: NDArray[Any],
) -> None:
    """Generate a path for every sample of ``items``; parameters as for ``start_camera_path``."""
    at = 0
    for i in range(items.shape[0]):
        flat, first = int(items[i].pixel), int(items[i].first)
        for k in range(items[i].count):
            start_camera_path(
                cameras[0], code, rule, side, seed, width, flat, first + k, at, queue[at]
            )
            at += 1

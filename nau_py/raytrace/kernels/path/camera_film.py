"""Ray generation from the pass's camera, and the sums over a pixel's samples."""

from __future__ import annotations

from math import isfinite
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raytrace.kernels.core.jit import V3, inner, kernel
from nau_py.raytrace.kernels.core.memory import field_reader
from nau_py.raytrace.kernels.core.sampling import sample_1d, sample_2d, sample_disk
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

CENTRE, JITTER, STRATA, SOBOL = range(4)
"""Where the samples of a pixel lie."""
BATCHES, LEAST = 16, 16
"""Runs of a pixel's samples whose means tell its error: at most so many, of two samples or more;
from LEAST samples on."""
ITEM = np.dtype([("pixel", "i8"), ("first", "i4"), ("count", "i4")], align=True)
"""A pixel to sample: flat index, first sample number, and how many."""


@inner
def camera_ray(camera: Any, x: float, y: float, lx: float, ly: float) -> tuple[V3, V3]:
    """Origin on the near plane and unit direction through image point (x, y), in pixels.

    (lx, ly): a point of the unit disk on the lens; Kolb et al. 1995, the thin lens.
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
def camera_rays(
    cameras: Any,
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    origin: NDArray[np.float32],
    direction: NDArray[np.float32],
) -> None:
    """``camera_ray`` for arrays, through the centre of the lens."""
    for i in range(x.shape[0]):
        o, d = camera_ray(cameras[0], x[i], y[i], 0.0, 0.0)
        for k in range(3):
            origin[i, k] = o[k]
            direction[i, k] = d[k]


@inner
def reset(path: Any) -> None:
    """The state of a fresh path: full weight, in vacuum."""
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
def start(
    camera: Any,
    lens: int,
    rule: int,
    side: int,
    seed: np.uint32,
    width: int,
    flat: int,
    number: int,
    at: int,
    path: Any,
) -> None:
    """Make ``path`` sample ``number`` of the pixel ``flat``, for result ``at``. ``lens``: 1 for the
    thin lens, 0 for a pinhole; ``rule``: where samples lie; ``side``: strata a side."""
    pixel, sample = np.uint32(flat), np.uint32(number)
    reset(path)
    dx, dy = 0.5, 0.5
    if rule == SOBOL:
        dx, dy = sample_2d(seed, pixel, sample, np.uint32(0))
    elif rule != CENTRE:
        dx = sample_1d(seed, pixel, sample, np.uint32(0))
        dy = sample_1d(seed, pixel, sample, np.uint32(1))
        if rule == STRATA:
            dx = min((number % side + dx) / side, 0.99999994)
            dy = min((number // side % side + dy) / side, 0.99999994)
    lx, ly = 0.0, 0.0
    if lens:
        a, b = sample_2d(seed, pixel, sample, np.uint32(2))
        lx, ly = sample_disk(a, b)
    row = int(flat / width)  # exact below 2^53, and faster than integer division
    o, d = camera_ray(camera, flat - row * width + dx, row + dy, lx, ly)
    set_origin(path, o)
    set_heading(path, d)
    path.index = at
    path.pixel = pixel
    path.sample = sample


@kernel
def generate(
    cameras: Any,
    lens: int,
    rule: int,
    side: int,
    seed: np.uint32,
    width: int,
    items: Any,
    queue: NDArray[Any],
) -> None:
    """A path for every sample of ``items``: see ``start``."""
    at = 0
    for i in range(items.shape[0]):
        flat, first = int(items[i].pixel), int(items[i].first)
        for k in range(items[i].count):
            start(cameras[0], lens, rule, side, seed, width, flat, first + k, at, queue[at])
            at += 1


@inner
def _batch_error(
    sums: NDArray[np.float64], sizes: NDArray[np.float64], batched: NDArray[np.float64], i: int
) -> None:
    """Add to pixel ``i`` the squared error of the sum of its batches, mean over RGB."""
    used, total = 0, 0.0
    for b in range(BATCHES):
        if sizes[b] > 0.0:
            used += 1
            total += sizes[b]
    if used < 2:
        return
    squared = 0.0
    for k in range(3):
        mean = 0.0
        for b in range(BATCHES):
            if sizes[b] > 0.0:
                mean += sums[b, k] / sizes[b] / used
        for b in range(BATCHES):
            if sizes[b] > 0.0:
                off = sums[b, k] / sizes[b] - mean
                squared += off * off
    batched[i, 0] += squared / 3.0 / (used - 1) / used * total * total
    batched[i, 1] += total


@kernel
def accumulate(
    radiance: NDArray[np.float32],
    items: Any,
    mean: NDArray[np.float64],
    squares: NDArray[np.float64],
    number: NDArray[np.int64],
    largest: NDArray[np.float64],
    batched: NDArray[np.float64],
    bad: NDArray[np.int64],
) -> None:
    """Add the samples of each pixel to its mean and sum of squared deviations, and keep the
    largest one's share.

    Welford, *Note on a Method for Calculating Corrected Sums of Squares and Products*, 1962.
    ``batched`` (n, 2) gets the squared error of the sum over these samples, from the means of
    BATCHES runs of them, and how many samples that holds for (batch means, Schmeiser 1982): each
    run of a low-discrepancy sequence is stratified, which single samples do not show.
    With empty ``squares`` only means are kept. Samples that are not finite are dropped: ``bad``
    holds how many, and the first one's pixel.
    """
    at = 0
    many = squares.shape[0] > 0
    sums = np.zeros((BATCHES, 3))
    sizes = np.zeros(BATCHES)
    for i in range(items.shape[0]):
        count = items[i].count
        batches = min(BATCHES, count // 2) if count >= LEAST else 0
        sums[:], sizes[:] = 0.0, 0.0
        for which in range(count):
            c = radiance[at]
            at += 1
            if not (isfinite(c[0]) and isfinite(c[1]) and isfinite(c[2]) and isfinite(c[3])):
                if bad[0] == 0:
                    bad[1] = items[i].pixel
                bad[0] += 1
                continue
            number[i] += 1
            square = 0.0
            for k in range(4):
                delta = float(c[k]) - mean[i, k]
                mean[i, k] += delta / number[i]
                if many and k < 3:
                    added = delta * (float(c[k]) - mean[i, k])
                    squares[i, k] += added
                    square += added
            if many:
                largest[i] = max(largest[i], square)
                if batches > 0:
                    batch = which * batches // count
                    sizes[batch] += 1.0
                    for k in range(3):
                        sums[batch, k] += float(c[k])
        if many and batches > 0:
            _batch_error(sums, sizes, batched, i)

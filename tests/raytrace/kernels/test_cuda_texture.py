"""Textures as CUDA reads them (*CUDA C++ Programming Guide*, "Texture Fetching"), against NumPy."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
import pytest

from nau_py.raytrace.kernels.geometry.cuda_texture import Image, sampler_address

Array = np.ndarray[Any, Any]


def fetch(image: Image, dimensions: int, points: Array) -> Array:
    """Sample a texture at points (n, 3). Returns RGBA float32 (n, 4)."""
    kinds = [ctypes.c_uint64, ctypes.c_int32, *[ctypes.c_float] * 3, ctypes.c_uint64]
    ask = ctypes.CFUNCTYPE(None, *kinds)(sampler_address())
    out = np.zeros((len(points), 4), np.float32)
    for row, (x, y, z) in zip(out, points.tolist()):
        ask(image.handle, dimensions, x, y, z, row.ctypes.data)
    return out


def between(texels: Array, points: Array, exact: bool = False) -> Array:
    """Trilinear with repetition, float64, weights of 8 bits or exact: rows of (depth, height,
    width, c)."""
    sizes = np.array(texels.shape[2::-1])
    place = points.astype(np.float32).astype(np.float64) * sizes - 0.5
    low = np.floor(place)
    weight = place - low
    if not exact:
        weight = np.floor(weight * 256 + 0.5) / 256
    total = np.zeros((len(points), texels.shape[3]))
    for corner in range(8):
        step = np.array([corner & 1, corner >> 1 & 1, corner >> 2])
        at = ((low + step) % sizes).astype(int)
        share = np.where(step, weight, 1 - weight).prod(axis=1)
        total += share[:, None] * texels[at[:, 2], at[:, 1], at[:, 0]] / 255.0
    return total


@pytest.mark.parametrize("exact", [False, True])
def test_volumes_of_bytes_are_read_between_texels(exact: bool) -> None:
    chance = np.random.default_rng(3)
    texels = chance.integers(0, 256, (3, 4, 5, 2), dtype=np.uint8)
    points = chance.uniform(-1.5, 2.5, (500, 3)).astype(np.float32)
    found = fetch(Image(texels, exact=exact), 3, points)
    np.testing.assert_allclose(found[:, :2], between(texels, points, exact), atol=1e-6)
    assert (found[:, 2:] == 0).all()


def test_pictures_of_bytes_are_read_between_texels() -> None:
    chance = np.random.default_rng(4)
    texels = chance.integers(0, 256, (4, 6, 4), dtype=np.uint8)
    points = chance.uniform(-1.5, 2.5, (500, 3)).astype(np.float32)
    flat = points * [1, 1, 0] + [0, 0, 0.5]
    np.testing.assert_allclose(
        fetch(Image(texels), 2, points), between(texels[None], flat), atol=1e-6
    )


def test_clamped_coordinates_repeat_the_last_texel() -> None:
    """By axis: the first one clamped, the second one repeated."""
    texels = np.arange(12, dtype=np.float32).reshape(3, 4, 1)
    image = Image(texels, linear=False, clamp=(True, False))
    x, y = np.meshgrid([-3.0, -0.1, 0.1, 0.9, 1.1, 7.0], [-0.9, 0.5, 1.5])
    points = np.stack([x.ravel(), y.ravel(), np.zeros(18)], axis=-1)
    column = np.clip(np.floor(points[:, 0] * 4), 0, 3).astype(int)
    row = (np.floor(points[:, 1] * 3) % 3).astype(int)
    np.testing.assert_array_equal(fetch(image, 2, points)[:, 0], texels[row, column, 0])


def test_coordinates_that_count_texels() -> None:
    texels = np.arange(24, dtype=np.float32).reshape(4, 6, 1)
    y, x = np.mgrid[0:4, 0:6].reshape(2, -1)
    points = np.stack([x, y, np.zeros(24)], axis=-1).astype(float)
    image = Image(texels, False, (True, True), True)
    np.testing.assert_array_equal(fetch(image, 2, points)[:, 0], texels.ravel())


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e30])
def test_coordinates_that_are_not_finite_give_zero(value: float) -> None:
    image = Image(np.full((2, 2, 4), 255, np.uint8))
    assert (fetch(image, 2, np.array([[0.5, value, 0.0]])) == 0).all()
    assert (fetch(image, 3, np.array([[0.5, 0.5, 0.0]])) == 0).all()  # it is no volume

"""Targets as pictures: what is painted where."""

from __future__ import annotations

import io

import numpy as np
from PIL import Image

from nau_py.reporting.pixels import encode_png, tint
from nau_py.reporting.target_picture import display_difference, display_target, encode_thumbnail


def test_what_is_not_finite_is_painted() -> None:
    values = np.zeros((1, 4, 4), np.float32)
    values[0, 1, 0], values[0, 2, 1], values[0, 3, 2] = np.nan, np.inf, -np.inf
    pixels = display_target(values)[0].tolist()
    assert pixels == [[0, 0, 0], [255, 0, 255], [0, 255, 255], [0, 255, 255]]


def test_channels_and_exposure() -> None:
    values = np.array([[[0.1, 0.2, 0.4, 0.8]]], np.float32)
    assert display_target(values)[0, 0].tolist() == [26, 51, 102]
    assert display_target(values, "a")[0, 0].tolist() == [204] * 3
    assert display_target(values, "rgb", 1.0)[0, 0].tolist() == [51, 102, 204]
    assert display_target(values, "rgb", 30.0)[0, 0].tolist() == [255] * 3
    assert display_target(values[:, :, :2])[0, 0].tolist() == [26, 51, 0]
    assert display_target(values[:, :, :1])[0, 0].tolist() == [26] * 3
    assert display_target(np.array([[[255, 0, 51, 9]]], np.uint8))[0, 0].tolist() == [255, 0, 51]


def test_depth_is_stretched_and_near_is_bright() -> None:
    depth = np.array([[[0.9], [0.95], [1.0]]], np.float32)
    assert display_target(depth, depth=True)[0, :, 0].tolist() == [255, 0, 0]


def test_mask_thumbnail_difference() -> None:
    pixels = np.full((2, 4, 3), 100, np.uint8)
    mask = np.zeros((2, 4), bool)
    mask[0, 0] = True
    tinted = tint(pixels, mask.astype(float))
    assert tinted[0, :2].tolist() == [[193, 55, 132], [100, 100, 100]]
    assert (tint(pixels, np.ones((1, 1)))[..., 0] == 193).all()  # weights of another size
    small = Image.open(io.BytesIO(encode_thumbnail(pixels, 2)))
    assert small.size == (2, 1)
    assert Image.open(io.BytesIO(encode_png(pixels))).size == (4, 2)
    one, other = np.full((1, 1, 3), 0.5), np.full((1, 1, 3), 0.46)
    assert display_difference(one, other)[0, 0].tolist() == [102] * 3

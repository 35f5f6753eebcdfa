"""Targets as pictures: what is painted where."""

from __future__ import annotations

import io

import numpy as np
from PIL import Image

from nau_py.reporting.target_picture import difference, encoded, shown, thumbnail, tinted


def test_what_is_not_finite_is_painted() -> None:
    values = np.zeros((1, 4, 4), np.float32)
    values[0, 1, 0], values[0, 2, 1], values[0, 3, 2] = np.nan, np.inf, -np.inf
    pixels = shown(values)[0].tolist()
    assert pixels == [[0, 0, 0], [255, 0, 255], [0, 255, 255], [0, 255, 255]]


def test_channels_and_exposure() -> None:
    values = np.array([[[0.1, 0.2, 0.4, 0.8]]], np.float32)
    assert shown(values)[0, 0].tolist() == [26, 51, 102]
    assert shown(values, "a")[0, 0].tolist() == [204] * 3
    assert shown(values, "rgb", 1.0)[0, 0].tolist() == [51, 102, 204]
    assert shown(values, "rgb", 30.0)[0, 0].tolist() == [255] * 3
    assert shown(values[:, :, :2])[0, 0].tolist() == [26, 51, 0]
    assert shown(values[:, :, :1])[0, 0].tolist() == [26] * 3
    assert shown(np.array([[[255, 0, 51, 9]]], np.uint8))[0, 0].tolist() == [255, 0, 51]


def test_depth_is_stretched_and_near_is_bright() -> None:
    depth = np.array([[[0.9], [0.95], [1.0]]], np.float32)
    assert shown(depth, depth=True)[0, :, 0].tolist() == [255, 0, 0]


def test_mask_thumbnail_difference() -> None:
    pixels = np.full((2, 4, 3), 100, np.uint8)
    mask = np.zeros((2, 4), bool)
    mask[0, 0] = True
    assert tinted(pixels, mask)[0, :2].tolist() == [[178, 82, 50], [100, 100, 100]]
    assert (tinted(pixels, np.ones((1, 1), bool)) == pixels).all()  # of another size: left alone
    small = Image.open(io.BytesIO(thumbnail(pixels, 2)))
    assert small.size == (2, 1)
    assert Image.open(io.BytesIO(encoded(pixels))).size == (4, 2)
    one, other = np.full((1, 1, 3), 0.5), np.full((1, 1, 3), 0.46)
    assert difference(one, other)[0, 0].tolist() == [102] * 3

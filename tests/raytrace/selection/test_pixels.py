"""Masks to pixels and samples (``selection/mask.py``, ``pixels.py``, ``samples.py``)."""

from __future__ import annotations

import numpy as np
import pytest

from nau_py.model.raytrace import InputBuffer, RaytracePass
from nau_py.raytrace.selection.mask import force_mask, read_mask
from nau_py.raytrace.selection.pixels import select_pixels
from nau_py.raytrace.selection.samples import distribute_samples


def masked(component: str | None = None) -> RaytracePass:
    """A pass whose mask is texture ``L::weight``."""
    return RaytracePass(rtInput=[InputBuffer(var="mask", texture="L::weight", mask=component)])


def test_a_pixel_with_any_weight_is_traced() -> None:
    mask = np.array([[0.0, 0.25, -1.0], [1.0, 0.0, 1e-9]])
    assert select_pixels(mask, 3, 2).tolist() == [1, 3, 5]
    assert select_pixels(None, 3, 2).tolist() == [0, 1, 2, 3, 4, 5]


def test_weights_become_samples() -> None:
    mask = np.array([[0.0, 0.01, 0.5], [1.0, 2.0, 0.3]])
    pixels = select_pixels(mask, 3, 2)
    samples = distribute_samples(mask, pixels, 10, "spp")
    assert samples is not None
    assert samples.tolist() == [1, 5, 10, 10, 3]
    assert distribute_samples(mask, pixels, 10, None) is None
    assert distribute_samples(None, pixels, 10, "spp") is None


@pytest.mark.parametrize("name, channel", [("x", 0), ("y", 1), (None, 3)])
def test_the_mask_is_one_channel_of_its_texture(name: str | None, channel: int) -> None:
    values = np.arange(24, dtype=np.float32).reshape(2, 3, 4)
    found = read_mask(masked(name), {"L::weight": values})
    assert found is not None
    np.testing.assert_array_equal(found, values[..., channel])
    forced = force_mask(masked(name), values, 0.5)
    np.testing.assert_array_equal(forced[..., channel], 0.5)
    others = [k for k in range(4) if k != channel]
    np.testing.assert_array_equal(forced[..., others], values[..., others])


def test_bytes_are_read_as_weights_from_0_to_1() -> None:
    found = read_mask(masked(), {"L::weight": np.array([[[0, 51]]], np.uint8)})
    assert found is not None
    assert found.tolist() == [[0.2]]


def test_passes_without_a_mask_have_none() -> None:
    assert read_mask(RaytracePass(), {"L::weight": np.ones((1, 1, 4))}) is None
    assert read_mask(masked(), {}) is None

"""Random numbers, spawn points and texture look-ups against outside answers."""

from __future__ import annotations

import numpy as np
import pytest

from nau_py.raytrace.kernels.core.sampling import pcg4d
from nau_py.raytrace.kernels.core.tables import PATH
from nau_py.raytrace.kernels.path.camera import CAMERA, ITEM, SOBOL, STRATA, generate_camera_rays
from nau_py.raytrace.tracing.random import sample_uniform
from nau_py.raytrace.tracing.ray_texture import RayTexture
from tests.conftest import Folder


def test_pcg4d_against_its_definition_in_python_integers() -> None:
    """Jarzynski and Olano 2020, listing of pcg4d, in unbounded integers modulo 2^32."""

    def reference(v: list[int]) -> int:
        m = 2**32
        v = [(k * 1664525 + 1013904223) % m for k in v]
        for step in range(2):
            v[0] = (v[0] + v[1] * v[3]) % m
            v[1] = (v[1] + v[2] * v[0]) % m
            v[2] = (v[2] + v[0] * v[1]) % m
            v[3] = (v[3] + v[1] * v[2]) % m
            if step == 0:
                v = [k ^ (k >> 16) for k in v]
        return v[0]

    keys = np.random.default_rng(3).integers(0, 2**32, (50, 4), dtype=np.uint32)
    with np.errstate(over="ignore"):
        found = [pcg4d.py_func(*row) for row in keys]  # type: ignore[attr-defined]
    assert found == [reference([int(k) for k in row]) for row in keys]
    # compiled, it is what random numbers are made of
    pixel, sample = keys[:, 0].copy(), keys[:, 1].copy()
    numbers = sample_uniform(7, pixel, sample, 3)
    expected = [(reference([int(p), int(s), 3, 7]) >> 8) / 2**24 for p, s in zip(pixel, sample)]
    np.testing.assert_array_equal(numbers, np.float32(expected))


def test_numbers_are_uniform_and_keyed() -> None:
    pixel = np.arange(200_000, dtype=np.uint32)
    sample = np.zeros_like(pixel)
    values = sample_uniform(0, pixel, sample, 0)
    counts, _ = np.histogram(values, 64, (0, 1))
    chi2 = ((counts - counts.mean()) ** 2 / counts.mean()).sum()
    assert chi2 < 120  # 63 degrees of freedom: p < 1e-5 beyond
    for other in (
        sample_uniform(1, pixel, sample, 0),
        sample_uniform(0, pixel, sample + np.uint32(1), 0),
        sample_uniform(0, pixel, sample, 1),
    ):
        assert abs(np.corrcoef(values, other)[0, 1]) < 0.01
    np.testing.assert_array_equal(
        sample_uniform(0, pixel[500:600], sample[500:600], 0), values[500:600]
    )


def sample_points(rule: int, count: int, pixel: int = 123) -> np.ndarray:  # type: ignore[type-arg]
    """Return the positions of the samples inside a pixel, float64 (count, 2)."""
    camera = np.zeros(1, CAMERA)  # orthographic, one world unit a pixel
    camera["forward"], camera["right"], camera["up"] = (0, 0, -1), (1, 0, 0), (0, 1, 0)
    camera["step"] = (1, 1)
    camera["ortho"] = 1
    items = np.zeros(1, ITEM)
    items["pixel"], items["count"] = pixel, count
    queue = np.zeros(count, PATH)
    generate_camera_rays(camera, 0, rule, round(count**0.5), np.uint32(7), 1000, items, queue)
    return np.asarray(queue["origin"][:, :2].astype(float) - [pixel, 0])


@pytest.mark.parametrize("count", [4, 16, 64])
def test_each_stratum_gets_one_sample(count: int) -> None:
    side = round(count**0.5)
    cells = {tuple(c) for c in (sample_points(STRATA, count) * side).astype(int).tolist()}
    assert len(cells) == count


@pytest.mark.parametrize("count", [4, 16, 64, 256])
def test_sobol_points_fill_every_elementary_interval(count: int) -> None:
    """A (0, 2)-sequence: of its first 2^m points, one lies in each box of 2^-k by 2^-(m-k)."""
    points = sample_points(SOBOL, count)
    m = count.bit_length() - 1
    for k in range(m + 1):
        boxes = {tuple(b) for b in (points * [2**k, 2 ** (m - k)]).astype(int).tolist()}
        assert len(boxes) == count


@pytest.mark.parametrize("wrap", ["REPEAT", "CLAMP_TO_EDGE", "MIRRORED_REPEAT", "CLAMP_TO_BORDER"])
@pytest.mark.parametrize("nearest", [True, False])
def test_textures_agree_with_opengl(folder: Folder, wrap: str, nearest: bool) -> None:
    """The same image, coordinates and sampler through the driver's own texture unit."""
    from nau_py.raster.device import get_device
    from nau_py.raster.gl import GL
    from nau_py.raster.samplers import Samplers
    from nau_py.raster.textures import make_image_texture

    rng = np.random.default_rng(5)
    texels = rng.integers(0, 256, (5, 7, 4), dtype=np.uint8)
    uv = rng.uniform(-2, 3, (64 * 64, 2)).astype(np.float32)
    ctx = get_device().ctx
    program = ctx.compute_shader("""#version 430
        layout(local_size_x = 64) in;
        layout(std430, binding = 0) buffer In { vec2 uv[]; };
        layout(std430, binding = 1) buffer Out { vec4 rgba[]; };
        uniform sampler2D t;
        void main() { uint i = gl_GlobalInvocationID.x; rgba[i] = textureLod(t, uv[i], 0.0); }
    """)
    texture = make_image_texture(texels, mipmap=False)
    filter_ = ("NEAREST",) if nearest else ("LINEAR",)
    border = (0.25, 0.5, 0.75, 1.0)
    sampler = Samplers().get(
        (
            ("WRAP_S", (wrap,)),
            ("WRAP_T", (wrap,)),
            ("MAG_FILTER", filter_),
            ("MIN_FILTER", filter_),
            ("BORDER_COLOR", border),
        ),
        False,
    )
    GL.glBindTextureUnit(0, texture.glo)
    GL.glBindSampler(0, sampler)
    out = ctx.buffer(reserve=len(uv) * 16)
    coordinates = ctx.buffer(uv.tobytes())
    coordinates.bind_to_storage_buffer(0)
    out.bind_to_storage_buffer(1)
    program.run(len(uv) // 64)
    ctx.memory_barrier()
    expected = np.frombuffer(out.read(), np.float32).reshape(-1, 4)
    GL.glBindSampler(0, 0)
    GL.glBindTextureUnit(0, 0)
    found = RayTexture(texels, wrap, wrap, nearest, border).sample(uv)
    difference = np.abs(found - expected).max(axis=1)
    # the driver weighs texels with 8 bits; nearest may differ where a coordinate meets an edge
    limit = 1.5 / 256 * 2 if not nearest else 1e-6
    assert (difference > limit).mean() < 1e-3

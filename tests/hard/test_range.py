"""Hard cases 30 to 36 and the hybrid seams: ranges, sums, determinism."""

from __future__ import annotations

import numpy as np
import pytest

import nau_py
from nau_py.raytrace.kernels.path.camera import ITEM
from nau_py.raytrace.kernels.path.film import update_film
from nau_py.raytrace.tracing.estimate import PixelEstimates
from tests.conftest import PROJECTS, ROOT, Folder
from tests.raytrace.studio import colour, picture, program, square, studio

TURN = '<ROTATE x="1" y="0" z="0" w="90" />'


@pytest.mark.parametrize("value", [7e4, 1e6])
def test_fp16_overflow(folder: Folder, value: float) -> None:
    """Radiance beyond half precision saturates; it is never infinite."""
    studio(
        folder,
        square("wall", "Wall", [9, 1, 9], [0, 0, 0], TURN),
        {"Wall": colour("EMISSION", value, value, value, 1.0)},
        size=(4, 4),
    )
    library = (folder.path / "lib.mlib").read_text()
    folder.write("lib.mlib", library.replace("RGBA32F", "RGBA16F"))
    found = picture(folder.load())
    assert found[..., 0].tolist() == np.full((4, 4), 65504.0).tolist()


def test_tonemap_inf_nan() -> None:
    """``develop``: infinity is white, NaN magenta, below 0 black, 0 and 1 themselves."""
    from nau_py.raster.device import get_device

    ctx = get_device().ctx
    values = np.array(
        [[np.inf] * 3, [np.nan, 1, 1], [-1e30] * 3, [-0.0] * 3, [0.5] * 3, [1e30] * 3], np.float32
    )
    texture = ctx.texture((6, 1), 3, values.tobytes(), dtype="f4")
    target = ctx.framebuffer([ctx.texture((6, 1), 4)])
    program_ = ctx.program(
        vertex_shader="#version 330\nvoid main() { vec2 p = vec2(gl_VertexID % 2, gl_VertexID / 2);"
        " gl_Position = vec4(p * 4.0 - 1.0, 0.0, 1.0); }",
        fragment_shader=(ROOT / "materials" / "shaders" / "develop.frag").read_text(),
    )
    target.use()
    texture.use(0)
    ctx.vertex_array(program_, []).render(vertices=3)
    found = np.frombuffer(target.read(components=3), np.uint8).reshape(6, 3)
    grey = round((1.055 * 0.5 ** (1 / 2.4) - 0.055) * 255)
    expected = [[255] * 3, [255, 0, 255], [0] * 3, [0] * 3, [grey] * 3, [255] * 3]
    assert found.tolist() == expected


def sums(values: np.ndarray) -> PixelEstimates:  # type: ignore[type-arg]
    """The estimate of one pixel from grey samples."""
    estimate = PixelEstimates.empty(1)
    items = np.zeros(1, ITEM)
    items["count"] = len(values)
    radiance = np.ascontiguousarray(np.repeat(values[:, None], 4, axis=1), np.float32)
    bad = np.zeros(2, np.int64)
    update_film(
        radiance,
        items,
        estimate.mean,
        estimate.squares,
        estimate.number,
        estimate.largest,
        estimate.batched,
        bad,
    )
    return estimate


def test_sum_1e6() -> None:
    """A million samples of 0.1: the mean to 1e-6."""
    found = sums(np.full(1_000_000, 0.1))
    assert found.mean[0, 0] == pytest.approx(float(np.float32(0.1)), rel=1e-6)
    assert found.squares.max() == pytest.approx(0.0, abs=1e-9)


def test_variance_firefly() -> None:
    """One sample of 1e6 among a million: mean and variance as in float64, and flagged."""
    values = np.random.default_rng(2).random(1_000_000).astype(np.float32)
    values[123_456] = 1e6
    found = sums(values)
    wide = values.astype(np.float64)
    assert found.mean[0, 0] == pytest.approx(wide.mean(), rel=1e-9)
    assert found.squares[0, 0] == pytest.approx(((wide - wide.mean()) ** 2).sum(), rel=1e-9)
    assert found.unreliable.tolist() == [True]
    assert sums(values[:1000]).unreliable.tolist() == [False]


def test_error_of_batches() -> None:
    """The error of a mean of 64, by batches of four where those are better than single samples:
    (x, 1 - x, y, 1 - y) always has the mean 1/2, so no error is left; sorted samples are clumps, and
    count one by one."""
    random = np.random.default_rng(4).random(32)
    balanced = np.stack([random, 1 - random], axis=1).reshape(-1)
    assert sums(balanced).error[0] < 1e-7
    assert sums(balanced[:64]).error[0] < 1e-7
    clumps = np.sort(np.random.default_rng(5).random(64))
    expected = clumps.std(ddof=1) / 8
    assert sums(clumps).error[0] == pytest.approx(expected, rel=1e-5)
    few = clumps[:15]
    assert sums(few).error[0] == pytest.approx(few.std(ddof=1) / np.sqrt(15), rel=1e-5)


def test_merged_sums() -> None:
    """In two parts, the same as in one."""
    values = np.random.default_rng(3).random(5000)
    whole = sums(values)
    estimate = PixelEstimates.empty(1)
    items = np.zeros(1, ITEM)
    for part in (values[:1234], values[1234:]):
        items["count"] = len(part)
        radiance = np.ascontiguousarray(np.repeat(part[:, None], 4, axis=1), np.float32)
        update_film(
            radiance,
            items,
            estimate.mean,
            estimate.squares,
            estimate.number,
            estimate.largest,
            estimate.batched,
            np.zeros(2, np.int64),
        )
    np.testing.assert_array_equal(estimate.mean, whole.mean)
    np.testing.assert_array_equal(estimate.squares, whole.squares)


def test_nan_sample(folder: Folder) -> None:
    """One NaN sample of four: it is dropped and counted, the mean is of the other three."""
    folder.write(
        "prog.py",
        "import numpy as np\n\n\ndef shade(hits):\n    value = np.ones((len(hits), 3))\n"
        "    value[(hits.rays.pixel == 5) & (hits.rays.sample == 2)] = np.nan\n    return value\n",
    )
    studio(folder, square("w", "W", [9, 1, 9], [0, 0, 0], TURN), {}, size=(8, 8), spp=4)
    text = (folder.path / "project.xml").read_text()
    folder.write(
        "project.xml", text.replace('file="builtin" proc="emission"', 'file="prog.py" proc="shade"')
    )
    frame = nau_py.Renderer(folder.load()).render()
    np.testing.assert_array_equal(frame.targets["L::out"][..., :3], 1.0)
    assert frame.report["nonfinite"] == 1


def test_denormals(folder: Folder) -> None:
    """Light of 1e-38 through a mirror of 1e-2, and distances of 1e-30: finite, off by nothing that
    single precision shows."""
    project = studio(
        folder,
        square("mirror", "Mirror", [9, 1, 9], [0, -1, 0])
        + square("sky", "Sky", [99, 1, 99], [0, 9, 0]),
        {
            "Mirror": colour("SPECULAR", 0.01, 0.01, 0.01, 1.0),
            "Sky": colour("EMISSION", 1e-38, 1e-30, 1.0, 1.0),
        },
        program("Mirror", "mirror"),
        camera='<POSITION x="0" y="0" z="0" /><VIEW x="0" y="-1" z="0" /><UP x="0" y="0" z="1" />',
        size=(8, 8),
    )
    found = picture(project)
    np.testing.assert_allclose(found[..., 2], 0.01, rtol=1e-6)
    np.testing.assert_allclose(found[..., 0], 1e-40, atol=1e-6)
    np.testing.assert_allclose(found[..., 1], 1e-32, atol=1e-6)


def test_determinism() -> None:
    """Tiles of 8, 64, 777 and the whole picture, on 1, 2 and 4 threads: the same bits."""
    pictures = []
    for threads, tile in ((1, 1 << 24), (1, 8), (2, 64), (4, 777)):
        project = nau_py.load(PROJECTS / "selective" / "project.xml")
        options = nau_py.RunOptions(threads=threads, tile=tile, samples=4)
        frame = nau_py.Renderer(project, size=(48, 48), options=options).render()
        pictures.append(frame.targets["Hybrid::radiance"].tobytes())
    assert len(set(pictures)) == 1


def test_mask_seam(half: nau_py.Frame) -> None:
    """Across the line between rasterised and traced pixels, neighbours differ no more than two
    rows further up, on either side of no border at all."""
    image = half.image[..., :3].astype(float)
    rows = image.shape[0] // 2
    across = np.abs(image[rows] - image[rows - 1]).mean()
    before = np.abs(image[rows - 2] - image[rows - 3]).mean()
    after = np.abs(image[rows + 2] - image[rows + 1]).mean()
    assert across < 1.5 * max(before, after) + 2


GBUFFER = """\
import numpy as np


def camera(launch):
    position = launch.input("position")[:, :3]
    eye = np.array([0.0, 2.6, 3.0], np.float32)
    seen = position - eye
    distance = np.sqrt((seen ** 2).sum(axis=1))[:, None]
    # back along the ray by a bound of float32's rounding at that distance
    origin = position - seen / distance * (16 * np.float32(2.0 ** -23) * (distance + 4))
    sun = np.broadcast_to(np.array([-0.5, 1.0, -0.25], np.float32) / 1.1456439, origin.shape)
    return launch.trace("Shadow", origin, np.ascontiguousarray(sun), kind="shadow")
"""


def draw_positions(folder: Folder, old: str, new: str) -> None:
    """Give the studio project a pass before its own that draws positions into ``L::where``, which
    programs read as ``position``; and write ``new`` for ``old``."""
    text = (folder.path / "project.xml").read_text().replace(old, new)
    text = text.replace(
        '<pass name="trace"',
        '<pass name="choose" class="mask"><camera name="C" /><scenes><scene name="S" /></scenes>'
        '<renderTarget name="seen" fromLibrary="L" /></pass><pass name="trace"',
    ).replace(
        "<rtEntryPoint>",
        '<rtInput><buffer var="position" texture="L::where" /></rtInput><rtEntryPoint>',
    )
    folder.write("project.xml", text)
    library = (folder.path / "lib.mlib").read_text()
    size = library[library.index("<SIZE") : library.index("/>", library.index("<SIZE")) + 2]
    folder.write(
        "lib.mlib",
        library.replace(
            "<renderTargets>",
            f'<renderTargets><renderTarget name="seen">{size}<colors>'
            '<color name="where" internalFormat="RGBA32F" /></colors></renderTarget>',
        ),
    )


def test_gbuffer_origin(folder: Folder) -> None:
    """Shadow rays from positions that the rasteriser stored in float32: no acne."""
    folder.write("prog.py", GBUFFER)
    studio(
        folder,
        square("floor", "Floor", [3, 1, 3], [0, 0, 0]),
        {},
        camera='<POSITION x="0" y="2.6" z="3" /><LOOK_AT_POINT x="0" y="0" z="0" />',
        size=(64, 64),
    )
    draw_positions(
        folder,
        '<rayGen file="builtin" proc="pinhole" />',
        '<rayGen file="prog.py" proc="camera" />',
    )
    frame = nau_py.Renderer(folder.load()).render()
    on_floor = np.abs(frame.targets["L::where"][..., :3]).sum(axis=-1) > 0
    assert on_floor.sum() > 1500
    assert (frame.targets["L::out"][on_floor][:, 0] == 1).all()


def test_history_resize(folder: Folder) -> None:
    """Accumulated samples are dropped when an object moves: the picture has no stale sample.

    A renderer's window keeps its size.
    """
    scene = square("wall", "Wall", [0.7, 1, 0.7], [0, 0, 0], TURN)
    material = {"Wall": colour("EMISSION", 0.25, 0.5, 1.0, 1.0)}
    settings = '<ACCUMULATE value="true" />'
    studio(folder, scene, material, settings=settings, size=(16, 16), spp=4)
    text = (folder.path / "project.xml").read_text()
    folder.write("project.xml", text.replace('<scene name="S">', '<scene name="S" type="Scene">'))
    project = folder.load()
    place = np.array([[0.7, 0, 0, 0.9], [0, 0, -0.7, 0], [0, 1, 0, 0], [0, 0, 0, 1]], float)
    renderer, fresh = nau_py.Renderer(project), nau_py.Renderer(project)
    before = renderer.render(2).targets["L::out"]
    renderer.move("wall", place)
    fresh.move("wall", place)
    found = renderer.render(3).targets["L::out"]
    np.testing.assert_array_equal(found, fresh.render(0).targets["L::out"])
    assert (found != before).any()


def test_pixel_centre(folder: Folder) -> None:
    """The ray through a pixel meets the point at which the rasteriser sampled it: a tilted wall
    whose positions change in both directions, row 0 at the bottom in both."""
    folder.write("prog.py", "def where(hits):\n    return hits.position\n")
    studio(
        folder,
        square("wall", "W", [9, 1, 9], [0, 0, -1], '<ROTATE x="1" y="0.3" z="0.2" w="70" />'),
        {},
        camera='<POSITION x="0.3" y="0.2" z="3" />',
        size=(48, 40),
    )
    draw_positions(folder, 'file="builtin" proc="emission"', 'file="prog.py" proc="where"')
    frame = nau_py.Renderer(folder.load()).render()
    raster, traced = frame.targets["L::where"][..., :3], frame.targets["L::out"][..., :3]
    both = (np.abs(raster).sum(axis=-1) > 0) & (np.abs(traced).sum(axis=-1) > 0)
    assert both.mean() > 0.5
    # the driver interpolates with the 8 bits that it places vertices by
    np.testing.assert_allclose(traced[both], raster[both], atol=2e-3)
    spacing = np.abs(np.diff(raster[:, :, 0], axis=1))[both[:, 1:] & both[:, :-1]].mean()
    assert np.abs(traced - raster)[both].max() < 0.1 * spacing

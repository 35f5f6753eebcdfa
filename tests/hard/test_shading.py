"""Hard cases 19 to 29: normals, shading, materials and alpha at their limits."""

from __future__ import annotations

import numpy as np
import pytest

import nau_py
from nau_py.raytrace.kernels.shading.bsdf import evaluate_fresnel
from tests.conftest import Folder, pixel_rays
from tests.raytrace.studio import box, colour, picture, program, sphere, square, studio

TURN = '<ROTATE x="1" y="0" z="0" w="90" />'
WHITE = {"White": colour("DIFFUSE", 1.0, 1.0, 1.0, 1.0)}


@pytest.mark.parametrize("size", [(0, 16), (16, 0)])
def test_zero_viewport(folder: Folder, size: tuple[int, int]) -> None:
    """A window without pixels: a diagnostic that says so, no GL error, and back again."""
    project = studio(folder, square("a", "White", [9, 1, 9], [0, -1, 0]), WHITE)
    with pytest.raises(nau_py.NauError, match=f"the window is {size[0]} x {size[1]}"):
        nau_py.Renderer(project, size=size).render()
    again = nau_py.Renderer(project, size=(16, 16)).render()
    assert again.targets["L::out"].shape == (32, 32, 4)


def test_shading_vs_geometric(folder: Folder) -> None:
    """The terminator of a coarse smooth ball: brightness falls without polygon steps, and nothing
    shines through a wall whose normals lie."""
    project = studio(
        folder,
        sphere("ball", "White", 1.0, [0, 0, 0], 16),
        WHITE,
        program("White", "direct"),
        lights='<light name="L"><DIRECTION x="-1" y="0" z="0" /></light>',
        camera='<POSITION x="0" y="0" z="5" />',
        size=(256, 16),
        fov=2,
    )
    # one row across the middle of the ball: x from -0.9 to 0.9
    row = picture(project)[8, :, 0]
    lit = row[row > 0]
    assert (np.diff(lit) > -0.02).all()  # rises to the lit side, monotone but for interpolation
    x = (np.arange(256) + 0.5) / 256 * 2.8 - 1.4
    inner = np.abs(x) < 0.85
    assert np.abs(np.diff(row[inner])).max() < 0.06  # a polygon's edge would be a jump of 0.2
    assert row[inner].max() > 0.7
    assert row.max() <= 1.0 + 1e-6
    folder.mtl("wall", {"Wall": {"Kd": "1 1 1"}})
    folder.write(
        "wall.obj",
        "mtllib wall.mtl\nusemtl Wall\nv -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\n"
        "vn 0.99 0 0.1\nf 1//1 2//1 3//1\nf 1//1 3//1 4//1\n",
    )
    project = studio(
        folder,
        '<file name="wall.obj" />',
        {},
        program("Wall", "direct"),
        lights='<light name="L"><DIRECTION x="-1" y="0" z="0.5" /></light>',  # from behind
        size=(16, 16),
    )
    assert picture(project)[..., 0].max() == 0


def test_zero_normal(folder: Folder) -> None:
    """Vertex normals of length 0, or that cancel: the face normal is used."""
    folder.mtl("m", {"Wall": {"Kd": "1 1 1"}})
    folder.write(
        "m.obj",
        "mtllib m.mtl\nusemtl Wall\nv -9 -9 0\nv 9 -9 0\nv 0 9 0\nvn 0 0 0\nf 1//1 2//1 3//1\n",
    )
    project = studio(
        folder,
        '<file name="m.obj" />',
        {},
        program("Wall", "direct"),
        lights='<light name="L"><DIRECTION x="0" y="0" z="-1" /></light>',
        size=(8, 8),
        fov=20,
    )
    np.testing.assert_allclose(picture(project)[..., 0], 1.0)


def test_flipped_winding(folder: Folder) -> None:
    """Seen from either side the same radiance; ``one_sided`` lets back faces be, as culling does."""
    for position, front in (("2", True), ("-2", False)):
        found = []
        for any_hit in ("", "one_sided"):
            project = studio(
                folder,
                square("card", "White", [9, 1, 9], [0, 0, 0], TURN),
                WHITE,
                program("White", "direct", any_hit),
                lights=f'<light name="L"><DIRECTION x="0" y="0" z="{-float(position)}" /></light>',
                camera=f'<POSITION x="0" y="0" z="{position}" />'
                f'<VIEW x="0" y="0" z="{-float(position)}" />',
                size=(8, 8),
            )
            found.append(picture(project)[..., 0])
        np.testing.assert_allclose(found[0], 1.0, rtol=1e-6)
        np.testing.assert_allclose(found[1], 1.0 if front else 0.0, rtol=1e-6)


def test_tir_critical() -> None:
    """At the critical angle of glass: 1 from there on, near 1 just before, nothing below 0."""
    eta = 1 / 1.5
    critical = np.sqrt(1 - eta**2)
    for cosine in (
        critical,
        np.nextafter(critical, 0),
        np.nextafter(critical, 1),
        critical - 1e-12,
        critical + 1e-12,
    ):
        share, behind = evaluate_fresnel.py_func(float(cosine), eta)  # type: ignore[attr-defined]
        assert 0 <= share <= 1
        assert behind >= 0
        assert share > 1 - 1e-4
    assert evaluate_fresnel.py_func(float(critical) - 1e-9, eta) == (1.0, 0.0)  # type: ignore[attr-defined]


@pytest.mark.parametrize("depth", [2, 8, 64])
def test_mirror_corridor(folder: Folder, depth: int) -> None:
    """Two facing mirrors of reflectance r: after n reflections the white beyond shows r^n."""
    r = 0.97
    project = studio(
        folder,
        square("left", "Mirror", [200, 1, 200], [0, -1, -190])
        + square("right", "Mirror", [200, 1, 200], [0, 1, -190]),
        {"Mirror": colour("SPECULAR", r, r, r, 1.0)},
        program("Mirror", "mirror"),
        camera='<POSITION x="0" y="0" z="5" />',
        clear=(1, 1, 1),
        size=(1, 64),
        fov=20,
        depth=depth,
    )
    frame = nau_py.Renderer(project).render()
    found = frame.targets["L::out"][:, 0, 0]
    _, direction = pixel_rays((1, 64), (0, 0, 5), 20)
    slope = np.abs(direction[:, 0, 1])
    # y runs over 395 units of z; it meets a mirror each time it has gone up or down by 2
    count = np.floor((slope * 395 + 1) / 2).astype(int)
    clear = np.abs((slope * 395 + 1) / 2 - np.rint((slope * 395 + 1) / 2)) > 1e-3
    expected = np.where(count < depth, r**count, 0.0)
    np.testing.assert_allclose(found[clear], expected[clear], atol=1e-5)
    assert frame.report["totals"]["rays"].get("reflection", 0) <= (depth - 1) * 64


def test_nested_dielectric_coincident(folder: Folder) -> None:
    """Glass in water, overlapping, in a white world: white, and no interface counted twice."""
    project = studio(
        folder,
        box("water", "Water", [1, 1, 1], [0, 0, 0]) + sphere("ball", "Glass", 0.6, [0, 0, 0.5], 64),
        {
            "Water": colour("INDEX_OF_REFRACTION", 1.33) + colour("PRIORITY", 1),
            "Glass": colour("INDEX_OF_REFRACTION", 1.5) + colour("PRIORITY", 2),
        },
        program("Water", "dielectric") + program("Glass", "dielectric"),
        camera='<POSITION x="0.5" y="0.7" z="4" /><LOOK_AT_POINT x="0" y="0" z="0" />',
        clear=(1, 1, 1),
        size=(24, 24),
        spp=16,
        depth=40,
    )
    assert picture(project)[..., 0].mean() == pytest.approx(1.0, abs=5e-3)


@pytest.mark.parametrize("roughness", [0.0, 1e-8, 1e-4, 1.0])
def test_roughness_extremes(folder: Folder, roughness: float) -> None:
    """Finite and within 1 % of white, from a perfect mirror to the roughest surface."""
    project = studio(
        folder,
        sphere("ball", "Ball", 1.0, [0, 0, 0], 64),
        {"Ball": colour("SPECULAR", 1.0, 1.0, 1.0, 1.0) + colour("ROUGHNESS", roughness)},
        program("Ball", "glossy"),
        size=(24, 24),
        spp=64,
        fov=36,
        clear=(1, 1, 1),
    )
    found = picture(project)[..., 0]
    assert np.isfinite(found).all()
    assert 0.99 <= found.mean() <= 1.01


def test_roughness_above_one_is_an_error(folder: Folder) -> None:
    material = colour("SPECULAR", 1.0, 1.0, 1.0, 1.0) + colour("ROUGHNESS", 1.5)
    project = studio(folder, square("a", "A", [1, 1, 1], [0, 0, 0]), {"A": material})
    assert [d.rule for d in nau_py.lint(project) if d.severity == "error"] == ["V006"]


@pytest.mark.parametrize("alpha", [0.5, 0.01, 0.99])
def test_alpha_stack_100(folder: Folder, alpha: float) -> None:
    """A hundred cards: what comes through is (1 - alpha)^100; none is lost."""
    cards = "".join(square(f"c{k}", "Card", [9, 1, 9], [0, 0, -0.01 * k], TURN) for k in range(100))
    project = studio(
        folder,
        cards,
        {"Card": colour("DIFFUSE", 0.0, 0.0, 0.0, alpha)},
        program("Card", "emission", "transparency"),
        clear=(1, 1, 1),
        size=(4, 4),
    )
    frame = nau_py.Renderer(project).render()
    found = frame.targets["L::out"][..., 0]
    np.testing.assert_allclose(found, (1 - alpha) ** 100, atol=1e-5)
    assert frame.report["totals"]["rays"]["continuation"] == 100 * 16


def test_a_stack_beyond_the_limit_is_reported(folder: Folder) -> None:
    cards = "".join(square(f"c{k}", "Card", [9, 1, 9], [0, 0, -0.01 * k], TURN) for k in range(300))
    project = studio(
        folder,
        cards,
        {"Card": colour("DIFFUSE", 0.0, 0.0, 0.0, 0.0)},
        program("Card", "emission", "transparency"),
        size=(4, 4),
    )
    notes = nau_py.Renderer(project).render().report["frames"][0]["passes"][0]["notes"]
    assert notes == ["16 rays met more ignored hits than the limit"]


def test_alpha_coincident_10(folder: Folder) -> None:
    """Ten cards in one place are one, and a warning says so."""
    cards = "".join(square(f"c{k}", "Card", [9, 1, 9], [0, 0, 0], TURN) for k in range(10))
    project = studio(
        folder,
        cards,
        {"Card": colour("DIFFUSE", 0.0, 0.0, 0.0, 0.5)},
        program("Card", "emission", "transparency"),
        clear=(1, 1, 1),
        size=(4, 4),
    )
    renderer = nau_py.Renderer(project)
    np.testing.assert_allclose(renderer.render().targets["L::out"][..., 0], 0.5)
    messages = [d.message for d in renderer.diagnostics if d.rule == "M005"]
    assert messages[0].startswith("pass 'trace': 18 faces are the same as another")


def test_grille_alpha_test(folder: Folder) -> None:
    """Ray and rasteriser decide the same texel: bilinear alpha above 0.25, at the full size."""
    rng = np.random.default_rng(4)
    texels = np.zeros((16, 16, 4), np.uint8)
    texels[..., 3] = rng.choice([0, 255], (16, 16))
    folder.image("card.png", texels)
    folder.mtl("scene", {"Card": {"Ke": "1 0 0", "map_Kd": "card.png"}})
    folder.obj("scene", [("Card", [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)])])
    project = studio(
        folder,
        '<file name="scene.obj" />',
        {},
        program("Card", "emission", "alpha_test"),
        size=(256, 256),
        fov=36,
    )
    traced = picture(project)[..., 3] > 0
    raster = nau_py.Renderer(project_with_raster(folder)).render().targets["L::out"][..., 3] > 0.25
    assert (traced != raster).mean() < 0.001 * 4
    assert 0.2 < traced.mean() < 0.8


def project_with_raster(folder: Folder) -> nau_py.Project:
    """The same card drawn by GLSL that puts the texture's alpha into the target."""
    text = (folder.path / "project.xml").read_text()
    start, end = text.index("<pass "), text.index("</pass>")
    text = (
        text[:start]
        + '<pass name="draw" class="default"><camera name="C" /><scenes><scene name="S" /></scenes>'
        '<renderTarget name="rt" fromLibrary="L" /><injectionMaps><map toMaterial="*">'
        '<shader fromMaterial="alpha" fromLibrary="L" /></map></injectionMaps>' + text[end:]
    )
    folder.write("raster.xml", text)
    library = (folder.path / "lib.mlib").read_text()
    library = library.replace(
        "<materials>",
        '<shaders><shader name="alpha" vs="a.vert" ps="a.frag" /></shaders><materials>'
        '<material name="alpha"><shader name="alpha"><values>'
        '<valueof uniform="PVM" type="RENDERER" context="CURRENT" '
        'component="PROJECTION_VIEW_MODEL" />'
        '<valueof uniform="t" type="TEXTURE_BINDING" context="CURRENT" component="UNIT" id="0" />'
        "</values></shader></material>",
    )
    folder.write("lib.mlib", library)
    folder.write(
        "a.vert",
        "#version 330\nin vec4 position; in vec4 texCoord0; uniform mat4 PVM; out vec2 uv;\n"
        "void main() { uv = texCoord0.xy; gl_Position = PVM * position; }",
    )
    folder.write(
        "a.frag",
        "#version 430\nin vec2 uv; uniform sampler2D t; out vec4 c;\n"
        "void main() { c = textureLod(t, uv, 0.0); }",
    )
    return folder.load("raster.xml")

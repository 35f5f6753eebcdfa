"""Leaving effects out of pictures: exact where that is promised, and what remains otherwise."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import nau_py
from nau_py.raytrace.tracing.simulated import NEGLIGIBLE
from tests.conftest import PROJECTS, Folder, RayProject
from tests.raytrace.studio import colour, program, square, studio

LAMP = '<light name="Lamp"><POSITION x="0" y="3" z="1" /><SHAPE value="POINT" /></light>'
PANEL = (
    '<light name="Lamp"><POSITION x="0" y="3" z="1" /><SHAPE value="RECTANGLE" />'
    '<EDGE_U x="2" y="0" z="0" /><EDGE_V x="0" y="0" z="2" /></light>'
)
TURN = '<ROTATE x="1" y="0" z="0" w="90" />'
WHITE = colour("DIFFUSE", 0.8, 0.8, 0.8, 1.0)
QUICK = ("05_alpha", "06_transparency", "07_reflection_refraction", "13_path_tracing")
"""Lessons of the course in the default run; the others' programs are parts of theirs."""
SAMPLES = [
    pytest.param(
        path,
        id=path.stem if "course" in path.parts else path.parent.name,
        marks=[pytest.mark.slow] * ("course" in path.parts and path.stem not in QUICK),
    )
    for path in sorted([*PROJECTS.glob("*/project.xml"), *PROJECTS.glob("course/*.xml")])
]


def render(project: nau_py.Project, effects: str | None, **options: Any) -> nau_py.Frame:
    """A frame of 48 x 48 (or the project's size), kept in floats."""
    size = options.pop("size", None)
    settings = nau_py.RunOptions(effects=effects, window_format="RGBA32F", **options)
    renderer = nau_py.Renderer(project, size=size, options=settings, keep_targets=True)
    frame = renderer.render()
    renderer.close()
    return frame


def entry(frame: nau_py.Frame, effect: str) -> dict[str, Any]:
    return next(e for e in frame.report["effects"] if e["effect"] == effect)


def brightest(project: nau_py.Project) -> float:
    """The greatest EMISSION of a material, or 1: what a path can bring at most."""
    found = [1.0]
    for library in project.libraries:
        for material in library.materials:
            if material.color is not None and "EMISSION" in material.color.settings:
                found += [float(v) for v in project.value(material.color, "COLOR", "EMISSION")[:3]]
    return max(found)


@pytest.mark.parametrize("path", SAMPLES)
def test_auto_is_all(path: Path) -> None:
    """To the bit where the report says exact. A chain that ends at a weight of 1e-4 leaves out at
    most that part of the brightest thing, and a sample has at most 64 chains."""
    project = nau_py.load(path)
    size = None if "course" in path.parts else (48, 48)
    auto = render(project, "auto", samples=2, size=size)
    every = render(project, "all", samples=2, size=size)
    assert {e["status"] for e in every.report["effects"]} <= {"simulated"}
    exact = all(e["bound"] == "exact" for e in auto.report["effects"])
    assert set(auto.targets) == set(every.targets)
    for name, target in auto.targets.items():
        if exact:
            np.testing.assert_array_equal(target, every.targets[name], name)
        else:
            bound = 64 * NEGLIGIBLE * brightest(project)
            difference = np.abs(target.astype(np.float64) - every.targets[name])
            assert np.nanmax(difference) <= bound, name


def test_opaque_cards_are_not_asked(folder: Folder, ray_project: RayProject) -> None:
    """Alpha tests on textures without holes: the same bits, and the report says so."""
    corners = [(-1.0, -1.0, 0.0), (1.0, -1.0, 0.0), (1.0, 1.0, 0.0), (-1.0, 1.0, 0.0)]
    behind = [(x * 2, y * 2, z - 1) for x, y, z in corners]
    folder.obj("scene", [("Card", corners), ("Wall", behind)])
    folder.mtl("scene", {"Card": {"map_Kd": "card.png"}, "Wall": {"Kd": "1 0 0"}})
    programs = """<rtDefaultMaterial><rayType name="Radiance">
      <rtProgram type="CLOSEST_HIT" file="builtin" proc="lambert" />
      <rtProgram type="ANY_HIT" file="builtin" proc="alpha_test" />
      <rtProgram type="MISS" file="builtin" proc="background" /></rayType></rtDefaultMaterial>"""
    found = {}
    for name, alpha in (("opaque", 255), ("holes", 0)):
        texels = np.full((8, 8, 4), 255, np.uint8)
        texels[2:6, 2:6, 3] = alpha
        folder.image("card.png", texels)
        project = ray_project(programs, light=(0, 0, -1))
        found[name] = render(project, "auto"), render(project, "all")
    for auto, every in found.values():
        np.testing.assert_array_equal(auto.targets["L::out"], every.targets["L::out"])
    opaque, holes = (entry(found[k][0], "transparency") for k in ("opaque", "holes"))
    assert not opaque["called_for"]
    assert opaque["status"] == "left_out"
    assert holes["called_for"]
    assert holes["note"].startswith("any-hit programs of 1 of 2 materials are not asked")
    assert holes["rays"] > 0


def mirrors(folder: Folder, glass: bool, mirror: bool) -> nau_py.Project:
    """A floor before a pane of glass and a mirror, either of which may be missing."""
    geometry = square("floor", "White", [6, 1, 6], [0, -1, 0])
    programs = program("White", "direct")
    materials = {"White": WHITE}
    if glass:
        materials["Glass"] = colour("INDEX_OF_REFRACTION", 1.5)
        geometry += square("pane", "Glass", [1, 1, 1], [-0.8, 0, 0], TURN)
        programs += program("Glass", "dielectric")
    if mirror:
        materials["Mirror"] = colour("SPECULAR", 0.9, 0.9, 0.9, 1.0)
        geometry += square("mirror", "Mirror", [1, 1, 1], [0.8, 0, 0], TURN)
        programs += program("Mirror", "mirror")
    return studio(folder, geometry, materials, programs, lights=LAMP)


def test_no_glass_no_refraction_ray(folder: Folder) -> None:
    """Taking things out of the file takes their rays, and their calls, out of the report."""
    found = {}
    for glass, mirror in ((True, True), (False, True), (False, False)):
        frame = render(mirrors(folder, glass, mirror), None)
        rays = frame.report["totals"]["rays"]
        found[glass, mirror] = frame
        assert ("refraction" in rays) == glass
        assert ("reflection" in rays) == (glass or mirror)
        assert entry(frame, "refraction")["called_for"] == glass
        assert entry(frame, "reflection")["called_for"] == (glass or mirror)
    causes = entry(found[False, True], "reflection")["by"]
    assert [c["what"] for c in causes] == ["material 'Mirror'"]
    assert ":" in causes[0]["where"]


def test_without_reflection_mirrors_are_black(folder: Folder) -> None:
    frame = render(mirrors(folder, False, True), "shadow")
    mirror = frame.targets["L::out"][12:18, 20:24, :3]
    assert (mirror == 0).all()
    assert "reflection" not in frame.report["totals"]["rays"]
    told = entry(frame, "reflection")
    assert told["status"] == "left_out"
    assert told["reason"] == "--effects leaves it out"
    assert told["bound"] == "not bounded"
    assert told["rays_saved"] > 0


def shadowed(folder: Folder, lights: str, card: bool, settings: str = "") -> nau_py.Project:
    geometry = square("floor", "White", [6, 1, 6], [0, 0, 0])
    if card:
        geometry += square("card", "Black", [1, 1, 1], [0, 1.2, 0])
    return studio(
        folder,
        geometry,
        {"White": WHITE, "Black": colour("DIFFUSE", 0.0, 0.0, 0.0, 1.0)},
        program("White", "direct") + program("Black", "emission"),
        lights=lights,
        camera='<POSITION x="0" y="1" z="4" /><LOOK_AT_POINT x="0" y="0" z="0" />',
        settings=settings,
        spp=4,
    )


def test_without_shadows_the_floor_is_lit_as_if_alone(folder: Folder) -> None:
    """With the card in the light's way but no shadow rays: what is not the card looks as a floor
    without a card does, to the bit."""
    lone = render(shadowed(folder, LAMP, card=False), "all").targets["L::out"]
    without = render(shadowed(folder, LAMP, card=True), "none")
    image = without.targets["L::out"]
    same = (image[..., :3] == lone[..., :3]).all(axis=-1)
    card = (image[..., :3] < 0.5 * lone[..., :3]).any(axis=-1)
    assert (same | card).mean() > 0.93  # edges of the card mix both
    with_shadow = render(shadowed(folder, LAMP, card=True), "shadow").targets["L::out"]
    assert (with_shadow[..., 0] < image[..., 0] - 0.1).any()
    assert "shadow" not in without.report["totals"]["rays"]
    assert entry(without, "shadow")["rays_saved"] > 1000


def test_without_penumbra_an_area_light_is_its_middle(folder: Folder) -> None:
    """The same bits as a point light at the centre of the panel."""
    panel = render(shadowed(folder, PANEL, card=True), "shadow")
    point = render(shadowed(folder, LAMP, card=True), "shadow")
    soft = render(shadowed(folder, PANEL, card=True), "shadow, penumbra")
    np.testing.assert_array_equal(panel.targets["L::out"], point.targets["L::out"])
    assert (np.abs(soft.targets["L::out"] - point.targets["L::out"]) > 0.02).any()


def test_without_occlusion_the_sky_is_open(folder: Folder) -> None:
    """A corner without occlusion rays shows its diffuse colour."""
    project = studio(
        folder,
        square("floor", "White", [6, 1, 6], [0, -1, 0])
        + square("wall", "White", [6, 1, 6], [0, 0, -1], TURN),
        {"White": WHITE},
        program("White", "ambient_occlusion"),
        spp=4,
    )
    frame = render(project, "none")
    np.testing.assert_allclose(frame.targets["L::out"][8:24, 8:24, :3], 0.8, rtol=1e-6)
    assert "occlusion" not in frame.report["totals"]["rays"]


def furnace(folder: Folder, lamp_program: str) -> nau_py.Project:
    """A diffuse floor under an emissive ceiling of much larger size."""
    lamp = colour("EMISSION", 1.0, 1.0, 1.0, 1.0)
    lamp += colour("DIFFUSE", 0.0, 0.0, 0.0, 1.0)
    return studio(
        folder,
        square("floor", "White", [2, 1, 2], [0, -1, 0])
        + square("sky", "Lamp", [400, 1, 400], [0, 6, 0]),
        {"White": colour("DIFFUSE", 0.5, 0.5, 0.5, 1.0), "Lamp": lamp},
        program("White", "path") + program("Lamp", lamp_program),
        camera='<POSITION x="0" y="1" z="0.1" /><LOOK_AT_POINT x="0" y="-1" z="0" />',
        spp=256,
        size=(16, 16),
        fov=20,
    )


@pytest.mark.parametrize("lamp_program", ["path", "emission"])
def test_without_indirect_light_direct_light_is_whole(folder: Folder, lamp_program: str) -> None:
    """Next-event estimation alone is unbiased: under an endless lamp of 1, albedo 0.5 shows 0.5 (less
    the 0.05 % beyond the lamp's edge), with bounces and without."""
    for effects in ("all", "shadow"):
        frame = render(furnace(folder, lamp_program), effects)
        values = frame.targets["L::out"][..., 0]
        error = values.std() / np.sqrt(values.size)
        assert abs(values.mean() - 0.5) < 4 * error + 0.002
    assert "indirect" not in frame.report["totals"]["rays"]


def test_without_depth_of_field_the_lens_is_a_pinhole(folder: Folder) -> None:
    parts: dict[str, Any] = {
        "geometry": square("floor", "White", [6, 1, 6], [0, -1, 0]),
        "materials": {"White": colour("EMISSION", 0.3, 0.6, 0.9, 1.0)},
        "spp": 4,
    }
    lens = '<POSITION x="0" y="0" z="3" /><APERTURE value="0.4" /><FOCUS_DISTANCE value="1.5" />'
    blurred = studio(folder, **parts, generate="thin_lens", camera=lens)
    with_lens = render(blurred, "all").targets["L::out"]
    without = render(blurred, "none").targets["L::out"]
    sharp = render(studio(folder, **parts), "none").targets["L::out"]
    np.testing.assert_array_equal(without, sharp)
    assert (with_lens != without).any()


def test_python_programs_obey(selective: nau_py.Frame) -> None:
    """Rays that a Python program sends are of a kind, too: glass shows its dark interior alone."""
    project = nau_py.load(PROJECTS / "selective" / "project.xml")
    frame = render(project, "shadow, transparency", size=(192, 192), samples=16)
    rays = frame.report["totals"]["rays"]
    assert "reflection" not in rays
    assert rays["primary"] == selective.report["totals"]["rays"]["primary"]
    told = entry(frame, "reflection")
    assert "'glass' of programs/hybrid.py" in told["by"][0]["what"]
    assert told["rays_saved"] > 1000


def test_a_project_says_it_and_the_run_has_the_last_word(folder: Folder) -> None:
    project = mirrors(folder, False, True)
    text = (folder.path / "project.xml").read_text()
    said = text.replace("</project>", '<effects simulate="shadow" /></project>')
    (folder.path / "project.xml").write_text(said)
    project = folder.load()
    assert nau_py.lint(project) == []
    quiet = entry(render(project, None), "reflection")
    assert (quiet["status"], quiet["reason"]) == ("left_out", "<effects> leaves it out")
    assert entry(render(project, "auto"), "reflection")["status"] == "simulated"


def test_an_empty_mask_leaves_the_pass_out(folder: Folder, ray_project: RayProject) -> None:
    """Nothing is built or traced, the target has its clear colour, and the reason is there."""
    corners = [(-1.0, -1.0, 0.0), (1.0, -1.0, 0.0), (1.0, 1.0, 0.0), (-1.0, 1.0, 0.0)]
    folder.obj("scene", [("Card", corners)])
    folder.mtl("scene", {"Card": {"Kd": "1 1 1"}})
    project = ray_project()
    mask = (
        '<pass name="choose" class="mask"><camera name="C" /><scenes><scene name="S" /></scenes>'
        '<renderTarget name="m" fromLibrary="L" /><select><material name="Absent" /></select></pass>'
    )
    target = (
        '<renderTarget name="m"><SIZE width="64" height="48" /><colors>'
        '<color name="w" internalFormat="RGBA32F" /></colors></renderTarget></renderTargets>'
    )
    library = (folder.path / "lib.mlib").read_text().replace("</renderTargets>", target)
    text = (folder.path / "project.xml").read_text()
    text = text.replace('<pass name="trace"', mask + '<pass name="trace"')
    text = text.replace(
        "<RAYS_PER_PIXEL", '<rtInput><buffer var="mask" texture="L::w" /></rtInput><RAYS_PER_PIXEL'
    )
    folder.write("lib.mlib", library)
    folder.write("project.xml", text)
    project = folder.load()
    frame = render(project, None)
    item = next(p for p in frame.report["frames"][0]["passes"] if p["name"] == "trace")
    assert (item["status"], item["reason"]) == ("left_out", "its mask selects no pixel")
    assert frame.report["totals"]["rays"] == {}
    np.testing.assert_allclose(
        frame.targets["L::out"][..., :3], [0, 0, 0.25] * np.ones((48, 64, 3))
    )

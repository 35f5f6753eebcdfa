"""Weights of selectors (``selection/weights.py``), the mask pass and the overlay of the mask."""

from __future__ import annotations

import numpy as np
import pytest

import nau_py
from nau_py.model.mask import (
    AndSelector,
    DistanceSelector,
    GazeSelector,
    MaterialSelector,
    NotSelector,
    OrSelector,
    PropertySelector,
    RegionSelector,
    ShadowBorderSelector,
)
from nau_py.raytrace.selection.weights import VisibleSurfaces, compute_weights
from tests.conftest import Folder, pixel_rays


@pytest.fixture
def seen() -> VisibleSurfaces:
    """4 x 8 pixels: glass left, wood right, nothing in the top row; depth grows to the right."""
    item = np.zeros((4, 8), np.int32)
    item[:, 4:] = 1
    item[3] = -1
    position = np.zeros((4, 8, 3), np.float32)
    position[..., 2] = -np.arange(8)
    glass = {"SPECULAR": (0.1, 0.9, 0.2, 1.0), "SHININESS": (50.0,)}
    wood = {"SPECULAR": (0.2, 0.2, 0.2, 1.0), "SHININESS": (5.0,)}
    return VisibleSurfaces(position, item, [("Vidro", glass), ("Wood", wood)], np.zeros(3))


def test_material_by_name_and_prefix(seen: VisibleSurfaces) -> None:
    expected = (seen.item == 0).astype(float)
    for name in ("Vidro", "Vid*"):
        np.testing.assert_array_equal(
            compute_weights([MaterialSelector(name=name)], seen), expected
        )
    np.testing.assert_array_equal(compute_weights([MaterialSelector(name="Nothing")], seen), 0)


def test_material_property(seen: VisibleSurfaces) -> None:
    glass = (seen.item == 0).astype(float)
    above = PropertySelector(name="SPECULAR", above=0.4)
    np.testing.assert_array_equal(compute_weights([above], seen), glass)
    between = PropertySelector(name="SHININESS", above=1.0, below=10.0)
    np.testing.assert_array_equal(compute_weights([between], seen), seen.item == 1)
    np.testing.assert_array_equal(
        compute_weights([PropertySelector(name="GLOSS", above=0.0)], seen), 0
    )


def test_region(seen: VisibleSurfaces) -> None:
    half = compute_weights([RegionSelector(height=0.5)], seen)
    np.testing.assert_array_equal(half[:2], 1)
    np.testing.assert_array_equal(half[2:], 0)
    soft = compute_weights([RegionSelector(width=0.5, edge=4.0)], seen)
    # the line is at 4; pixel centres 3.5 and 4.5 lie half a pixel to either side of it
    np.testing.assert_allclose(soft[1, 3:6], [0.625, 0.375, 0.125])


def test_distance_and_floor(seen: VisibleSurfaces) -> None:
    found = compute_weights([DistanceSelector(near=2.0, far=6.0, floor=0.2)], seen)
    np.testing.assert_allclose(found[0], [1, 1, 1, 0.8, 0.6, 0.4, 0.2, 0.2], rtol=1e-6)
    np.testing.assert_allclose(found[3], 0.2)  # the background is beyond everything


def test_gaze(seen: VisibleSurfaces) -> None:
    found = compute_weights([GazeSelector(x=0.25, y=0.5, inner=0.25, outer=1.0, floor=0.1)], seen)
    x, y = np.meshgrid(np.arange(8) + 0.5 - 2, np.arange(4) + 0.5 - 2)
    r = np.hypot(x, y) / 4
    expected = np.interp(r, [0.25, 1.0], [1.0, 0.1])
    np.testing.assert_allclose(found, expected, rtol=1e-6)
    assert (found == 1).sum() == 4


def test_combinations(seen: VisibleSurfaces) -> None:
    glass, low = MaterialSelector(name="Vidro"), RegionSelector(height=0.25)
    a, b = seen.item == 0, np.arange(4)[:, None] < 1
    both = compute_weights([AndSelector(parts=[glass, low])], seen)
    np.testing.assert_array_equal(both, a & b)
    np.testing.assert_array_equal(compute_weights([OrSelector(parts=[glass, low])], seen), a | b)
    np.testing.assert_array_equal(compute_weights([glass, low], seen), a | b)
    np.testing.assert_array_equal(
        compute_weights([NotSelector(parts=[glass, low])], seen), ~(a | b)
    )
    np.testing.assert_array_equal(compute_weights([], seen), 1)


def test_shadow_border(seen: VisibleSurfaces) -> None:
    """A map whose left half is near the light: the border is one texel on either side."""
    depth = np.ones((8, 8, 1), np.float32)
    depth[:, :4] = 0.2
    seen.textures["L::depth"] = depth
    # world x in 0..8 to the map's u; z is half way
    u, v = np.meshgrid((np.arange(8) + 0.5) / 8, (np.arange(4) + 0.5) / 4)
    seen.position[..., 0], seen.position[..., 1] = u, v
    seen.position[..., 2] = 0.5
    seen.cameras["Sun"] = np.eye(4)
    border = ShadowBorderSelector(texture="L::depth", camera="Sun")
    np.testing.assert_array_equal(compute_weights([border], seen)[0], [0, 0, 0, 1, 1, 0, 0, 0])
    wide = ShadowBorderSelector(texture="L::depth", camera="Sun", radius=2)
    np.testing.assert_array_equal(compute_weights([wide], seen)[0], [0, 0, 1, 1, 1, 1, 0, 0])
    np.testing.assert_array_equal(compute_weights([border], seen)[3], 0)
    # the blocker is 0.3 away, one texel 0.125: a light of half angle atan(0.5) reaches it, no less
    for spread, reaches in ((0.5, 1), (0.4, 0)):
        light = ShadowBorderSelector(texture="L::depth", camera="Sun", spread=spread)
        assert compute_weights([light], seen)[0, 4] == reaches


MASKED = """\
<project name="Masked" width="64" height="48"><assets>
  <scenes><scene name="S"><file name="scene.obj" /></scene></scenes>
  <cameras><camera name="C"><projection TYPE="PERSPECTIVE" FOV="60" NEAR="0.1" FAR="100" />
    <POSITION x="0" y="0" z="3" /></camera></cameras>
  <materialLibs><materialLib filename="lib.mlib" /></materialLibs>
</assets><pipelines><pipeline name="P">
  <pass name="choose" class="mask"><camera name="C" /><scenes><scene name="S" /></scenes>
    <renderTarget name="mask" fromLibrary="L" /><select>{select}</select></pass>
  <pass name="trace" class="raytrace"><camera name="C" /><scenes><scene name="S" /></scenes>
    <renderTarget name="rt" fromLibrary="L" /><RAYS_PER_PIXEL value="8" />
    <rtEntryPoint><rayGen file="builtin" proc="pinhole" /></rtEntryPoint>
    <rtDefaultMaterial><rayType name="R">
      <rtProgram type="CLOSEST_HIT" file="builtin" proc="emission" /></rayType></rtDefaultMaterial>
    <rtInput><buffer var="mask" texture="L::weight" {how} /></rtInput></pass>
</pipeline></pipelines></project>
"""
TARGETS = """\
<materialLib name="L"><renderTargets>
  <renderTarget name="mask"><SIZE width="64" height="48" /><colors>
    <color name="weight" internalFormat="RGBA32F" /></colors></renderTarget>
  <renderTarget name="rt"><SIZE width="64" height="48" /><colors>
    <color name="out" internalFormat="RGBA32F" /></colors></renderTarget>
</renderTargets></materialLib>
"""


@pytest.fixture
def masked(folder: Folder) -> Folder:
    folder.write("lib.mlib", TARGETS)
    folder.mtl("scene", {"Vidro": {"Ke": "1 0 0"}, "Wall": {"Ke": "0 1 0"}})
    folder.obj(
        "scene",
        [
            ("Wall", [(-9, -9, -2), (9, -9, -2), (9, 9, -2), (-9, 9, -2)]),
            ("Vidro", [(-1, -0.5, 0), (0.5, -0.5, 0), (0.5, 0.75, 0), (-1, 0.75, 0)]),
        ],
    )
    return folder


def render(folder: Folder, select: str, how: str = "") -> nau_py.Frame:
    folder.write("project.xml", MASKED.format(select=select, how=how))
    return nau_py.Renderer(folder.load()).render()


def test_the_pass_selects_what_is_seen(masked: Folder) -> None:
    """Glass by name, against the rectangle that the camera sees, and its world position."""
    frame = render(masked, '<material name="Vid*" />')
    chosen = frame.targets["L::weight"]
    _, direction = pixel_rays((64, 48), (0, 0, 3))
    x, y = direction[..., 0] * 3, direction[..., 1] * 3
    inside = (x > -1) & (x < 0.5) & (y > -0.5) & (y < 0.75)
    np.testing.assert_array_equal(chosen[..., 3] > 0, inside)
    np.testing.assert_allclose(chosen[inside][:, 0], x[inside], atol=1e-5)
    np.testing.assert_allclose(chosen[inside][:, 2], 0, atol=1e-6)
    traced = frame.report["frames"][0]["passes"][1]
    assert traced["pixels"] == inside.sum()
    assert traced["rays"]["primary"] == 8 * inside.sum()
    np.testing.assert_array_equal(frame.targets["L::out"][..., 0] > 0, inside)


def test_weights_as_samples(masked: Folder) -> None:
    """Full inside the fovea, fewer samples outside, at least one."""
    gaze = '<gaze inner="0.1" outer="0.5" floor="0.01" />'
    frame = render(masked, gaze, 'weight="spp"')
    weight = frame.targets["L::weight"][..., 3].astype(float)
    expected = np.maximum(np.rint(weight * 8), 1).sum()
    assert frame.report["frames"][0]["passes"][1]["rays"]["primary"] == expected
    assert 64 * 48 < expected < 8 * 64 * 48


def test_the_overlay_tints_what_is_traced(masked: Folder, tmp_path: object) -> None:
    from nau_py.run.mask_overlay import mask_overlay

    masked.write("project.xml", MASKED.format(select='<region width="0.5" />', how=""))
    renderer = nau_py.Renderer(masked.load())
    frame = renderer.render()
    shown = mask_overlay(frame.image, frame.targets, renderer.plan)
    changed = (shown != frame.image).any(axis=-1)
    assert changed[:, :32].all()
    assert not changed[:, 32:].any()


def test_selectors_survive_both_formats(masked: Folder) -> None:
    """XML to YAML and back is the same model."""
    from nau_py.formats.load import load_project
    from nau_py.formats.write import format_node

    select = (
        '<or><material name="Vidro" /><and><not><region width="0.5" /></not>'
        '<distance near="1" far="5" floor="0.25" /></and></or><gaze inner="0.2" />'
    )
    masked.write("project.xml", MASKED.format(select=select, how='weight="spp"'))
    first = load_project(masked.path / "project.xml")
    masked.write("again.yaml", format_node(first.file, first.registry, "yaml"))
    again = load_project(masked.path / "again.yaml")
    assert first.file == again.file
    assert len(first.pipelines[0].passes[0].select) == 2  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    "select, library, expected",
    [
        (
            '<property name="SPECULAR" />',
            TARGETS.replace("RGBA32F", "RGBA", 1),
            "mask pass 'choose' writes positions to 'weight', of format 'RGBA'; 'RGBA32F', 'RGBA16F' "
            "holds them",
        ),
        (
            '<and><property name="SPECULR" above="0.5" /></and>',
            TARGETS,
            "mask pass 'choose': materials have no 'SPECULR'; there is",
        ),
    ],
)
def test_lint_of_mask_passes(masked: Folder, select: str, library: str, expected: str) -> None:
    masked.write("lib.mlib", library)
    masked.write("project.xml", MASKED.format(select=select, how=""))
    found = [d.message for d in nau_py.lint(masked.load()) if d.rule == "P003"]
    assert len(found) == 1
    assert found[0].startswith(expected)

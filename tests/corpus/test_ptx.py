"""Nau's own OptiX programs, from their shipped PTX, against the pictures that real OptiX gave."""

from __future__ import annotations

import json
import os
import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import nau_py
from nau_py.model.node import Setting
from nau_py.model.raytrace import RaytracePass
from nau_py.raytrace.tracing.accelerator import Accelerator
from nau_py.raytrace.tracing.geometry import RayGeometry, gather_triangles

pytestmark = pytest.mark.corpus
NAU, ORACLE = os.environ.get("NAU_CORPUS"), os.environ.get("NAU_ORACLE")
if not NAU or not ORACLE:
    pytest.skip("NAU_CORPUS and NAU_ORACLE name no folders", allow_module_level=True)
REFERENCES = Path(ORACLE) / "rt"
NAMES = sorted(p.name for p in REFERENCES.iterdir() if p.is_dir())
RANDOM = ("09", "10", "11", "12", "13", "14")
"""Programs that draw random numbers: the same generator, so the same picture up to rounding."""
_EDIT = re.compile(
    r"(?P<file>\S+): replaced (?P<old>'.*'|\".*\") by (?P<new>'.*'|\".*\")$", re.DOTALL
)
Pixels = np.ndarray[Any, Any]


def prepared(name: str, folder: Path) -> tuple[Path, dict[str, Any]]:
    """A copy of the project with the edits that the reference was made with."""
    meta = json.loads((REFERENCES / name / "meta.json").read_text())
    source = Path(NAU or "") / meta["project"]
    root = folder / "nau"
    home = root / Path(meta["project"]).parent
    shutil.copytree(source.parent, home)
    models = Path(NAU or "") / "models"
    (root / "models").mkdir(parents=True)
    for entry in models.iterdir():
        (root / "models" / entry.name).symlink_to(entry)
    for edit in meta["edits"]:
        found = _EDIT.match(edit)
        assert found is not None, edit
        file = home / found["file"]
        if not file.exists():
            file = root / found["file"]
            link = root / "models" / Path(found["file"]).parts[1]
            if link.is_symlink():
                target = link.resolve()
                link.unlink()
                shutil.copytree(target, link)
        old, new = (found[key][1:-1] for key in ("old", "new"))
        text = file.read_text("latin-1")
        assert old in text, edit
        file.write_text(text.replace(old, new), "latin-1")
    return home / source.name, meta


def words(frame: nau_py.Frame) -> Pixels:
    """Return the colours that the program wrote, RGB."""
    (name,) = [n for n in frame.targets if not n.endswith("_depth")][:1]
    return frame.targets[name][:, :, :3].astype(int)


@pytest.mark.parametrize("name", NAMES)
def test_the_picture_of_real_optix(name: str, tmp_path: Path) -> None:
    project, meta = prepared(name, tmp_path)
    renderer = nau_py.Renderer(nau_py.load(project))
    found = words(renderer.render(meta["final_frame"]))
    renderer.close()
    reference = Image.open(REFERENCES / name / "final.png").convert("RGB")
    wanted = np.asarray(reference).astype(int)
    assert found.shape == wanted.shape
    off = np.abs(found - wanted).max(axis=2)
    if name[5:7] in RANDOM:
        assert (off <= 4).mean() >= 0.97
    else:
        assert (off <= 2).mean() >= 0.995


VARIANTS = [
    (name, variant)
    for name in NAMES
    for variant in json.loads((REFERENCES / name / "meta.json").read_text())["variants"]
]


@pytest.mark.parametrize("name, variant", VARIANTS, ids=[f"{n}-{v['file']}" for n, v in VARIANTS])
def test_the_picture_with_other_parameters(
    name: str, variant: dict[str, Any], tmp_path: Path
) -> None:
    """Samples, depth, user attributes and size changed; bounds as above."""
    path, _ = prepared(name, tmp_path)
    project = nau_py.load(path)
    (pass_,) = [p for pl in project.pipelines for p in pl.passes if p.pass_class == "rt"]
    values = {"RAYS_PER_PIXEL": variant["rays_per_pixel_side"], "MAX_DEPTH": variant["max_depth"]}
    for key, value in (values | variant["overrides"]).items():
        pass_.settings[key] = Setting((value,))
    size = (variant["width"], variant["height"])
    for viewport in project.assets.viewports:
        viewport.settings["SIZE"] = Setting(size)
    for library in project.libraries[1:]:
        for target in library.renderTargets:
            target.settings["SIZE"] = Setting(size)
    renderer = nau_py.Renderer(project)
    found = words(renderer.render(variant["last_frame"]))
    renderer.close()
    wanted = np.asarray(Image.open(REFERENCES / name / variant["file"]).convert("RGB")).astype(int)
    assert found.shape == wanted.shape
    off = np.abs(found - wanted).max(axis=2)
    most, share = (4, 0.97) if name[5:7] in RANDOM else (2, 0.995)
    assert (off <= most).mean() >= share


BOX = "../../models/cornellBox/CornellBox-Sphere2.obj"


def old_project(path: str, folder: Path, edits: dict[str, str]) -> nau_py.Project:
    """A copy of a project of class ``optix``, with edits."""
    source = Path(NAU or "") / path
    home = folder / Path(path).parent
    shutil.copytree(source.parent, home)
    (folder / "models").symlink_to(Path(NAU or "") / "models")
    text = source.read_text("latin-1")
    for old, new in edits.items():
        assert old in text
        text = text.replace(old, new)
    file = home / source.name
    file.write_text(text, "latin-1")
    return nau_py.load(file)


def traced(renderer: nau_py.Renderer) -> tuple[Accelerator, RayGeometry, Any]:
    """Embree over the scene of a project's raytrace pass, its triangles, its camera."""
    pass_ = next(p for p in renderer.pipeline.passes if isinstance(p, RaytracePass))
    world = renderer.session.world
    geometry = gather_triangles(world.objects(pass_.scene_names), frozenset())
    return Accelerator(geometry), geometry, world.camera(pass_.camera_name)


def test_shadows_of_the_deferred_project(tmp_path: Path) -> None:
    """OptixTestDeferred, its missing model replaced: what its shadow rays bring is what Embree says
    of the positions that the raster pass left, where the light reaches at all."""
    project = old_project(
        "projects/optix test deferred/OptixTestDeferred.xml",
        tmp_path,
        {
            r"..\..\models\LargoCamoes\largoCamoes.nbo": BOX,
            'x="-4.0" y="20.0" z="-29.0"': 'x="0.0" y="0.75" z="2.5"',
            'x="0.91" y="-0.29" z="0.26"': 'x="0.0" y="0.0" z="-1.0"',
            '<DIRECTION x="1" y="-1" z="-1" />': '<DIRECTION x="0.4" y="-0.5" z="-1" />',
        },
    )
    renderer = nau_py.Renderer(project)
    frame = renderer.render()
    positions = frame.targets["Deferred Render Targets::pos"].reshape(-1, 4)
    found = frame.targets["Optix Ray Tracer Render Target::offscreenrender"].reshape(-1, 4)
    accelerator, geometry, _ = traced(renderer)
    lit = positions[:, 3] > 0
    light = np.array([-0.4, 0.5, 1.0], np.float32)
    origin = (positions[lit, :3] - geometry.centre + 1e-4 * light).astype(np.float32)
    wanted = ~accelerator.find_occluded(origin, np.broadcast_to(light, origin.shape))
    renderer.close()
    assert 0.1 < wanted.mean() < 0.9
    assert (found[~lit] == 1).all()
    assert (found[lit][:, 0] == wanted).mean() > 0.999


def test_the_cornell_box_project(tmp_path: Path) -> None:
    """Every pixel is what its rays can bring: white where all four meet the light, black where all
    miss the box, no exception's red; the left wall bleeds red, the right one blue."""
    project = old_project("projects/path tracing/OptixTest Cornell Box.xml", tmp_path, {})
    renderer = nau_py.Renderer(project)
    frame = renderer.render(3)
    found = frame.targets["Optix Ray Tracer Render Target::offscreenrenderOptix"][::-1, :, :3]
    assert not any("T019" in said for said in frame.report["warnings"])
    accelerator, geometry, camera = traced(renderer)
    tangent = np.tan(np.radians(camera.values["FOV"]) / 2)
    y, x = np.mgrid[0:1024, 0:1024].reshape(2, -1)
    met = []
    for dx, dy in ((0.0, 0.0), (2.0, 0.0), (0.0, 2.0), (2.0, 2.0)):  # its jitter spans 0.5 to 1.5
        a, b = ((x + dx) / 512 - 1) * tangent, ((y + dy) / 512 - 1) * tangent
        towards = camera.forward + a[:, None] * camera.right + b[:, None] * camera.true_up
        towards /= np.linalg.norm(towards, axis=1, keepdims=True)
        origin = np.broadcast_to(
            (camera.position - geometry.centre).astype(np.float32), towards.shape
        )
        met.append(accelerator.intersect(origin, towards.astype(np.float32)).triangle)
    names = np.array(geometry.materials)[geometry.material]
    hits = np.stack(met)
    light = ((hits >= 0) & (names[hits] == "light")).all(axis=0).reshape(1024, 1024)
    none = (hits < 0).all(axis=0).reshape(1024, 1024)
    left, right = (
        ((hits >= 0) & (names[hits] == n)).all(axis=0).reshape(1024, 1024)
        for n in ("leftWall", "rightWall")
    )
    renderer.close()
    assert min(m.sum() for m in (light, none, left, right)) > 5000
    assert (found[light] == 1).all()
    assert (found[none] == 0).all()
    assert np.isfinite(found).all()
    assert not (found == [1, 0, 0]).all(axis=2).any()
    red, blue = found[left].mean(axis=0), found[right].mean(axis=0)
    assert red[0] > 5 * red[1:].max()
    assert blue[2] > 1.5 * blue[:2].max()


def test_a_missing_model_is_named() -> None:
    path = Path(NAU or "") / "projects/path tracing/OptixTest Sponza.xml"
    found = [d for d in nau_py.lint(nau_py.load(path)) if d.severity == "error"]
    if not found:
        pytest.skip("this checkout has the model")
    assert {d.rule for d in found} == {"F001"}
    assert "the model file '../../models/sponza/crytek-sponza/sponza.nbo' does not exist" in (
        found[0].message
    )

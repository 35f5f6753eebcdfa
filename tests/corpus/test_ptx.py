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
    """What the program wrote, RGB."""
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

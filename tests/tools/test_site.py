"""tools.gallery, mkdocs.yml: the page of a project, and links without a broken one."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.conftest import ROOT, Folder, RayProject
from tools.gallery import build_gallery, copy_sources, name_project, sample_projects


def test_a_gallery_of_one(ray_project: RayProject, folder: Folder, tmp_path: Path) -> None:
    folder.obj("scene", [("Red", [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)])])
    folder.mtl("scene", {"Red": {"Kd": "1 0 0"}})
    ray_project(light=(0, 0, -1), size=(32, 24), spp=2)
    home = tmp_path / "root" / "projects" / "square"
    home.mkdir(parents=True)
    for file in ("project.xml", "lib.mlib", "scene.obj", "scene.mtl"):
        (folder.path / file).rename(home / file)
    (home / "README.md").write_text("# A red square\n")
    out = tmp_path / "gallery"
    lines = list(build_gallery(tmp_path / "root", out))
    assert len(lines) == 1
    page = (out / "index.md").read_text()
    assert "## A red square" in page
    assert "![A red square](square.png)" in page
    assert "[project.xml](../projects/square/project.xml)" in page
    assert "| trace | raytrace | " in page
    assert "primary 1,536" in page  # 32 x 24 x 2
    image = np.asarray(Image.open(out / "square.png"))
    assert image[12, 16].tolist() == [255, 0, 0]
    assert "<svg" in (out / "square.svg").read_text()


def test_every_sample_is_in_the_gallery() -> None:
    names = [name_project(ROOT, p) for p in sample_projects(ROOT)]
    assert names[:2] == ["ambient_occlusion", "caustics"]
    assert {"selective", "course_14_tone_mapping"} <= set(names)


def test_the_site_has_no_broken_link(tmp_path: Path) -> None:
    pytest.importorskip("mkdocs", reason="the extra [docs] is not installed")
    source = tmp_path / "src"
    source.mkdir()
    copy_sources(ROOT, source)
    (source / "gallery").mkdir()
    (source / "gallery" / "index.md").write_text("# Gallery\n")
    shutil.copy(ROOT / "mkdocs.yml", tmp_path)
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet"]
    done = subprocess.run(
        [*command, "--config-file", str(tmp_path / "mkdocs.yml")],
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    assert "WARNING" not in done.stderr
    for page in ("index.html", "docs/rules.html", "projects/course/index.html"):
        assert (tmp_path / "html" / page).exists()

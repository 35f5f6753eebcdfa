"""Plug-ins as another package would bring them: the example of docs/extending, each kind once."""

from __future__ import annotations

import ast
import json
import os
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import nau_py.plugin
from tests.conftest import ROOT
from tests.plugins import EXAMPLE, install, install_example, run


def test_each_kind_of_plug_in(tmp_path: Path) -> None:
    environment = install_example(tmp_path / "site")
    picture, report = tmp_path / "picture.png", tmp_path / "report.json"
    project = str(EXAMPLE / "project.xml")
    found = run("nau-lint", project, "--format", "json", env=environment)
    (finding,) = json.loads(found.stdout)
    assert (finding["rule"], finding["line"], finding["column"]) == ("Z001", 16, 21)
    done = run("nau-run", project, "-o", str(picture), "--report", str(report), env=environment)
    assert done.returncode == 0, done.stderr
    passes = json.loads(report.read_text())["frames"][0]["passes"]
    assert [(p["class"], p["status"]) for p in passes] == [("raytrace", "run"), ("vignette", "run")]
    image = np.asarray(Image.open(picture)).astype(float)
    # the background, and what the vignette leaves of it: half in a corner, all in the middle
    sky = np.array([0.75, 0.85, 0.95]) * 255
    across, up = 1 / 256, 1 / 192
    corner = 1 - 0.5 * ((1 - across) ** 2 + (1 - up) ** 2) / 2
    assert image[0, 0] == pytest.approx(sky * corner, abs=1)
    # the pyramid's side towards the camera, one of three steps of light
    diffuse = np.array([0.9, 0.5, 0.2])
    normal, light = np.array([0, 2, 3]) / 13**0.5, np.array([0.5, 1, 0.8]) / 1.89**0.5
    step = np.ceil(normal @ light * 3) / 3
    y, x = 100, 128
    middle = 1 - 0.5 * (((x + 0.5) / 256 * 2 - 1) ** 2 + ((y + 0.5) / 192 * 2 - 1) ** 2) / 2
    expected = diffuse * (0.2 + 0.8 * step) * 255 * middle
    assert image[y, x] == pytest.approx(np.minimum(expected, 255), abs=2)


def test_without_the_package_each_is_named(tmp_path: Path) -> None:
    found = run("nau-lint", str(EXAMPLE / "project.xml"), "--format", "json", env=dict(os.environ))
    said = {d["rule"]: d["message"] for d in json.loads(found.stdout)}
    assert "class 'vignette' is unknown" in said["P001"]
    assert "there is no plug-in 'plugin:toon'" in said["T003"]


def test_a_plug_in_that_does_not_load_is_said(tmp_path: Path) -> None:
    site = tmp_path / "site"
    groups = {
        "nau_py.passes": {"broken": "nau_broken:Pass"},
        "nau_py.readers": {".brk": "nau_missing:read"},
    }
    install(site, groups, "nau_broken")
    (site / "nau_broken.py").write_text("raise RuntimeError('not today')\n")
    env = os.environ | {"PYTHONPATH": str(site)}
    project = str(ROOT / "projects" / "mirror" / "project.xml")
    found = run("nau-lint", project, "--format", "json", env=env)
    assert found.returncode == 1
    listed = [d["message"] for d in json.loads(found.stdout) if d["rule"] == "E005"]
    assert len(listed) == 2
    assert "plug-in 'broken' (nau_broken:Pass, group nau_py.passes)" in listed[0]
    assert "package 'nau_broken' cannot be loaded: RuntimeError: not today" in listed[0]
    assert "No module named 'nau_missing'" in listed[1]


def test_the_surface_of_plug_ins() -> None:
    assert nau_py.plugin.__all__ == [
        "ERROR",
        "NOTE",
        "WARNING",
        "Access",
        "Attribute",
        "Change",
        "DataType",
        "Diagnostic",
        "Fix",
        "FrameContext",
        "Group",
        "LintContext",
        "Mesh",
        "ModelError",
        "ModelMaterial",
        "NauError",
        "Part",
        "Pass",
        "PassClass",
        "PassReport",
        "PassState",
        "Project",
        "SceneObject",
        "Session",
        "View",
        "add_maps",
        "add_process",
        "add_target",
        "begin_drawing",
        "buffer",
        "check",
        "choice",
        "draw_scenes",
        "error",
        "flag",
        "number",
        "pad4",
        "pass_value",
        "register_pass",
        "resolve_view",
        "rule",
        "run_process",
        "texture",
        "vector",
        "warning",
    ]
    for name in nau_py.plugin.__all__:
        assert getattr(nau_py.plugin, name) is not None


def test_the_example_imports_nothing_else() -> None:
    for path in EXAMPLE.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                assert not any(alias.name.startswith("nau_py") for alias in node.names), path
            elif isinstance(node, ast.ImportFrom) and (node.module or "").startswith("nau_py"):
                assert node.module == "nau_py.plugin", path

"""Plug-ins as another package would bring them: the example of docs/extending, each kind once."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.conftest import ROOT

EXAMPLE = ROOT / "docs" / "extending"


def installed(folder: Path, groups: dict[str, dict[str, str]], name: str) -> None:
    """What pip leaves of a package's entry points."""
    info = folder / f"{name}-0.1.0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 0.1.0\n")
    lines = []
    for group, entries in groups.items():
        lines += [f"[{group}]", *(f"{key} = {value}" for key, value in entries.items()), ""]
    (info / "entry_points.txt").write_text("\n".join(lines))


@pytest.fixture
def environment(tmp_path: Path) -> dict[str, str]:
    """The example package as if it were installed."""
    declared = tomllib.loads((EXAMPLE / "pyproject.toml").read_text())
    site = tmp_path / "site"
    installed(site, declared["project"]["entry-points"], "nau_example")
    for file in EXAMPLE.glob("nau_example_*.py"):
        shutil.copy(file, site)
    return os.environ | {"PYTHONPATH": str(site)}


def run(command: str, *arguments: str, env: dict[str, str]) -> subprocess.CompletedProcess[str]:
    program = str(Path(sys.executable).parent / command)
    return subprocess.run(
        [program, *arguments], env=env, capture_output=True, text=True, timeout=120
    )


def test_each_kind_of_plug_in(tmp_path: Path, environment: dict[str, str]) -> None:
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
    installed(site, groups, "nau_broken")
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

"""Saving changes: the lines that must, and no others; the project then says what was wanted."""

from __future__ import annotations

import difflib
import shutil
from pathlib import Path

import pytest

import nau_py
from nau_py.viewer.controls import Values, controls, home, parts_of
from nau_py.viewer.save import save_edits
from tests.conftest import PROJECTS, ROOT, Folder


def changed_lines(before: str, after: str) -> list[str]:
    lines = difflib.ndiff(before.splitlines(), after.splitlines())
    return [line for line in lines if line.startswith(("+ ", "- "))]


def save(file: Path, values: Values) -> list[str]:
    """Write the values; the keys that no file holds."""
    files, left = save_edits(nau_py.load(file), values)
    for path, (document, edits) in files.items():
        document.write(path, edits)
    return left


def values_of(file: Path) -> Values:
    project = nau_py.load(file)
    pipeline = project.default_pipeline
    assert pipeline is not None
    return {c.key: c.value for c in controls(project, pipeline)}


@pytest.fixture(params=["project.xml", "project.yaml"])
def demo(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    shutil.copytree(PROJECTS / "selective", tmp_path / "projects" / "selective")
    (tmp_path / "projects" / "models").symlink_to(PROJECTS / "models")
    shutil.copytree(ROOT / "materials", tmp_path / "materials")
    return tmp_path / "projects" / "selective" / str(request.param)


def test_nothing_changed_writes_nothing(demo: Path) -> None:
    """Every value of the demo, as it is: 1 is 1.0, and the file stays as it is to the byte."""
    before = demo.read_bytes()
    project = nau_py.load(demo)
    written = {
        key: value
        for key, value in values_of(demo).items()
        if parts_of(key)[2] in getattr(home(project, key), "settings", {})
    }
    assert len(written) > 12
    assert save(demo, written) == []
    assert demo.read_bytes() == before


def test_a_value_changes_its_own_line(demo: Path) -> None:
    before = demo.read_text()
    wanted: Values = {
        "LIGHT|Sun|COLOR": (1.0, 0.5, 0.9, 1.0),
        "CAMERA|Eye|FOV": (35.0,),
        "CAMERA|Eye|POSITION": (3.6, 2.25, 6.5, 0.0),
        "PASS|Selective#trace|MAX_DEPTH": (5,),
        "PASS|Selective#trace|RAYS_PER_PIXEL": (16,),
    }
    assert save(demo, wanted) == []
    lines = changed_lines(before, demo.read_text())
    assert len([line for line in lines if line.startswith("+")]) == 4
    assert len(lines) == 8
    found = values_of(demo)
    for key, value in wanted.items():
        assert found[key][: len(value)] == pytest.approx(value), key
    assert [d for d in nau_py.lint(nau_py.load(demo)) if d.severity == "error"] == []


def test_a_value_that_no_file_gives_adds_one_line(demo: Path) -> None:
    before = demo.read_text()
    wanted: Values = {
        "PASS|Selective#trace|SAMPLER": ("RANDOM",),
        "LIGHT|Sun|AMBIENT": (0.1, 0.2, 0.3, 1.0),
        "CAMERA|Eye|UP": (0.1, 1.0, 0.0, 0.0),
    }
    assert save(demo, wanted) == []
    lines = changed_lines(before, demo.read_text())
    assert [line[0] for line in lines] == ["+", "+", "+"]
    found = values_of(demo)
    for key, value in wanted.items():
        assert found[key] == pytest.approx(value), key


def test_what_a_model_defines_stays(demo: Path) -> None:
    before = demo.read_bytes()
    assert save(demo, {"COLOR|__nau_material_lib::Vidro|DIFFUSE": (1.0, 0.0, 0.0, 1.0)}) == [
        "COLOR|__nau_material_lib::Vidro|DIFFUSE"
    ]
    assert demo.read_bytes() == before


def test_masks_constants_and_interface(folder: Folder) -> None:
    folder.write(
        "l.mlib",
        '<materialLib name="L"><renderTargets><renderTarget name="m"><SIZE width="8" height="8"/>'
        '<colors><color name="w" internalFormat="RGBA32F"/></colors></renderTarget></renderTargets>'
        '<materials><material name="red"><color><DIFFUSE r="1" g="0" b="0" /></color></material>'
        "</materials></materialLib>",
    )
    text = """\
<project name="P" width="8" height="8">
  <assets>
    <constants><constant name="far" value="50"/></constants>
    <attributes><attribute name="glow" type="LIGHT" data="FLOAT" value="0.5"/>
      <attribute name="wind" type="RENDERER" data="VEC3" x="1" y="0" z="0"/></attributes>
    <scenes><scene name="S"><geometry name="g" type="SQUARE"/></scene></scenes>
    <lights><light name="Sun"/></lights>
    <cameras><camera name="C"><projection FOV="60" NEAR="1" FAR="far"/></camera></cameras>
    <materialLibs><materialLib filename="l.mlib"/></materialLibs>
  </assets>
  <pipelines>
    <pipeline name="P" defaultCamera="C">
      <pass name="mask" class="mask">
        <camera name="C"/><scenes><scene name="S"/></scenes>
        <renderTarget name="m" fromLibrary="L"/>
        <select><or><distance near="5" far="9"/><gaze inner="0.2"/></or></select>
      </pass>
      <pass name="show"/>
    </pipeline>
  </pipelines>
  <interface><window label="W">
    <var label="warmth" type="LIGHT" context="Sun" component="COLOR" mode="COLOR"/>
    <var label="wind" type="RENDERER" context="CURRENT" component="wind"/>
    <var label="glow" type="LIGHT" context="Sun" component="glow" def="min=0 max=2"/>
  </window></interface>
</project>
"""
    file = folder.write("project.xml", text)
    project = nau_py.load(file)
    pipeline = project.default_pipeline
    assert pipeline is not None
    listed = {c.key: c for c in controls(project, pipeline)}
    assert listed["LIGHT|Sun|COLOR"].label == "warmth"
    glow = listed["LIGHT|Sun|glow"]
    assert (glow.value, glow.minimum, glow.maximum) == ((0.5,), 0.0, 2.0)
    assert listed["COLOR|L::red|DIFFUSE"].value == (1.0, 0.0, 0.0, 0.0)
    wanted: Values = {
        "MASK|mask#1|near": (6.5,),
        "MASK|mask#2|inner": (0.3,),
        "CAMERA|C|FAR": (50.0,),
        "CAMERA|C|NEAR": (0.25,),
        "LIGHT|Sun|glow": (1.5,),
        "RENDERER|CURRENT|wind": (1.0, 0.0, -2.5),
        "COLOR|L::red|DIFFUSE": (1.0, 0.25, 0.0, 0.0),
    }
    assert save(file, wanted) == []
    assert [
        line[2:].strip() for line in changed_lines(text, file.read_text()) if line[0] == "+"
    ] == [
        '<attribute name="wind" type="RENDERER" data="VEC3" x="1" y="0" z="-2.5"/></attributes>',
        '<lights><light name="Sun">',
        '<glow value="1.5" />',
        "</light></lights>",
        '<cameras><camera name="C"><projection FOV="60" NEAR="0.25" FAR="far"/></camera></cameras>',
        '<select><or><distance near="6.5" far="9"/><gaze inner="0.3"/></or></select>',
    ]
    assert 'r="1" g="0.25" b="0"' in (folder.path / "l.mlib").read_text()
    found = values_of(file)
    for key, value in wanted.items():
        assert found[key] == pytest.approx(value), key

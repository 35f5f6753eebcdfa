"""Pipelines one after another: docs/format.md, 11.2 (nau_py.run.active_pipeline)."""

from __future__ import annotations

import json

import pytest

import nau_py
from tests.conftest import Folder

VERT = "#version 330\nin vec4 position;\nvoid main() { gl_Position = position; }\n"
FRAG = """\
#version 330
uniform float tint;
uniform uint frame;
out vec4 c;
void main() { c = vec4(tint, float(frame) / 255.0, 0, 1); }
"""
MATERIAL = """\
<material name="{name}"><shader name="s"><values>
<valueof uniform="tint" type="RENDERER" context="CURRENT" component="{name}"/>
<valueof uniform="frame" type="RENDERER" context="CURRENT" component="FRAME_COUNT"/>
</values></shader></material>
"""
PASS = '<pass name="draw" class="quad"><material name="{name}" fromLibrary="L"/></pass>'


@pytest.fixture
def project(folder: Folder) -> nau_py.Project:
    """Pipeline A draws 0.2 twice, B 0.4 until its test says no, C 0.6 three times."""
    folder.write("a.vert", VERT)
    folder.write("a.frag", FRAG)
    made = "".join(MATERIAL.format(name=n) for n in ("one", "two", "three"))
    folder.write(
        "l.mlib",
        '<materialLib name="L"><shaders><shader name="s" vs="a.vert" ps="a.frag"/></shaders>'
        f"<materials>{made}</materials></materialLib>",
    )
    folder.write(
        "project.xml",
        '<project name="P" width="4" height="4"><assets><attributes>'
        '<attribute name="one" data="FLOAT" value="0.2" type="RENDERER"/>'
        '<attribute name="two" data="FLOAT" value="0.4" type="RENDERER"/>'
        '<attribute name="three" data="FLOAT" value="0.6" type="RENDERER"/></attributes>'
        '<materialLibs><materialLib filename="l.mlib"/></materialLibs></assets>'
        '<pipelines mode="RUN_ALL">'
        f'<pipeline name="A" frameCount="2">{PASS.format(name="one")}</pipeline>'
        f'<pipeline name="B" frameCount="1">{PASS.format(name="two")}</pipeline>'
        f'<pipeline name="C" frameCount="3">{PASS.format(name="three")}</pipeline>'
        "</pipelines></project>",
    )
    return folder.load()


def seen(renderer: nau_py.Renderer, index: int) -> tuple[int, int]:
    red, green = renderer.render(index).image[0, 0, :2]
    return int(red), int(green)


def test_each_pipeline_has_its_frames(project: nau_py.Project) -> None:
    """Passes of one name in three pipelines; frames are counted from 0 in each."""
    renderer = nau_py.Renderer(project)
    expected = [(51, 0), (51, 1), (102, 0), (153, 0), (153, 1), (153, 2)]
    for _ in range(2):  # going back begins with the first pipeline again
        assert [seen(renderer, k) for k in range(6)] == expected
    assert renderer.ended
    report = renderer.render(6).report
    assert report["frames"][0]["pipeline"] == "C"
    assert report["frames"][0]["passes"][0]["status"] == "left_out"
    assert report["ended"] == "pipeline 'C' has ended: it has drawn its 3 frames"


def test_a_named_pipeline_is_alone(project: nau_py.Project) -> None:
    renderer = nau_py.Renderer(project, "A")
    assert seen(renderer, 4) == (51, 4)
    assert not renderer.ended


def test_nau_run_stops_where_the_run_ends(project: nau_py.Project, folder: Folder) -> None:
    from typer.testing import CliRunner

    from nau_py.cli.run import app

    arguments = ["project.xml", "--frames", "0:20", "--report", "r.json", "-o", "p.png"]
    names = [str(folder.path / a) if "." in a else a for a in arguments]
    result = CliRunner().invoke(app, names)
    assert result.exit_code == 0, result.output
    assert "no frame after 5: pipeline 'C' has ended" in " ".join(result.output.split())
    report = json.loads((folder.path / "r.json").read_text())
    assert [f["pipeline"] for f in report["frames"]] == ["A", "A", "B", "C", "C", "C"]
    assert (folder.path / "p.png").is_file()


def test_scripts_end_a_pipeline_too(project: nau_py.Project, folder: Folder) -> None:
    """In any mode; the frame whose test says no is not drawn, and postScript runs once."""
    pytest.importorskip("lupa")
    text = (folder.path / "project.xml").read_text().replace(' mode="RUN_ALL"', "")
    hooks = '<testScript file="a.lua" script="go"/><postScript file="a.lua" script="done"/>'
    text = text.replace('<pipeline name="A" frameCount="2">', f'<pipeline name="A">{hooks}')
    folder.write("project.xml", text)
    folder.write(
        "a.lua",
        """
        times = 0
        function go() times = times + 1; return times < 3 end
        function done()
            local t = {}
            getAttr("RENDERER", "CURRENT", "two", 0, t)
            setAttr("RENDERER", "CURRENT", "two", 0, {t[1] * 2})
        end
        """,
    )
    renderer = nau_py.Renderer(folder.load())
    expected = [(51, 0), (51, 1), (51, 1), (204, 0), (204, 1)]
    assert [seen(renderer, k) for k in range(5)] == expected

"""Draw commands of a buffer: docs/format.md, 4.3 and 11.6; OpenGL 4.6, section 10.4."""

from __future__ import annotations

import numpy as np
import pytest

import nau_py
from tests.conftest import Folder

VERT = """\
#version 330
in vec4 position;
void main() {
    vec2 corner = sign(position.xz) * 0.5 + 0.5;
    gl_Position = vec4((corner.x + gl_InstanceID) * 0.5 - 1.0, corner.y * 2.0 - 1.0, 0.0, 1.0);
}
"""
FRAG = "#version 330\nout vec4 c;\nvoid main() { c = vec4(1.0); }\n"
PROJECT = """\
<project name="P" width="8" height="4"><assets>
<scenes><scene name="S"><geometry name="g" type="SQUARE"/></scene></scenes>
<viewports><viewport name="V"/></viewports><cameras><camera name="C"><viewport name="V"/></camera></cameras>
<materialLibs><materialLib filename="l.mlib"/></materialLibs></assets>
<pipelines><pipeline name="Q"><pass name="p"><scenes drawIndirectBuffer="L::commands">
<scene name="S"/></scenes><camera name="C"/><materialMaps><map fromMaterial="*" toLibrary="L" toMaterial="m"/>
</materialMaps></pass></pipeline></pipelines></project>
"""
LIB = """\
<materialLib name="L"><buffers><buffer name="commands"><SIZE value="{size}"/>
<structure><field value="UINT"/></structure><file name="commands.txt"/></buffer></buffers>
<states><state name="s"><CULL_FACE value="false"/></state></states>
<shaders><shader name="s" vs="a.vert" ps="a.frag"/></shaders>
<materials><material name="m"><shader name="s"/><state name="s"/></material></materials></materialLib>
"""


@pytest.fixture
def project(folder: Folder) -> Folder:
    folder.write("a.vert", VERT)
    folder.write("a.frag", FRAG)
    folder.write("l.mlib", LIB.format(size=20))
    folder.write("project.xml", PROJECT)
    return folder


@pytest.mark.parametrize("instances", [0, 1, 3])
def test_the_buffer_says_how_many_instances(project: Folder, instances: int) -> None:
    """Each is a column of two pixels; the engine writes the count of indices, two triangles."""
    project.write("commands.txt", f"0 {instances} 0 0 0")
    renderer = nau_py.Renderer(project.load())
    image = renderer.render().image
    drawn = image[..., 0] == 255
    np.testing.assert_array_equal(drawn, np.tile(np.arange(8) < 2 * instances, (4, 1)))
    raw = renderer.session.resources.buffer("L::commands").read()
    assert np.frombuffer(raw, "<u4").tolist() == [6, instances, 0, 0, 0]


def test_first_index_leaves_indices_out(project: Folder) -> None:
    """From the fourth of six: one of the two triangles that are left, half of a column."""
    project.write("commands.txt", "0 4 3 0 0")
    drawn = nau_py.Renderer(project.load()).render().image[..., 0] == 255
    assert 8 <= np.count_nonzero(drawn) <= 24


def test_a_short_buffer_is_named(project: Folder) -> None:
    project.write("commands.txt", "0 1")
    project.write("l.mlib", LIB.format(size=8))
    with pytest.raises(nau_py.NauError, match=r"pass 'p': buffer 'L::commands' holds 8 bytes; a"):
        nau_py.Renderer(project.load()).render()

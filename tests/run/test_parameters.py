"""The variables of a project's interface can be set from outside."""

from __future__ import annotations

import pytest

import nau_py
from nau_py.run.parameters import parameters
from tests.conftest import Folder

PROJECT = """\
<project name="P" width="8" height="8"><assets>
 <attributes><attribute type="RENDERER" name="shade" data="FLOAT" value="0.25"/></attributes>
 <viewports><viewport name="V"><CLEAR_COLOR r="0" g="0" b="0"/></viewport></viewports>
 <materialLibs><materialLib filename="lib.mlib"/></materialLibs></assets>
<pipelines><pipeline name="Q"><pass name="draw" class="quad"><viewport name="V"/>
 <material name="grey" fromLibrary="L"/></pass></pipeline></pipelines>
<interface><window label="One">
 <var label="Shade" type="RENDERER" context="CURRENT" component="shade"/>
 <var label="Back" type="VIEWPORT" context="V" component="CLEAR_COLOR"/>
 <var label="Twice" type="PASS" context="Q#draw" component="INSTANCE_COUNT"/></window>
 <window label="Two"><var label="Twice" type="PASS" context="Q#none" component="RAYS_PER_PIXEL"/>
</window></interface></project>
"""
LIBRARY = """\
<materialLib name="L"><shaders><shader name="grey" vs="q.vert" ps="q.frag"/></shaders>
<materials><material name="grey"><shader name="grey"><values>
<valueof uniform="shade" type="RENDERER" context="CURRENT" component="shade"/>
</values></shader></material></materials></materialLib>
"""


@pytest.fixture
def project(folder: Folder) -> nau_py.Project:
    folder.write(
        "q.vert", "#version 330\nin vec4 position;\nvoid main() { gl_Position = position; }\n"
    )
    folder.write(
        "q.frag",
        "#version 330\nuniform float shade;\nout vec4 c;\nvoid main() { c = vec4(shade); }\n",
    )
    folder.write("lib.mlib", LIBRARY)
    folder.write("project.xml", PROJECT)
    return folder.load()


def test_names_are_labels_and_windows_tell_equal_ones_apart(project: nau_py.Project) -> None:
    assert [p.name for p in parameters(project)] == ["Shade", "Back", "One/Twice", "Two/Twice"]


def test_a_parameter_changes_the_picture_and_nothing_else(project: nau_py.Project) -> None:
    half = nau_py.Renderer(project, parameters={"Shade": "0.5"})
    for frame in (0, 1, 0):
        assert (half.render(frame).image[..., 0] == 128).all()
    assert (nau_py.Renderer(project).render().image[..., 0] == 64).all()


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("Shde", "1", "no parameter 'Shde'.*did you mean 'Shade'"),
        ("Shade", "dark", "'Shade' is 'dark'; 1 number expected"),
        ("Back", "1 0", "'Back' is '1 0'; 4 numbers expected"),
        ("One/Twice", "1.5", "'One/Twice' is '1.5'; 1 whole number expected"),
        ("Two/Twice", "0", "'Two/Twice' is 0; legal is 1 and more"),
        ("Two/Twice", "2", "cannot be set: there is no pass 'Q#none'"),
    ],
)
def test_wrong_parameters(project: nau_py.Project, name: str, value: str, said: str) -> None:
    with pytest.raises(nau_py.ProjectError, match=f"(?s)R020.*{said}"):
        nau_py.Renderer(project, parameters={name: value}).render()

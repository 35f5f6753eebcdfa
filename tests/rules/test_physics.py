"""rules.unsupported, model.physics: libraries are checked, not simulated (docs/format.md, 5)."""

from __future__ import annotations

import pytest

import nau_py
from tests.conftest import Folder

PROJECT = """\
<project name="P"><assets><physicsLibs><physicsLib filename="a.plib"/></physicsLibs></assets>
<pipelines><pipeline name="Q"><pass name="p" class="quad"/></pipeline></pipelines></project>
"""
LIBRARY = """\
<physicslib name="p">
<globalProperties><GRAVITY x="0" y="-9.81" z="0"/></globalProperties>
<materials>
<material name="ball" type="RIGID" shape="SPHERE"><MASS value="0.17"/><INERTIA x="1" y="1" z="1" w="1"/></material>
<material name="floor" type="STATIC"><SCENE_CONDITION value="LT"/><BUFFER name="L::b"/></material>
</materials></physicslib>
"""


def findings(folder: Folder, library: str) -> list[str]:
    folder.write("project.xml", PROJECT)
    folder.write("a.plib", library)
    found = nau_py.lint(folder.load())
    return [f"{d.rule} {d.severity}: {d.message}" for d in found]


def test_a_sound_library_is_one_warning(folder: Folder) -> None:
    found = findings(folder, LIBRARY)
    assert found == ["L002 warning: physics library 'a.plib' is checked, not simulated"]


@pytest.mark.parametrize(
    "old, new, expected",
    [
        ('name="ball" ', "", "S004 error: <material> needs the attribute 'name'"),
        ("STATIC", "STATICAL", "V005 error: attribute 'type' of <material> is 'STATICAL'"),
        ("SPHERE", "BALL", "V005 error: attribute 'shape' of <material> is 'BALL'"),
        ("<MASS", "<MAS", "S001 error: element <MAS> of <material> is unknown"),
        ('x="0" y="-9.81"', 'x="0"', "V003 error: <GRAVITY> is a VEC4 and lacks 'y or g'"),
        ('"floor"', '"ball"', "N001 error: physics material 'ball' is defined a second time"),
        ('"0.17"', '"heavy"', "V007 error: <MASS> of <material> is 'heavy'"),
        ("</materials>", "", "X002 error"),
    ],
)
def test_faults_are_found(folder: Folder, old: str, new: str, expected: str) -> None:
    found = findings(folder, LIBRARY.replace(old, new, 1))
    assert any(line.startswith(expected) for line in found), "\n".join(found)


def test_buffers_of_particles_are_there(folder: Folder) -> None:
    """The engine's physics makes them: MAX_PARTICLES positions, of which none has moved yet."""
    vertex = "#version 330\nin vec4 position;\nvoid main() { gl_Position = position; }\n"
    folder.write("a.vert", vertex)
    folder.write(
        "a.frag",
        "#version 430\nlayout(std430, binding = 1) buffer B { vec4 at[]; };\nout vec4 c;\n"
        "void main() { c = at[6] + vec4(at.length() / 255.0); }\n",
    )
    folder.write(
        "l.mlib",
        '<materialLib name="L"><shaders><shader name="s" vs="a.vert" ps="a.frag"/></shaders>'
        '<materials><material name="m"><buffers><buffer name="made::p"><TYPE value="SHADER_STORAGE"'
        '/><BINDING_POINT value="1"/></buffer></buffers><shader name="s"/></material></materials>'
        "</materialLib>",
    )
    folder.write(
        "a.plib",
        '<physicslib name="p"><materials><material name="w" type="PARTICLES"><MAX_PARTICLES '
        'value="7"/><BUFFER name="made::p"/></material></materials></physicslib>',
    )
    folder.write(
        "project.xml",
        '<project name="P" width="2" height="2"><assets><physicsLibs><physicsLib filename="a.plib"/>'
        '</physicsLibs><materialLibs><materialLib filename="l.mlib"/></materialLibs></assets>'
        '<pipelines><pipeline name="Q"><pass name="p" class="quad"><material name="m" '
        'fromLibrary="L"/></pass></pipeline></pipelines></project>',
    )
    image = nau_py.Renderer(folder.load()).render().image
    assert image[0, 0].tolist() == [7, 7, 7, 7]

"""Values of buffers, arrays, targets, states, scenes and process items: docs/format.md, 8.2 and 9.

The numbers follow from what the project below writes; OpenGL's from its specification.
"""

from __future__ import annotations

import numpy as np
import pytest

import nau_py
from tests.conftest import Folder

VERT = "#version 330\nin vec4 position;\nvoid main() { gl_Position = position; }\n"
PROJECT = """\
<project name="P" width="8" height="6"><assets>
<scenes><scene name="S"><SCALE x="2" y="2" z="4"/><TRANSLATE x="1" y="2" z="3"/>
<geometry name="g" type="BOX"><TRANSLATE x="5" y="6" z="7"/></geometry></scene></scenes>
<materialLibs><materialLib filename="l.mlib"/></materialLibs></assets>
<pipelines><pipeline name="Q"><pass name="q" class="quad">
<material name="m" fromLibrary="L"/><renderTarget name="rt" fromLibrary="L"/>
<preProcess><texture name="plain" fromLibrary="L" CLEAR_LEVEL="3"/></preProcess>
<postProcess><buffer name="b" fromLibrary="L" CLEAR="true"/></postProcess>
</pass></pipeline></pipelines></project>
"""
LIB = """\
<materialLib name="L">
<textures><texture name="plain"><WIDTH value="4"/><HEIGHT value="2"/></texture></textures>
<arraysOfTextures><arrayOfTextures name="many"><WIDTH value="16"/><HEIGHT value="8"/>
<TEXTURE_COUNT value="3"/><INTERNAL_FORMAT value="RGBA"/></arrayOfTextures></arraysOfTextures>
<renderTargets><renderTarget name="rt"><SIZE width="8" height="6"/><LEVELS value="2"/>
<CLEAR_VALUES r="0.25" g="0.5" b="0.75" a="1"/><colors><color name="c" internalFormat="RGBA32F"/>
</colors></renderTarget></renderTargets>
<buffers><buffer name="b"><DIM x="2" y="3" z="4"/><structure><field value="VEC4"/>
<field value="UINT"/></structure></buffer></buffers>
<states><state name="glass"><BLEND value="true"/><BLEND_SRC value="SRC_ALPHA"/>
<DEPTH_FUNC value="NOT_EQUAL"/><BLEND_COLOR r="0.5" g="0" b="1" a="0"/></state></states>
<shaders><shader name="s" vs="a.vert" ps="a.frag"/></shaders>
<materials><material name="m"><textures><texture name="plain" UNIT="2"/></textures>
<buffers><buffer name="b"><TYPE value="SHADER_STORAGE"/><BINDING_POINT value="3"/></buffer></buffers>
<shader name="s"><values><valueof uniform="u" {source}/></values></shader></material></materials>
</materialLib>
"""
GL_SRC_ALPHA, GL_NOTEQUAL, GL_LESS = 0x0302, 0x0205, 0x0201  # OpenGL 4.6, tables 14.1 and 17.2


@pytest.mark.parametrize(
    "type_, context, component, expected",
    [
        ("BUFFER", "L::b", "SIZE", [2 * 3 * 4 * 20]),
        ("BUFFER", "L::b", "STRUCT_SIZE", [20]),
        ("BUFFER", "L::b", "DIM", [2, 3, 4]),
        ("BUFFER_MATERIAL", "CURRENT", "SIZE", [480]),
        ("BUFFER_BINDING", "L::m", "BINDING_POINT", [3]),
        ("ARRAY_OF_TEXTURES", "L::many", "WIDTH", [16]),
        ("ARRAY_OF_TEXTURES", "L::many", "TEXTURE_COUNT", [3]),
        ("TEXTURE", "L::plain", "HEIGHT", [2]),
        ("TEXTURE_MATERIAL", "L::m", "WIDTH", [4]),
        ("RENDER_TARGET", "CURRENT", "SIZE", [8, 6]),
        ("RENDER_TARGET", "L::rt", "CLEAR_VALUES", [0.25, 0.5, 0.75, 1]),
        ("RENDER_TARGET", "L::rt", "LEVELS", [2]),
        ("STATE", "L::glass", "BLEND_SRC", [GL_SRC_ALPHA]),
        ("STATE", "L::glass", "DEPTH_FUNC", [GL_NOTEQUAL]),
        ("STATE", "L::glass", "BLEND_COLOR", [0.5, 0, 1, 0]),
        ("STATE", "CURRENT", "DEPTH_FUNC", [GL_LESS]),
        ("SCENE", "S", "SCALE", [2, 2, 4]),
        ("SCENE", "S", "TRIANGLE_COUNT", [12]),
        ("SCENE", "S", "BB_CENTER", [1 + 2 * 5, 2 + 2 * 6, 3 + 4 * 7]),
        ("SCENE", "S", "BB_MAX", [1 + 2 * 6, 2 + 2 * 7, 3 + 4 * 8]),
        ("SCENE_OBJECT", "S::g", "TRANSLATE", [5, 6, 7, 0]),
        ("PASS_PRE_PROCESS_TEXTURE", "q", "CLEAR_LEVEL", [3]),
        ("PASS_POST_PROCESS_BUFFER", "q", "CLEAR", [1]),
    ],
)
def test_values_of_objects(
    folder: Folder, type_: str, context: str, component: str, expected: list[float]
) -> None:
    index = {"BUFFER_MATERIAL": 3, "BUFFER_BINDING": 3, "TEXTURE_MATERIAL": 2}.get(type_, 0)
    source = f'type="{type_}" context="{context}" component="{component}" id="{index}"'
    kind = ("float", "vec2", "vec3", "vec4")[len(expected) - 1]
    padded = ", ".join(["vec4(u", *["0"] * (4 - len(expected))]) + ")"
    folder.write("a.vert", VERT)
    folder.write(
        "a.frag",
        f"#version 330\nuniform {kind} u;\nout vec4 c;\nvoid main() {{ c = {padded}; }}\n",
    )
    folder.write("l.mlib", LIB.format(source=source))
    folder.write("project.xml", PROJECT)
    target = nau_py.Renderer(folder.load(), keep_targets=True).render().targets["L::c"]
    np.testing.assert_allclose(target[2, 2, : len(expected)], expected)
    assert not [d for d in nau_py.lint(folder.load()) if d.rule == "L007"]


def test_names_of_gpu_objects(folder: Folder) -> None:
    """ID is what OpenGL calls the buffer."""
    folder.write("a.vert", VERT)
    frag = "#version 330\nuniform float u;\nout vec4 c;\nvoid main() { c = vec4(u); }\n"
    folder.write("a.frag", frag)
    folder.write("project.xml", PROJECT)
    folder.write("l.mlib", LIB.format(source='type="BUFFER" context="L::b" component="ID"'))
    renderer = nau_py.Renderer(folder.load(), keep_targets=True)
    found = renderer.render().targets["L::c"][0, 0, 0]
    assert found == renderer.session.resources.buffer("L::b").glo

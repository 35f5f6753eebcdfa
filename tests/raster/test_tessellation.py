"""Tessellation stages on patches: docs/format.md, 10.6 and 11.6."""

from __future__ import annotations

import numpy as np

import nau_py
from tests.conftest import Folder

PROJECT = """\
<project name="P" width="16" height="16"><assets>
<scenes><scene name="S"><file name="a.patch"/></scene></scenes>
<viewports><viewport name="V"/></viewports><cameras><camera name="C"><viewport name="V"/></camera></cameras>
<materialLibs><materialLib filename="l.mlib"/></materialLibs></assets>
<pipelines><pipeline name="Q"><pass name="p"><scenes><scene name="S"/></scenes><camera name="C"/>
<renderTarget name="rt" fromLibrary="L"/><materialMaps>
<map fromMaterial="*" toLibrary="L" toMaterial="m"/></materialMaps></pass></pipeline></pipelines></project>
"""
LIB = """\
<materialLib name="L"><renderTargets><renderTarget name="rt"><SIZE width="16" height="16"/><colors>
<color name="c" internalFormat="RGBA32F"/></colors></renderTarget></renderTargets>
<states><state name="all"><CULL_FACE value="false"/></state></states>
<shaders><shader name="s" vs="a.vert" tc="a.tesc" te="a.tese" ps="a.frag"/></shaders>
<materials><material name="m"><shader name="s"/><state name="all"/></material></materials></materialLib>
"""
VERT = "#version 400\nin vec4 position;\nvoid main() { gl_Position = position; }\n"
CONTROL = """\
#version 400
layout(vertices = 4) out;
void main() {
    gl_out[gl_InvocationID].gl_Position = gl_in[gl_InvocationID].gl_Position;
    gl_TessLevelOuter = float[](8, 8, 8, 8);
    gl_TessLevelInner = float[](8, 8);
}
"""
EVALUATION = """\
#version 400
layout(quads, equal_spacing) in;
out vec3 at;
void main() {
    float u = gl_TessCoord.x, v = gl_TessCoord.y;
    vec4 low = mix(gl_in[0].gl_Position, gl_in[1].gl_Position, u);
    vec4 high = mix(gl_in[2].gl_Position, gl_in[3].gl_Position, u);
    gl_Position = vec4(mix(low, high, v).xy, 0, 1);
    at = vec3(u, v, mix(low, high, v).z);
}
"""
FRAG = "#version 400\nin vec3 at;\nout vec4 c;\nvoid main() { c = vec4(at, 1); }\n"


def test_a_patch_of_four_points(folder: Folder) -> None:
    """The square -1..1 with heights 0, 1, 2, 5: u and v run with x and y; the height is the
    bilinear u + 2 v + 2 u v, exact at the grid's points and within 2 / (4 * 64) between them."""
    folder.write("a.patch", "4 1 n 4\n-1 -1 0\n1 -1 1\n-1 1 2\n1 1 5\n")
    folder.write("a.vert", VERT)
    folder.write("a.tesc", CONTROL)
    folder.write("a.tese", EVALUATION)
    folder.write("a.frag", FRAG)
    folder.write("l.mlib", LIB)
    folder.write("project.xml", PROJECT)
    seen = nau_py.Renderer(folder.load(), keep_targets=True).render().targets["L::c"]
    u = np.tile((np.arange(16) + 0.5) / 16, (16, 1))
    v = u.T[::-1]
    np.testing.assert_allclose(seen[..., 0], u, atol=1e-5)
    np.testing.assert_allclose(seen[..., 1], v, atol=1e-5)
    np.testing.assert_allclose(seen[..., 2], u + 2 * v + 2 * u * v, atol=2 / 256 + 1e-5)

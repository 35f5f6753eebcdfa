"""Multisampled targets and cube maps to draw into: docs/format.md, 6.1; OpenGL 4.6, 9.4 and 14.3."""

from __future__ import annotations

import numpy as np
import pytest

import nau_py
from tests.conftest import Folder

PROJECT = """\
<project name="P" width="8" height="8"><assets>
<scenes><scene name="S"><geometry name="g" type="SQUARE"/></scene></scenes>
<viewports><viewport name="V"/></viewports><cameras><camera name="C"><viewport name="V"/></camera></cameras>
<materialLibs><materialLib filename="l.mlib"/></materialLibs></assets>
<pipelines><pipeline name="Q"><pass name="first" class="{kind}">{draws}
<renderTarget name="rt" fromLibrary="L"/></pass><pass name="second" class="quad">
<material name="look" fromLibrary="L"/><renderTarget name="seen" fromLibrary="L"/></pass></pipeline>
</pipelines></project>
"""
LIB = """\
<materialLib name="L"><renderTargets><renderTarget name="rt"><SIZE width="8" height="8"/>{extra}
<colors>{colors}</colors></renderTarget><renderTarget name="seen"><SIZE width="8" height="8"/><colors>
<color name="c" internalFormat="RGBA32F"/></colors></renderTarget></renderTargets>
<states><state name="all"><CULL_FACE value="false"/><DEPTH_TEST value="false"/></state></states>
<shaders><shader name="draw" vs="a.vert" {stages} ps="a.frag"/><shader name="look" vs="plain.vert" ps="b.frag"/></shaders>
<materials><material name="draw"><shader name="draw"/><state name="all"/></material><material name="look">
<textures><texture name="t" UNIT="0"/></textures><shader name="look"><values><valueof uniform="image"
type="TEXTURE_BINDING" context="CURRENT" component="UNIT" id="0"/></values></shader></material></materials>
</materialLib>
"""
PLAIN = "#version 330\nin vec4 position;\nvoid main() { gl_Position = position; }\n"
HALF_PLANE = "#version 330\nin vec4 position;\nout vec2 at;\nvoid main() {\n"
HALF_PLANE += "  gl_Position = position; gl_Position.x = position.x * 0.75 - 0.65625; }\n"
WHITE = "#version 330\nout vec4 c;\nvoid main() { c = vec4(1); }\n"


def make(folder: Folder, size: int) -> None:
    samples = f'<SAMPLES value="{size}"/>' if size else ""
    folder.write(
        "l.mlib",
        LIB.format(extra=samples, stages="", colors='<color name="t" internalFormat="RGBA32F"/>'),
    )
    material = '<material name="draw" fromLibrary="L"/>'
    folder.write("project.xml", PROJECT.format(kind="quad", draws=material))
    folder.write("a.vert", HALF_PLANE)
    folder.write("plain.vert", PLAIN)
    folder.write("a.frag", WHITE)


def test_edges_are_covered_in_part(folder: Folder) -> None:
    """A rectangle that ends at x = 0.375 of a pixel: with 4 samples, their mean; with 1, all or
    nothing. Samples are read one by one by the shader and resolved by the reader: both agree."""
    make(folder, 4)
    folder.write(
        "b.frag",
        "#version 400\nuniform sampler2DMS image;\nout vec4 c;\nvoid main() {\n"
        "  c = vec4(0); for (int k = 0; k < 4; ++k)\n"
        "    c += texelFetch(image, ivec2(gl_FragCoord.xy), k) / 4.0; }\n",
    )
    targets = nau_py.Renderer(folder.load(), keep_targets=True).render().targets
    np.testing.assert_array_equal(targets["L::t"], targets["L::c"])
    row = targets["L::t"][3, :, 0]
    edge = 8 * (1 + 0.75 - 0.65625) / 2  # pixels
    assert row[: int(edge)].tolist() == [1] * int(edge)
    assert abs(row[int(edge)] - edge % 1) <= 0.25  # of four samples
    assert 0 < row[int(edge)] < 1
    assert row[int(edge) + 1 :].tolist() == [0] * (7 - int(edge))


def test_too_many_samples_are_named(folder: Folder) -> None:
    make(folder, 1000)
    folder.write("b.frag", WHITE.replace("out vec4", "uniform sampler2DMS image;\nout vec4"))
    with pytest.raises(nau_py.ProjectError, match=r"'rt' has 1000 SAMPLES; this driver allows 0"):
        nau_py.Renderer(folder.load(), keep_targets=True).render()


FACES = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
"""Directions of the layers 0 to 5: OpenGL 4.6, table 9.3."""


@pytest.mark.parametrize("face", range(6))
def test_each_face_of_a_cube_map_is_a_layer(folder: Folder, face: int) -> None:
    """A geometry shader draws layer k in grey k / 10; a direction finds its face."""
    folder.write("a.vert", "#version 400\nvoid main() { gl_Position = vec4(0); }\n")
    folder.write(
        "a.geom",
        "#version 400\nlayout(triangles) in;\nlayout(triangle_strip, max_vertices = 18) out;\n"
        "flat out int layer;\nvoid main() { for (int k = 0; k < 6; ++k) {\n"
        "  for (int v = 0; v < 3; ++v) { gl_Layer = k; layer = k;\n"
        "    gl_Position = vec4(v == 1 ? 3 : -1, v == 2 ? 3 : -1, 0, 1); EmitVertex(); }\n"
        "  EndPrimitive(); } }\n",
    )
    folder.write(
        "a.frag",
        "#version 400\nflat in int layer;\nout vec4 c;\nvoid main() { c = vec4(layer / 10.0); }\n",
    )
    folder.write("plain.vert", PLAIN)
    x, y, z = FACES[face]
    folder.write(
        "b.frag",
        "#version 400\nuniform samplerCube image;\nout vec4 c;\n"
        f"void main() {{ c = texture(image, vec3({x}, {y}, {z})); }}\n",
    )
    cube = '<cubemap name="t" internalFormat="RGBA32F"/>'
    folder.write("l.mlib", LIB.format(extra="", stages='gs="a.geom"', colors=cube))
    draws = (
        '<scenes><scene name="S"/></scenes><camera name="C"/><materialMaps>'
        '<map fromMaterial="*" toLibrary="L" toMaterial="draw"/></materialMaps>'
    )
    folder.write("project.xml", PROJECT.format(kind="default", draws=draws))
    seen = nau_py.Renderer(folder.load(), keep_targets=True).render().targets["L::c"]
    np.testing.assert_allclose(seen, face / 10, rtol=1e-6)

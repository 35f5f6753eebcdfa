"""Rasterisation through projects: clears, targets of several formats, states, uniforms, errors."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import nau_py
from tests.conftest import Folder

VERT = "#version 330\nin vec4 position;\nvoid main() { gl_Position = position; }\n"
PROJECT = """\
<project name="P" width="{w}" height="{h}"><assets>
<viewports><viewport name="V"><CLEAR_COLOR r="0.2" g="0.4" b="0.6" a="1"/>{viewport}</viewport></viewports>
<scenes><scene name="S"><geometry name="g" type="SQUARE"><ROTATE x="1" y="0" z="0" w="90"/></geometry>
</scene></scenes>
<cameras><camera name="C"><viewport name="V"/><POSITION x="0" y="0" z="3"/></camera></cameras>
<lights><light name="Sun"><DIRECTION x="0" y="0" z="-2"/></light></lights>
<materialLibs><materialLib filename="l.mlib"/></materialLibs></assets>
<pipelines><pipeline name="Q">{passes}</pipeline></pipelines></project>
"""
QUAD = '<pass name="q" class="quad">{}<material name="m" fromLibrary="L"/></pass>'
LIB = """\
<materialLib name="L">
<renderTargets>{targets}</renderTargets>
<states>{states}</states>
<shaders><shader name="s" vs="a.vert" ps="a.frag"/></shaders>
<materials><material name="m">{color}<shader name="s"><values>{values}</values></shader></material></materials>
</materialLib>
"""


def render(
    folder: Folder,
    frag: str,
    passes: str = QUAD.format('<viewport name="V"/>'),
    *,
    vert: str = VERT,
    targets: str = "",
    values: str = "",
    states: str = "",
    color: str = "",
    viewport: str = "",
    size: tuple[int, int] = (8, 6),
    keep: bool = False,
) -> nau_py.Frame:
    folder.write("a.vert", vert)
    folder.write("a.frag", frag)
    folder.write("l.mlib", LIB.format(targets=targets, values=values, states=states, color=color))
    folder.write(
        "project.xml", PROJECT.format(w=size[0], h=size[1], passes=passes, viewport=viewport)
    )
    return nau_py.Renderer(folder.load(), keep_targets=keep).render()


def test_clear_colour_and_scissor(folder: Folder) -> None:
    """A viewport of the left half: only that half is cleared (docs/format.md, 11.4)."""
    passes = '<pass name="p"><viewport name="V"/></pass>'
    frame = render(
        folder,
        "#version 330\nvoid main() {}\n",
        passes,
        viewport='<ORIGIN x="0" y="0"/><SIZE width="0.5" height="1"/>',
    )
    np.testing.assert_array_equal(frame.image[:, :4], np.full((6, 4, 4), (51, 102, 153, 255)))
    np.testing.assert_array_equal(frame.image[:, 4:], 0)


def test_rows_run_from_the_top(folder: Folder) -> None:
    frag = "#version 330\nout vec4 c;\nvoid main() { c = vec4(floor(gl_FragCoord.y) / 255.0); }\n"
    image = render(folder, frag).image
    assert image[:, 0, 0].tolist() == [5, 4, 3, 2, 1, 0]


FORMATS = [
    ("R8", np.uint8, 1, 128),
    ("RG16F", np.float16, 2, 0.5),
    ("RGBA", np.uint8, 4, 128),
    ("RGBA16", np.uint16, 4, 32768),
    ("RGBA32F", np.float32, 4, 0.5),
    ("R32F", np.float32, 1, 0.5),
    ("RG8", np.uint8, 2, 128),
]


def test_several_colour_targets_of_different_formats(folder: Folder) -> None:
    colors = "".join(f'<color name="c{i}" internalFormat="{f[0]}"/>' for i, f in enumerate(FORMATS))
    targets = (
        f'<renderTarget name="rt"><SIZE width="4" height="4"/><colors>{colors}</colors>'
        '<depth name="d" internalFormat="DEPTH_COMPONENT32F"/></renderTarget>'
    )
    outs = "".join(f"layout(location={i}) out vec4 o{i};\n" for i in range(len(FORMATS)))
    sets = "".join(f"o{i} = vec4(0.5);" for i in range(len(FORMATS)))
    passes = QUAD.format('<renderTarget name="rt" fromLibrary="L"/>')
    frame = render(
        folder,
        f"#version 330\n{outs}void main() {{ {sets} }}\n",
        passes,
        targets=targets,
        keep=True,
    )
    for index, (_, dtype, channels, value) in enumerate(FORMATS):
        found = frame.targets[f"L::c{index}"]
        assert (found.dtype, found.shape) == (np.dtype(dtype), (4, 4, channels))
        np.testing.assert_array_equal(found, np.full(found.shape, value, dtype))
    np.testing.assert_array_equal(frame.targets["L::d"], 0)  # the quad lies on the near plane


def test_integer_targets_are_cleared_as_integers(folder: Folder) -> None:
    targets = (
        '<renderTarget name="rt"><SIZE width="2" height="2"/><CLEAR_VALUES r="1" g="0" b="0" '
        'a="0"/><colors><color name="i" internalFormat="R32UI"/></colors></renderTarget>'
    )
    passes = '<pass name="p"><renderTarget name="rt" fromLibrary="L"/></pass>'
    frame = render(folder, "#version 330\nvoid main() {}\n", passes, targets=targets, keep=True)
    np.testing.assert_array_equal(frame.targets["L::i"], 1)


@pytest.mark.parametrize(
    "declaration, source, expected",
    [
        ("uniform vec3 u;", 'type="LIGHT" context="Sun" component="DIRECTION"', (0, 0, -2)),
        ("uniform vec4 u;", 'type="CAMERA" context="C" component="POSITION"', (0, 0, 3)),
        ("uniform vec4 u;", 'type="COLOR" context="CURRENT" component="DIFFUSE"', (0.25, 0.5, 1)),
        ("uniform vec2 u;", 'type="VIEWPORT" context="CURRENT" component="ABSOLUTE_SIZE"', (8, 6)),
        ("uniform int u;", 'type="RENDERER" context="CURRENT" component="TEXTURE_COUNT"', (0,)),
        ("uniform float u;", 'type="RENDERER" context="CURRENT" component="TIMER"', (0,)),
        ("uniform uint u;", 'type="PASS" context="CURRENT" component="DIM_X"', (1,)),
    ],
)
def test_uniform_sources(
    folder: Folder, declaration: str, source: str, expected: tuple[float, ...]
) -> None:
    """Values reach uniforms of shorter and other types (docs/format.md, 6.8)."""
    members = {
        "vec2": "u, 0, 0",
        "vec3": "u, 0",
        "vec4": "u",
        "int": "u, 0, 0, 0",
        "uint": "u, 0, 0, 0",
        "float": "u, 0, 0, 0",
    }[declaration.split()[1]]
    targets = (
        '<renderTarget name="rt"><SIZE width="8" height="6"/><colors>'
        '<color name="c" internalFormat="RGBA32F"/></colors></renderTarget>'
    )
    frame = render(
        folder,
        f"#version 330\n{declaration}\nout vec4 c;\nvoid main() {{ c = vec4({members}); }}\n",
        QUAD.format('<renderTarget name="rt" fromLibrary="L"/>'),
        targets=targets,
        values=f'<valueof uniform="u" {source}/>',
        color='<color><DIFFUSE r="0.25" g="0.5" b="1" a="1"/></color>',
        keep=True,
    )
    np.testing.assert_allclose(frame.targets["L::c"][2, 2, : len(expected)], expected)


def test_a_uniform_may_share_its_name_with_a_vertex_attribute(folder: Folder) -> None:
    frag = "#version 330\nuniform sampler2D position;\nout vec4 c;\nvoid main() { c = vec4(1) + 0.0 * texture(position, vec2(0)); }\n"
    assert (render(folder, frag).image == 255).all()


def test_states_apply_to_materials(folder: Folder) -> None:
    """Blending half red over the clear colour, by the state named like the material."""
    states = (
        '<state name="m"><BLEND value="true"/><BLEND_SRC value="SRC_ALPHA"/>'
        '<BLEND_DST value="ONE_MINUS_SRC_ALPHA"/></state>'
    )
    frag = "#version 330\nout vec4 c;\nvoid main() { c = vec4(1, 0, 0, 0.5); }\n"
    pixel = render(folder, frag, states=states).image[3, 3]
    np.testing.assert_allclose(pixel[:3].astype(int), [153, 51, 77], atol=1)


def test_the_default_material_is_lit_as_nau_lights_it(folder: Folder) -> None:
    """diffuse · light · cos + 0.3 · diffuse: 0.8 + 0.24, clamped (docs/format.md, 8.5)."""
    passes = (
        '<pass name="p"><camera name="C"/><scenes><scene name="S"/></scenes>'
        '<lights><light name="Sun"/></lights></pass>'
    )
    image = render(folder, "#version 330\nvoid main() {}\n", passes, size=(64, 64)).image
    assert image[32, 32, :3].tolist() == [255, 255, 255]
    turned = passes.replace('<light name="Sun"/>', '<light name="Away"/>')
    text = (
        (folder.path / "project.xml")
        .read_text()
        .replace(passes, turned)
        .replace("</lights></assets>", "</lights></assets>")
        .replace(
            '<lights><light name="Sun"><DIRECTION x="0" y="0" z="-2"/></light>',
            '<lights><light name="Away"><DIRECTION x="0" y="0" z="2"/></light>',
        )
    )
    folder.write("project.xml", text)
    image = nau_py.Renderer(folder.load()).render().image
    assert image[32, 32, :3].tolist() == [61, 61, 61]  # 0.3 · 0.8 · 255


def test_glsl_errors_name_file_line_and_stage(folder: Folder) -> None:
    with pytest.raises(nau_py.NauError) as caught:
        render(folder, "\n\n#version 330\nout vec4 c;\nvoid main() { c = missing; }\n")
    (found,) = caught.value.diagnostics[:1]
    assert found.rule == "G001"
    assert found.location.file == str(folder.path / "a.frag")
    assert found.location.line == 5
    assert found.message.startswith("shader 's' of library 'L', stage ps: `missing' undeclared")


def test_a_lacking_extension_is_named(folder: Folder) -> None:
    """One finding at the directive, and not the errors that follow from it; a shader that can do
    without shows its own errors."""
    asks = "#version 330\n\n#extension GL_XX_no_such_thing : enable\n"
    with pytest.raises(nau_py.NauError) as raised:
        render(folder, asks + "thing x;\nvoid main() { whatever; }\n")
    (found,) = raised.value.diagnostics
    assert (found.rule, Path(found.location.file).name, found.location.line) == (
        "G004",
        "a.frag",
        3,
    )
    assert found.message == (
        "shader 's' of library 'L', stage ps, needs the extension GL_XX_no_such_thing, which this "
        "driver does not have"
    )
    with pytest.raises(nau_py.NauError) as raised:
        render(folder, asks + "#ifdef GL_XX_no_such_thing\n#endif\nvoid main() { whatever; }\n")
    assert {d.rule for d in raised.value.diagnostics} == {"G001"}


def test_glsl_errors_in_file_lists_name_the_right_file(folder: Folder) -> None:
    folder.write("one.frag", "#version 330\nout vec4 c;\n")
    folder.write("two.frag", "float grey() {\n  return wrong;\n}\n")
    folder.write("three.frag", "void main() { c = vec4(grey()); }\n")
    listed = "".join(f'<file name="{n}.frag"/>' for n in ("one", "two", "three"))
    folder.write("a.vert", VERT)
    folder.write(
        "l.mlib",
        LIB.format(targets="", states="", color="", values="").replace(
            '<shader name="s" vs="a.vert" ps="a.frag"/>',
            f'<shader name="s" vs="a.vert"><ps>{listed}</ps></shader>',
        ),
    )
    folder.write("project.xml", PROJECT.format(w=4, h=4, viewport="", passes=QUAD.format("")))
    with pytest.raises(nau_py.NauError) as caught:
        nau_py.Renderer(folder.load()).render()
    found = caught.value.diagnostics[0]
    assert found.location.file == str(folder.path / "two.frag")
    assert found.location.line == 2


def test_link_errors_name_the_shader(folder: Folder) -> None:
    vert = VERT.replace("void main() {", "out vec4 v;\nvoid main() { v = position;")
    frag = "#version 330\nin vec3 v;\nout vec4 c;\nvoid main() { c = vec4(v, 1); }\n"
    with pytest.raises(nau_py.NauError, match="shader 's' of library 'L' does not link"):
        render(folder, frag, vert=vert)


def test_alpha_is_tested_and_textures_are_lower_left(folder: Folder) -> None:
    """A 1 x 2 image, red above blue: v grows upwards, as in Nau."""
    folder.image("t.png", np.array([[[255, 0, 0]], [[0, 0, 255]]], np.uint8))
    folder.write("t.frag", "")
    frag = (
        "#version 330\nuniform sampler2D t;\nout vec4 c;\n"
        "void main() { c = texture(t, vec2(0.5, gl_FragCoord.y / 6.0)); }\n"
    )
    folder.write("a.vert", VERT)
    folder.write("a.frag", frag)
    library = LIB.format(
        targets="",
        states="",
        color='<textures><texture name="t" UNIT="3">'
        '<MAG_FILTER value="NEAREST"/><MIN_FILTER value="NEAREST"/></texture></textures>',
        values='<valueof uniform="t" type="TEXTURE_BINDING" context="CURRENT" '
        'component="UNIT" id="3"/>',
    )
    folder.write(
        "l.mlib",
        library.replace(
            "<states>", '<textures><texture name="t" filename="t.png"/></textures><states>'
        ),
    )
    folder.write(
        "project.xml",
        PROJECT.format(w=8, h=6, viewport="", passes=QUAD.format('<viewport name="V"/>')),
    )
    image = nau_py.Renderer(folder.load()).render().image
    assert image[0, 0].tolist() == [255, 0, 0, 255]
    assert image[-1, 0].tolist() == [0, 0, 255, 255]


def test_uniform_blocks_are_shared_by_name(folder: Folder) -> None:
    """``valueof block=``: members of every type at the driver's offsets (docs/format.md, 6.8)."""
    frag = (
        "#version 330\nlayout(std140) uniform Lights { float f; vec3 dir; mat4 m; vec4 col; };\n"
        "out vec4 c;\nvoid main() { c = vec4(dir.z, m[3][2], col.g, f); }\n"
    )
    sources = (
        ("f", "RENDERER", "CURRENT", "TEXTURE_COUNT"),
        ("dir", "LIGHT", "Sun", "DIRECTION"),
        ("m", "CAMERA", "C", "VIEW_MATRIX"),
        ("col", "COLOR", "CURRENT", "DIFFUSE"),
    )
    values = "".join(
        f'<valueof uniform="{u}" block="Lights" type="{t}" context="{x}" component="{k}"/>'
        for u, t, x, k in sources
    )
    targets = (
        '<renderTarget name="rt"><SIZE width="4" height="4"/><colors>'
        '<color name="c" internalFormat="RGBA32F"/></colors></renderTarget>'
    )
    frame = render(
        folder,
        frag,
        QUAD.format('<renderTarget name="rt" fromLibrary="L"/>'),
        targets=targets,
        values=values,
        color='<color><DIFFUSE r="0.25" g="0.5" b="1" a="1"/></color>',
        keep=True,
    )
    np.testing.assert_allclose(frame.targets["L::c"][0, 0], [-2, -3, 0.5, 0])


def test_buffers_begin_with_their_file_and_compute_reads_them(folder: Folder) -> None:
    folder.write("data.txt", "1 2.5 3\n4 5 6")
    folder.write(
        "c.comp",
        "#version 430\nlayout(local_size_x = 1) in;\n"
        "struct R { int i; float f; };\n"
        "layout(std430, binding = 2) buffer B { R r[]; };\n"
        "layout(rgba32f) uniform image2D img;\n"
        "void main() { imageStore(img, ivec2(0), vec4(r[0].i, r[0].f, r[2].i, r[3].f)); }\n",
    )
    folder.write(
        "l.mlib",
        '<materialLib name="L"><textures><texture name="t"><WIDTH value=2 /><HEIGHT value=2 />'
        '<INTERNAL_FORMAT value="RGBA32F"/></texture></textures>'
        '<shaders><shader name="s" cs="c.comp"/></shaders>'
        '<buffers><buffer name="b"><structure><field value="INT"/><field value="FLOAT"/></structure>'
        '<DIM x=4 y=1 z=1 /><file name="data.txt"/></buffer></buffers>'
        '<materials><material name="m"><imageTextures><imageTexture UNIT=0 texture="t"/>'
        '</imageTextures><buffers><buffer name="b"><TYPE value="SHADER_STORAGE"/>'
        '<BINDING_POINT value=2 /></buffer></buffers><shader name="s"><values>'
        '<valueof uniform="img" type="IMAGE_TEXTURE" context="CURRENT" component="UNIT" id="0"/>'
        "</values></shader></material></materials></materialLib>",
    )
    folder.write(
        "project.xml",
        '<project name="P" width=4 height=4><assets><materialLibs><materialLib filename="l.mlib"/>'
        '</materialLibs></assets><pipelines><pipeline name="Q"><pass name="c" class="compute">'
        '<material name="m" fromLibrary="L" dimX=1 /></pass></pipeline></pipelines></project>',
    )
    frame = nau_py.Renderer(folder.load()).render()
    # records (int, float): (1, 2.5) (3, 4) (5, 6), then zeros up to DIM
    assert frame.targets["L::t"][-1, 0].tolist() == [1, 2.5, 5, 0]


def test_a_uniform_takes_an_attribute_of_a_named_pass(folder: Folder) -> None:
    """Context ``pipeline#pass`` (docs/format.md, 8.2): the other pass's value, not the own one."""
    value = '<DEPTH_CLEAR_VALUE value="{}"/>'
    passes = QUAD.format('<viewport name="V"/>' + value.format("0.2")).replace('"q"', '"first"')
    passes += QUAD.format('<viewport name="V"/>' + value.format("0.6"))
    image = render(
        folder,
        "#version 330\nuniform float d;\nout vec4 c;\nvoid main() { c = vec4(d); }\n",
        passes,
        values='<valueof uniform="d" type="PASS" context="Q#first" component="DEPTH_CLEAR_VALUE"/>',
    ).image
    assert (image == 51).all()

"""Time of a frame outside OpenGL: the framework's own part.

``python benchmarks/frame.py`` draws a project of five passes (shadow map, shaded scene into two
targets, two filters, combination) on a small window, in steady state: as it is, and with the GL
calls of drawing replaced by functions that do nothing, so that only Python is left. It prints
milliseconds a frame (median of 200, and the middle half) and their ratio.
"""

from __future__ import annotations

import statistics
import tempfile
import time
from pathlib import Path

import nau_py

PROJECT = """\
<project name="Five passes" width="64" height="64"><assets>
 <scenes><scene name="S"><geometry name="a" type="BOX"/></scene>
  <scene name="T" type="Scene"><geometry name="b" type="SPHERE"><TRANSLATE x="2" y="0" z="0"/>
  </geometry></scene></scenes>
 <viewports><viewport name="V"/></viewports>
 <lights><light name="Sun"><DIRECTION x="-1" y="-1" z="-1"/></light></lights>
 <cameras><camera name="Eye"><viewport name="V"/><projection TYPE="PERSPECTIVE" FOV="50" NEAR="1"
  FAR="50"/><POSITION x="0" y="1" z="6"/></camera>
  <camera name="SunEye"><projection TYPE="ORTHO" LEFT="-4" RIGHT="4" BOTTOM="-4" TOP="4" NEAR="1"
  FAR="20"/><POSITION x="6" y="6" z="6"/><VIEW x="-1" y="-1" z="-1"/></camera></cameras>
 <materialLibs><materialLib filename="lib.mlib"/></materialLibs></assets>
<pipelines><pipeline name="P">
 <pass name="shadow" class="default"><camera name="SunEye"/>{scenes}
  <renderTarget name="shadow" fromLibrary="L"/>
  <materialMaps><map fromMaterial="*" toLibrary="L" toMaterial="depth"/></materialMaps></pass>
 <pass name="scene" class="default"><camera name="Eye"/>{scenes}<lights><light name="Sun"/></lights>
  <renderTarget name="shaded" fromLibrary="L"/>
  <materialMaps><map fromMaterial="*" toLibrary="L" toMaterial="lit"/></materialMaps></pass>
 <pass name="across" class="quad"><renderTarget name="one" fromLibrary="L"/>
  <material name="blurX" fromLibrary="L"/></pass>
 <pass name="down" class="quad"><renderTarget name="two" fromLibrary="L"/>
  <material name="blurY" fromLibrary="L"/></pass>
 <pass name="combine" class="quad"><viewport name="V"/><material name="sum" fromLibrary="L"/></pass>
</pipeline></pipelines></project>
"""
SCENES = '<scenes><scene name="S"/><scene name="T"/></scenes>'


def target(name: str, colours: str) -> str:
    listed = "".join(f'<color name="{c}" internalFormat="RGBA16F"/>' for c in colours.split())
    return (
        f'<renderTarget name="{name}"><SIZE width="64" height="64"/><colors>{listed}</colors>'
        f'<depth name="{name}Depth" internalFormat="DEPTH_COMPONENT32F"/></renderTarget>'
    )


def value(uniform: str, type_: str, context: str, component: str, index: int = 0) -> str:
    return (
        f'<valueof uniform="{uniform}" type="{type_}" context="{context}" '
        f'component="{component}" id="{index}"/>'
    )


def material(name: str, shader: str, values: str, textures: str = "") -> str:
    units = "".join(f'<texture name="{t}" UNIT="{k}"/>' for k, t in enumerate(textures.split()))
    return (
        f'<material name="{name}"><shader name="{shader}"><values>{values}</values></shader>'
        f"<textures>{units}</textures></material>"
    )


def library() -> str:
    units = value("a", "TEXTURE_BINDING", "CURRENT", "UNIT")
    both = units + value("b", "TEXTURE_BINDING", "CURRENT", "UNIT", 1)
    pvm = value("PVM", "RENDERER", "CURRENT", "PROJECTION_VIEW_MODEL")
    lit = (
        pvm
        + value("N", "RENDERER", "CURRENT", "NORMAL")
        + value("M", "RENDERER", "CURRENT", "MODEL")
    )
    lit += value("diffuse", "COLOR", "CURRENT", "DIFFUSE")
    lit += value("light", "LIGHT", "CURRENT", "DIRECTION")
    lit += value("S", "CAMERA", "SunEye", "TS05_PVM_MATRIX")
    lit += value("a", "TEXTURE_BINDING", "CURRENT", "UNIT")
    return (
        '<materialLib name="L"><renderTargets>'
        + target("shadow", "")
        + target("shaded", "colour normal")
        + target("one", "first")
        + target("two", "second")
        + "</renderTargets><shaders>"
        '<shader name="depth" vs="scene.vert" ps="depth.frag"/>'
        '<shader name="lit" vs="scene.vert" ps="lit.frag"/>'
        '<shader name="copy" vs="quad.vert" ps="copy.frag"/>'
        '<shader name="sum" vs="quad.vert" ps="sum.frag"/></shaders><materials>'
        + material("depth", "depth", pvm)
        + material("lit", "lit", lit, "shadowDepth")
        + material("blurX", "copy", units, "colour")
        + material("blurY", "copy", units, "first")
        + material("sum", "sum", both, "second normal")
        + "</materials></materialLib>"
    )


SHADERS = {
    "scene.vert": "#version 330\nin vec4 position, normal;\nuniform mat4 PVM, M;\nuniform mat3 N;\n"
    "out vec3 n, p;\nvoid main() { n = N * normal.xyz; p = (M * position).xyz;\n"
    "gl_Position = PVM * position; }\n",
    "quad.vert": "#version 330\nin vec4 position;\nvoid main() { gl_Position = position; }\n",
    "depth.frag": "#version 330\nvoid main() {}\n",
    "lit.frag": "#version 330\nin vec3 n, p;\nuniform vec4 diffuse, light;\nuniform mat4 S;\n"
    "uniform sampler2D a;\nlayout(location = 0) out vec4 c;\nlayout(location = 1) out vec4 d;\n"
    "void main() { float s = texture(a, (S * vec4(p, 1)).xy).r;\n"
    "c = diffuse * max(dot(normalize(n), -normalize(light.xyz)), 0.2) * s; d = vec4(n, 1); }\n",
    "copy.frag": "#version 330\nuniform sampler2D a;\nout vec4 c;\n"
    "void main() { c = texelFetch(a, ivec2(gl_FragCoord.xy), 0); }\n",
    "sum.frag": "#version 330\nuniform sampler2D a, b;\nout vec4 c;\nvoid main() {\n"
    "ivec2 p = ivec2(gl_FragCoord.xy); c = texelFetch(a, p, 0) + 0.1 * texelFetch(b, p, 0); }\n",
}
FRAMES = 200


def steps(renderer: nau_py.Renderer, first: int) -> list[float]:
    """Milliseconds of each of FRAMES frames, without reading the picture back."""
    found = []
    for index in range(first, first + FRAMES):
        start = time.perf_counter()
        renderer._draw(index)
        found.append((time.perf_counter() - start) * 1000)
    return found


def line(label: str, ms: list[float]) -> None:
    low, _, high = statistics.quantiles(ms, n=4)
    print(f"{label:24} {statistics.median(ms):6.3f} ms a frame ({low:.3f}-{high:.3f})")


def main() -> None:
    from nau_py.raster.gl import GL

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "project.xml").write_text(PROJECT.format(scenes=SCENES))
        (folder / "lib.mlib").write_text(library())
        for file, text in SHADERS.items():
            (folder / file).write_text(text)
        renderer = nau_py.Renderer(nau_py.load(folder / "project.xml"))
        frame = renderer.render(20)
        print(frame.report["machine"])
        whole = steps(renderer, 21)
        context = renderer.session.resources.device.ctx
        kept = {n: getattr(GL, n) for n in dir(GL) if n.startswith("gl") and n[2:3].isupper()}
        for entry in kept:
            setattr(GL, entry, lambda *arguments: None)
        finish = context.finish
        setattr(context, "finish", lambda: None)  # noqa: B010
        alone = steps(renderer, 21 + FRAMES)
        for entry, function in kept.items():
            setattr(GL, entry, function)
        setattr(context, "finish", finish)  # noqa: B010
    line("with OpenGL", whole)
    line("Python alone", alone)
    print(f"Python is {statistics.median(alone) / statistics.median(whole):.0%} of it")


if __name__ == "__main__":
    main()

"""``builtin:material``: a reflected thing has the colour that rasterisation gives it."""

from __future__ import annotations

import numpy as np
import pytest

import nau_py
from nau_py.model.raytrace import RaytracePass
from nau_py.raster.hits import remove_declarations
from tests.conftest import PROJECTS, ROOT, Folder
from tests.projects.test_demos import materials_seen

SIZE = 160
SHADERS = {
    # diffuse, in world space
    "world": (
        "in vec4 position; in vec4 normal; uniform mat4 PVM; uniform mat4 M; out vec3 n;\n"
        "void main() { n = mat3(M) * normal.xyz; gl_Position = PVM * position; }",
        "in vec3 n; uniform vec4 diffuse; uniform vec4 sun; out vec4 c;\n"
        "void main() { c = vec4(diffuse.rgb * max(dot(normalize(n), -sun.xyz), 0.0) + 0.1, 1.0); }",
    ),
    # Phong, in view space: two uniforms in one declaration
    "phong": (
        "in vec4 position, normal; uniform mat4 PVM, VM; uniform mat3 N; out vec3 n, e;\n"
        "void main() { n = N * normal.xyz; e = -(VM * position).xyz; gl_Position = PVM * position; }",
        "in vec3 n, e; uniform vec4 diffuse, sun; uniform mat4 V; out vec4 c;\n"
        "void main() { vec3 l = normalize((V * -sun).xyz); vec3 u = normalize(n);\n"
        "  float s = pow(max(dot(reflect(-l, u), normalize(e)), 0.0), 20.0);\n"
        "  c = vec4(diffuse.rgb * max(dot(u, l), 0.0) + s, 1.0); }",
    ),
    # rim light by the camera's position
    "rim": (
        "in vec4 position; in vec4 normal; uniform mat4 PVM; uniform mat4 M; out vec3 n; out vec3 w;\n"
        "void main() { n = mat3(M) * normal.xyz; w = (M * position).xyz; gl_Position = PVM * position; }",
        "in vec3 n; in vec3 w; uniform vec4 eye; uniform vec4 diffuse; out vec4 c;\n"
        "void main() { float f = 1.0 - abs(dot(normalize(n), normalize(eye.xyz - w)));\n"
        "  c = vec4(mix(diffuse.rgb, vec3(1.0), f * f), 1.0); }",
    ),
    # procedural pattern
    "bands": (
        "in vec4 position; uniform mat4 PVM; uniform mat4 M; out vec3 w;\n"
        "void main() { w = (M * position).xyz; gl_Position = PVM * position; }",
        "in vec3 w; uniform vec4 diffuse; out vec4 c;\n"
        "void main() { c = vec4(diffuse.rgb * (0.6 + 0.4 * sin(6.0 * w.y)), 1.0); }",
    ),
    # texture
    "textured": (
        "in vec4 position; in vec4 texCoord0; uniform mat4 PVM; out vec2 uv;\n"
        "void main() { uv = texCoord0.xy; gl_Position = PVM * position; }",
        "in vec2 uv; uniform sampler2D tex; out vec4 c;\n"
        "void main() { c = vec4(texture(tex, uv).rgb, 1.0); }",
    ),
}
SOURCES = (
    '<valueof uniform="PVM" type="RENDERER" context="CURRENT" component="PROJECTION_VIEW_MODEL" />'
    '<valueof uniform="M" type="RENDERER" context="CURRENT" component="MODEL" />'
    '<valueof uniform="V" type="RENDERER" context="CURRENT" component="VIEW" />'
    '<valueof uniform="VM" type="RENDERER" context="CURRENT" component="VIEW_MODEL" />'
    '<valueof uniform="N" type="RENDERER" context="CURRENT" component="NORMAL" />'
    '<valueof uniform="eye" type="CAMERA" context="CURRENT" component="POSITION" />'
    '<valueof uniform="sun" type="LIGHT" context="CURRENT" component="NORMALIZED_DIRECTION" id="0" />'
    '<valueof uniform="diffuse" type="COLOR" context="CURRENT" component="DIFFUSE" />'
    '<valueof uniform="tex" type="TEXTURE_BINDING" context="CURRENT" component="UNIT" id="0" />'
)
PROJECT = """\
<project name="Mirror" width="{s}" height="{s}"><assets>
  <scenes>
    <scene name="Things" type="{type}">{things}</scene>
    <scene name="Floor"><geometry name="floor" type="SQUARE" material="floor">
      <SCALE x="9" y="1" z="9" /></geometry></scene>
  </scenes>
  <lights><light name="Sun"><DIRECTION x="-0.4" y="0.5" z="-0.6" /></light></lights>
  <cameras>
    <camera name="A"><projection TYPE="PERSPECTIVE" FOV="45" NEAR="0.1" FAR="50" />
      <POSITION x="0" y="2" z="5" /><VIEW x="0" y="-2" z="-5" /><UP x="0" y="1" z="0" /></camera>
    <camera name="B"><projection TYPE="PERSPECTIVE" FOV="45" NEAR="0.1" FAR="50" />
      <POSITION x="0" y="-2" z="5" /><VIEW x="0" y="2" z="-5" /><UP x="0" y="-1" z="0" /></camera>
  </cameras>
  <materialLibs><materialLib filename="lib.mlib" /></materialLibs>
</assets><pipelines>
  <pipeline name="Traced"><pass name="trace" class="raytrace"><camera name="A" />
    <scenes><scene name="Things" /><scene name="Floor" /></scenes>
    <lights><light name="Sun" /></lights>
    <renderTarget name="rt" fromLibrary="L" /><MAX_DEPTH value="2" />
    <materialMaps>{maps}<map fromMaterial="floor" toLibrary="L" toMaterial="floor" /></materialMaps>
    <rtEntryPoint><rayGen file="builtin" proc="pinhole" /></rtEntryPoint>
    <rtDefaultMaterial><rayType name="R">
      <rtProgram type="CLOSEST_HIT" file="builtin" proc="material" /></rayType></rtDefaultMaterial>
    <rtMaterialMap><rtMap to="floor"><rayType name="R">
      <rtProgram type="CLOSEST_HIT" file="builtin" proc="mirror" /></rayType></rtMap></rtMaterialMap>
  </pass></pipeline>
  <pipeline name="Raster"><pass name="draw" class="default"><camera name="B" />
    <scenes><scene name="Things" /></scenes><lights><light name="Sun" /></lights>
    <renderTarget name="rt" fromLibrary="L" /><materialMaps>{maps}</materialMaps></pass></pipeline>
</pipelines></project>
"""


@pytest.mark.parametrize("type_", ["Scene", "OctreeUnified"])
def test_five_programs_in_a_mirror(folder: Folder, type_: str) -> None:
    """A floor mirrors five things, each with a GLSL program of its own, against the same things
    rasterised by the mirrored camera: at most 2/255 off, away from edges."""
    ramp = np.linspace(40, 220, 64, dtype=np.uint8)
    texels = np.stack([*np.meshgrid(ramp, ramp), np.full((64, 64), 90, np.uint8)], axis=-1)
    folder.image("ramp.png", texels)
    things, maps, materials, shaders = "", "", "", ""
    for k, (name, (vertex, fragment)) in enumerate(SHADERS.items()):
        folder.write(f"{name}.vert", "#version 330\n" + vertex)
        folder.write(f"{name}.frag", "#version 330\n" + fragment)
        shaders += f'<shader name="{name}" vs="{name}.vert" ps="{name}.frag" />'
        texture = '<textures><texture name="ramp" UNIT="0" /></textures>'
        materials += (
            f'<material name="{name}"><color><DIFFUSE r="0.{k + 3}" g="0.6" b="0.{8 - k}" a="1" />'
            f"</color>{texture if name == 'textured' else ''}"
            f'<shader name="{name}"><values>{SOURCES}</values></shader></material>'
        )
        detail = ' SLICES="64" STACKS="32"' if k % 2 else ""
        things += (
            f'<geometry name="{name}" type="{"SPHERE" if k % 2 else "BOX"}" material="{name}"'
            f'{detail}><ROTATE x="0" y="1" z="0" w="{20 * k + 10}" />'
            f'<SCALE x="0.3" y="0.{4 + k}" z="0.35" />'
            f'<TRANSLATE x="{-1.6 + 0.8 * k}" y="0.9" z="{0.3 * (k % 2)}" /></geometry>'
        )
        maps += f'<map fromMaterial="{name}" toLibrary="L" toMaterial="{name}" />'
    materials += (
        '<material name="floor"><color><SPECULAR r="1" g="1" b="1" a="1" /></color></material>'
    )
    folder.write(
        "lib.mlib",
        '<materialLib name="L"><textures><texture name="ramp" filename="ramp.png" mipmap="false" />'
        f'</textures><renderTargets><renderTarget name="rt"><SIZE width="{SIZE}" height="{SIZE}" />'
        '<colors><color name="out" internalFormat="RGBA32F" /></colors></renderTarget>'
        f"</renderTargets><shaders>{shaders}</shaders><materials>{materials}</materials></materialLib>",
    )
    text = PROJECT.format(s=SIZE, things=things, maps=maps, type=type_)
    folder.write("project.xml", text)
    project = folder.load()
    traced = nau_py.Renderer(project, "Traced").render().targets["L::out"]
    raster = nau_py.Renderer(project, "Raster").render().targets["L::out"][:, ::-1]
    drawn = raster[..., 3] > 0
    # where a thing hides its own mirror image from camera A, only the traced picture shows it
    inner = drawn.copy()
    for axis in (0, 1):
        for step in (-1, 1):
            inner &= np.roll(drawn, step, axis)
            near = np.abs(np.roll(raster, step, axis) - raster).max(axis=-1) < 0.15
            inner &= near
    rows = np.arange(SIZE)[:, None] > SIZE * 0.55  # below the things themselves
    checked = inner & rows
    assert checked.sum() > 600
    off = np.abs(np.clip(traced, 0, 1) - np.clip(raster, 0, 1)).max(axis=-1)[checked]
    assert (off > 2 / 255).mean() < 0.002, np.quantile(off, [0.5, 0.99, 1.0])


def test_plaza_by_its_own_programs(folder: Folder) -> None:
    """The plaza traced by ``material`` and rasterised: the same picture away from edges. Without
    its textures, whose mip levels only rasterisation has."""
    model = PROJECTS / "models" / "plaza"
    lines = (model / "plaza.mtl").read_text().splitlines()
    folder.write("plaza.mtl", "\n".join(line for line in lines if "map_Kd" not in line))
    (folder.path / "plaza.obj").symlink_to(model / "plaza.obj")
    text = (PROJECTS / "half" / "project.xml").read_text()
    text = text.replace("../models/plaza/", "").replace("../../", f"{ROOT}/")
    folder.write("project.xml", text)
    project = folder.load()
    for pipeline in project.pipelines:
        for pass_ in pipeline.passes:
            if isinstance(pass_, RaytracePass):
                pass_.rtInput, pass_.rtMaterialMap = [], []
                assert pass_.rtDefaultMaterial is not None
                for program in pass_.rtDefaultMaterial.rayTypes[0].programs:
                    program.proc = "material" if program.type == "CLOSEST_HIT" else program.proc
    size = (192, 192)
    traced = nau_py.Renderer(project, "Half", size=size).render().targets["Hybrid::radiance"]
    raster = nau_py.Renderer(project, "Raster", size=size).render().image / 255.0
    off = np.abs(np.clip(traced[..., :3], 0, 1) - raster[..., :3]).max(axis=-1)
    seen = materials_seen("half")
    plain = seen != "sky"
    for axis in (0, 1):
        for step in (-1, 1):
            plain &= np.roll(seen, step, axis) == seen
            plain &= np.abs(np.roll(raster, step, axis) - raster).max(axis=-1) < 0.03
    assert plain.sum() > 10_000
    assert (off[plain] > 2 / 255).mean() < 0.01, np.quantile(off[plain], [0.5, 0.9, 0.99])


def test_declarations_are_taken_out() -> None:
    text = "uniform mat4 a, b;\nuniform vec4 c; // uniform\nuniform highp mat3 n;\nin vec3 b2;"
    found, types = remove_declarations(text, {"b", "c", "n"})
    assert types == {"b": "mat4", "c": "vec4", "n": "mat3"}
    assert found == "uniform mat4 a;\n // uniform\n\nin vec3 b2;"


TWIN = """\
<project name="Twin" width="128" height="128"><assets>
  <scenes><scene name="S" type="Scene"><geometry name="ball" type="SPHERE" material="m" SLICES="96"
    STACKS="48"><SCALE x="1.2" y="0.8" z="1" /><TRANSLATE x="0.1" y="0" z="0" /></geometry></scene></scenes>
  <lights><light name="Sun"><DIRECTION x="-0.5" y="-0.6" z="-0.8" />
    <COLOR r="1" g="0.9" b="0.8" a="1" /></light></lights>
  <cameras><camera name="C"><projection TYPE="PERSPECTIVE" FOV="45" NEAR="0.1" FAR="50" />
    <POSITION x="0" y="0" z="3" /></camera></cameras>
  <materialLibs><materialLib filename="lib.mlib" /><materialLib filename="{phong}" /></materialLibs>
</assets><pipelines>
  <pipeline name="Traced"><pass name="trace" class="raytrace"><camera name="C" />
    <scenes><scene name="S" /></scenes><lights><light name="Sun" /></lights>
    <renderTarget name="rt" fromLibrary="L" />
    <materialMaps><map fromMaterial="m" toLibrary="L" toMaterial="m" /></materialMaps>
    <rtEntryPoint><rayGen file="builtin" proc="pinhole" /></rtEntryPoint>
    <rtDefaultMaterial><rayType name="R">
      <rtProgram type="CLOSEST_HIT" file="builtin" proc="{name}" /></rayType></rtDefaultMaterial>
  </pass></pipeline>
  <pipeline name="Raster"><pass name="draw" class="default"><camera name="C" />
    <scenes><scene name="S" /></scenes><lights><light name="Sun" /></lights>
    <renderTarget name="rt" fromLibrary="L" />
    <materialMaps><map fromMaterial="m" toLibrary="L" toMaterial="{twin}" /></materialMaps>
  </pass></pipeline>
</pipelines></project>
"""


@pytest.mark.parametrize("name", ["lambert", "phong", "blinn_phong"])
def test_compiled_shading_is_that_of_its_glsl_twin(folder: Folder, name: str) -> None:
    """Traced by the compiled program, rasterised by ``materials/phong.mlib``: 1/255 at most."""
    shine = '<SPECULAR r="0.6" g="0.5" b="0.4" a="1" /><SHININESS value="24" />'
    values = (ROOT / "materials" / "phong.mlib").read_text().split("<values>")[1]
    values = values.split("</values>")[0]
    shader = "phong" if name == "lambert" else name
    folder.write(
        "lib.mlib",
        '<materialLib name="L"><renderTargets><renderTarget name="rt"><SIZE width="128" height="128"/>'
        '<colors><color name="out" internalFormat="RGBA32F" /></colors></renderTarget>'
        f'</renderTargets><shaders><shader name="{shader}" vs="{ROOT}/materials/shaders/phong.vert" '
        f'ps="{ROOT}/materials/shaders/{shader}.frag" /></shaders><materials><material name="m">'
        f'<color><DIFFUSE r="0.7" g="0.4" b="0.3" a="1" />{"" if name == "lambert" else shine}'
        f'</color><shader name="{shader}"><values>{values}</values></shader></material></materials>'
        "</materialLib>",
    )
    folder.write(
        "project.xml", TWIN.format(phong=ROOT / "materials" / "phong.mlib", name=name, twin="m")
    )
    project = folder.load()
    traced = nau_py.Renderer(project, "Traced").render().targets["L::out"]
    raster = nau_py.Renderer(project, "Raster").render().targets["L::out"]
    inner = (raster[..., 3] > 0) & (traced[..., 3] > 0)
    for axis in (0, 1):
        for step in (-1, 1):
            inner &= np.roll(raster[..., 3], step, axis) > 0
    assert inner.sum() > 3000
    assert np.abs(traced - raster)[inner][:, :3].max() <= 1 / 255


def test_a_failing_program_beside_materials_ends_the_frame(folder: Folder) -> None:
    """Tiles that wait for OpenGL when another fails are let go: an error, not a standstill."""
    from tests.raytrace.studio import box, studio

    folder.write("prog.py", "def shade(hits):\n    raise ValueError('no')\n")
    project = studio(
        folder,
        box("a", "A", [1, 1, 1], [-1, 0, 0]) + box("b", "B", [1, 1, 1], [1, 0, 0]),
        {},
        '<rtMap to="B"><rayType name="Radiance"><rtProgram type="CLOSEST_HIT" file="prog.py" '
        'proc="shade" /></rayType></rtMap>',
        default="material",
        size=(64, 64),
    )
    options = nau_py.RunOptions(threads=2, tile=256)
    with pytest.raises(nau_py.NauError, match="raised ValueError: no"):
        nau_py.Renderer(project, options=options).render()

"""Reloading shaders and ray programs with a pass of every class (nau_py.passes.state)."""

from __future__ import annotations

import numpy as np
import pytest

import nau_py
from nau_py.passes import pass_classes
from nau_py.run.reload import HotReload
from nau_py.run.renderer import Renderer
from nau_py.run.used_files import PROGRAM, SHADER
from tests.conftest import ROOT, Folder

PTX = ROOT / "tests" / "raytrace" / "ptx" / "data"
PROJECT = """\
<project name="P" width="16" height="16">
<assets>
<scenes><scene name="S"><file name="card.obj"/></scene></scenes>
<viewports><viewport name="V"><CLEAR_COLOR r="0" g="0" b="0.5"/></viewport></viewports>
<lights><light name="Sun"><DIRECTION x="0" y="0" z="-1"/></light></lights>
<cameras><camera name="C"><viewport name="V"/>
<projection TYPE="PERSPECTIVE" FOV="60" NEAR="0.1" FAR="10"/>
<POSITION x="0" y="0" z="1"/></camera></cameras>
<materialLibs><materialLib filename="lib.mlib"/></materialLibs>
</assets>
<pipelines><pipeline name="Q" defaultCamera="C">
{pass_}
<pass name="show" class="quad"><material name="show" fromLibrary="L"/></pass>
</pipeline></pipelines>
</project>
"""
LIBRARY = """\
<materialLib name="L">
<renderTargets><renderTarget name="rt"><SIZE width="16" height="16"/>
<colors><color name="c" internalFormat="RGBA32F"/></colors><depth name="d" internalFormat="DEPTH_COMPONENT24"/></renderTarget>
<renderTarget name="side"><SIZE width="16" height="16"/>
<colors><color name="in" internalFormat="RGBA32F"/><color name="more" internalFormat="RGBA32F"/>
</colors></renderTarget></renderTargets>
<buffers>
<buffer name="rays"><SIZE value="32"/><file name="rays.txt"/><structure><field value="FLOAT"/>
</structure></buffer><buffer name="hits"><SIZE value="16"/></buffer></buffers>
<shaders><shader name="show" vs="a.vert" ps="a.frag"/><shader name="sum" cs="a.comp"/></shaders>
<materials><material name="show"><shader name="show">
<values><valueof uniform="image" type="TEXTURE_BINDING" context="CURRENT" component="UNIT" id="0"/>
</values></shader><textures><texture name="c" UNIT="0"/></textures></material>
<material name="sum"><shader name="sum"/><buffers><buffer name="hits"><BINDING_POINT value="1"/>
</buffer></buffers></material></materials>
</materialLib>
"""
FILES = {
    "lib.mlib": LIBRARY,
    "a.vert": "#version 330\nin vec4 position;\nvoid main() { gl_Position = position; }\n",
    "a.frag": "#version 330\nuniform sampler2D image;\nout vec4 colour;\n"
    "void main() { colour = texelFetch(image, ivec2(gl_FragCoord.xy), 0); }\n",
    "a.comp": "#version 430\nlayout (local_size_x = 1) in;\n"
    "layout (std430, binding = 1) buffer B { float b[]; };\nvoid main() { b[0] = 1.0; }\n",
    "mine.py": "import numpy as np\n\ndef shade(hits):\n    return hits.color('DIFFUSE')[..., :3] * np.ones((len(hits), 1))\n",
    "rays.txt": "0 0 1 0 0 0 -1 10",
}
_DRAWN = '<scenes><scene name="S"/></scenes><lights><light name="Sun"/></lights>'
_TARGET = '<renderTarget name="rt" fromLibrary="L"/>'
_QUERY = (
    '<scene name="S"/><rays buffer="L::rays" queryType="ANY"/><hits buffer="L::hits"/>'
    '<rayCount value="1"/>'
)
_PYTHON = f"""{_DRAWN}{_TARGET}
<rtEntryPoint><rayGen file="builtin" proc="pinhole"/></rtEntryPoint>
<rtDefaultMaterial><rayType name="R">
<rtProgram type="CLOSEST_HIT" file="mine.py" proc="shade"/></rayType></rtDefaultMaterial>"""
_OPTIX_7 = f"""{_DRAWN}{_TARGET}
<rtVertexAttributes><attribute name="position"/></rtVertexAttributes>
<rtEntryPoint><rayGen file="room.ptx" proc="__raygen__camera"/></rtEntryPoint>
<rtDefaultMaterial><rayType name="Radiance">
<rtProgram type="CLOSEST_HIT" file="room.ptx" proc="__closesthit__diffuse"/>
<rtProgram type="MISS" file="room.ptx" proc="__miss__blue"/></rayType></rtDefaultMaterial>"""
_OPTIX_6 = f"""{_DRAWN}{_TARGET}
<optixEntryPoint><optixProgram type="RayGen" file="old.ptx" proc="camera"/></optixEntryPoint>
<optixDefaultMaterial>
<optixProgram type="Closest_Hit" ray="First" file="old.ptx" proc="distance"/>
<optixProgram type="Miss" ray="First" file="old.ptx" proc="nothing"/>
<optixProgram type="Any_Hit" ray="Second" file="old.ptx" proc="count"/></optixDefaultMaterial>
<optixGeometryProgram>
<optixProgram type="Geometry_Intersection" file="old.ptx" proc="sphere"/>
<optixProgram type="Bounding_Box" file="old.ptx" proc="box"/></optixGeometryProgram>
<optixVertexAttributes><attribute name="position"/></optixVertexAttributes>
<optixInput><buffer var="pixels" texture="L::in"/><buffer var="numbers" texture="L::in"/></optixInput>
<optixOutput><buffer var="extra" texture="L::more"/></optixOutput>"""
PASSES = {
    "default": _DRAWN + _TARGET,
    "quad": '<texture name="c" fromLibrary="L"/>',
    "depthmap": _DRAWN + _TARGET,
    "depthmap2": _DRAWN + _TARGET,
    "geometryPI": _DRAWN + _TARGET,
    "profiler": "",
    "optixPrime": _QUERY,
    "embree": _QUERY,
    "compute": '<material name="sum" fromLibrary="L" dimX="1"/>',
    "mask": _DRAWN + _TARGET,
    "raytrace": _PYTHON,
    "rt": _OPTIX_7,
    "optix": _OPTIX_6,
}
STATES = {"optixPrime", "embree", "raytrace", "rt", "optix"}
"""Classes that keep state from frame to frame."""


def project(folder: Folder, class_: str) -> None:
    for name, text in FILES.items():
        folder.write(name, text)
    for name in ("room.ptx", "old.ptx"):
        folder.write(name, (PTX / name).read_text())
    folder.obj("card", [("Card", [(-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0)])])
    folder.mtl("card", {"Card": {"Kd": "0.8 0.4 0.2"}})
    written = f'<pass name="own" class="{class_}"><camera name="C"/>{PASSES[class_]}</pass>'
    folder.write("project.xml", PROJECT.format(pass_=written))


def test_every_class_has_a_project() -> None:
    assert set(PASSES) == set(pass_classes())


@pytest.mark.parametrize("class_", PASSES)
def test_reload(folder: Folder, class_: str) -> None:
    """Nothing has changed but the time of the files: the renderer stays, and so does the picture."""
    project(folder, class_)
    watch = HotReload(
        folder.path / "project.xml", nau_py.load, lambda p: Renderer(p, keep_targets=True)
    )
    first = watch.start()
    renderer = watch.renderer
    assert renderer is not None
    assert len(list(renderer.session.states)) == (class_ in STATES)
    programs = {"rt": "room.ptx", "optix": "old.ptx"}
    shaders = {folder.path / name: SHADER for name in ("a.frag", "a.comp")}
    for changed in (shaders, {folder.path / programs.get(class_, "mine.py"): PROGRAM}):
        frame = watch.render({path.resolve(): kind for path, kind in changed.items()})
        assert watch.renderer is renderer
        np.testing.assert_array_equal(frame.image, first.image)
    watch.close()

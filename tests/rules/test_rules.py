"""All rules: each on a small file, with its id, its place and its message."""

from __future__ import annotations

import re

import pytest

import nau_py
from tests.conftest import PROJECTS, Folder

LIB = """\
<materialLib name="L">
<renderTargets><renderTarget name="rt"><SIZE width=8 height=8 />
<colors><color name="c" internalFormat="RGBA32F"/></colors></renderTarget>
<renderTarget name="wide"><SIZE width=16 height=8 />
<colors><color name="w" internalFormat="R32F"/></colors></renderTarget></renderTargets>
<states><state name="s"/></states>
<shaders><shader name="sh" vs="a.vert"/></shaders>
<buffers><buffer name="b"><SIZE value=16 /></buffer></buffers>
<materials><material name="m"><shader name="sh"/></material>
<material name="reads"><textures><texture name="c" UNIT=0 /></textures></material>
</materials>
</materialLib>
"""
PROJECT = """\
<project name="P">
<assets>
<constants><constant name="side" value=4 /></constants>
<scenes><scene name="S"><geometry name="g" type="SQUARE" material="Floor"/></scene></scenes>
<viewports><viewport name="V"/></viewports>
<lights><light name="Sun"/></lights>
<cameras><camera name="C"/></cameras>
<materialLibs><materialLib filename="lib.mlib"/></materialLibs>
{assets}
</assets>
<pipelines default="P">
<pipeline name="P">
{passes}
<pass name="last" class="quad"><texture name="c" fromLibrary="L"/></pass>
</pipeline>
</pipelines>
</project>
"""
DRAW = '<pass name="draw"><renderTarget name="rt" fromLibrary="L"/>{}</pass>'
TRACE = """\
<pass name="trace" class="raytrace"><renderTarget name="rt" fromLibrary="L"/>
<rtEntryPoint><rayGen file="builtin" proc="pinhole"/></rtEntryPoint>
<rtDefaultMaterial><rayType name="R">{program}</rayType></rtDefaultMaterial>{more}</pass>
"""
MIRROR = '<rtProgram type="CLOSEST_HIT" file="builtin" proc="mirror"/>'


def pointed_at(found: nau_py.Diagnostic, sources: dict[str, str]) -> str:
    """Return the word at the place of a finding, which a caret would mark."""
    line = sources[found.location.file].splitlines()[found.location.line - 1]
    rest = line[found.location.column - 1 :]
    return re.split(r"[\s/>'\"]", rest.lstrip("<"), maxsplit=1)[0]


def findings(folder: Folder, passes: str = "", assets: str = "", lib: str = LIB) -> list[str]:
    """``rule severity `word pointed at` message`` of a project with these parts."""
    folder.write("a.vert", "#version 330\n")
    folder.write("lib.mlib", lib)
    folder.write("project.xml", PROJECT.format(passes=passes or DRAW.format(""), assets=assets))
    project = folder.load()
    return [
        f"{d.rule} {d.severity} `{pointed_at(d, project.sources)}` {d.message}"
        for d in nau_py.lint(project)
    ]


def test_a_good_project_has_no_finding(folder: Folder) -> None:
    assert findings(folder) == []


def test_the_demos_have_no_finding() -> None:
    for path in sorted(PROJECTS.glob("*/project.*")):
        assert nau_py.lint(nau_py.load(path)) == []


@pytest.mark.parametrize(
    "passes, expected",
    [
        (
            DRAW.format("<DEPTH_CLAER value=true />"),
            "S001 error `DEPTH_CLAER` element <DEPTH_CLAER> of <pass> is unknown; <pass> takes",
        ),
        (
            DRAW.format("<DEPTH_FUNC value='LESSEQUAL'/>"),
            "V005 error `DEPTH_FUNC` <DEPTH_FUNC> of <pass> is 'LESSEQUAL'; it takes 'LESS', 'NEVER', "
            "'ALWAYS', 'LEQUAL', 'EQUAL', 'GEQUAL', 'GREATER', 'NOT_EQUAL' (did you mean 'LEQUAL'?)",
        ),
        (
            DRAW.format("<DEPTH_CLEAR_VALUE value='far'/>"),
            "V007 error `DEPTH_CLEAR_VALUE` <DEPTH_CLEAR_VALUE> of <pass> is 'far': no number, and no constant "
            "of that name; the project defines 'side'",
        ),
        (
            DRAW.format("<COLOR_CLEAR value='on'/>"),
            "V001 error `on` attribute 'value' of <COLOR_CLEAR> is 'on'; true or false is expected",
        ),
        (
            DRAW.format("<STENCIL_OP_REF value='1,'/>"),
            "V002 warning `1,` attribute 'value' of <STENCIL_OP_REF> is '1,' and is read as 1",
        ),
        (
            DRAW.format("<DEPTH_CLEAR_VALUE value='1' unit='m'/>"),
            "S003 warning `DEPTH_CLEAR_VALUE` attribute 'unit' (='m') of <DEPTH_CLEAR_VALUE> of "
            "<pass> is unknown and ignored",
        ),
        (
            DRAW.format("<TEST_MODE value='RUN_IF'/>"),
            "V004 error `TEST_MODE` <TEST_MODE> is read-only; a file cannot set it",
        ),
        (
            '<pass name="t" class="raytrace"><RAYS_PER_PIXEL value=0 /></pass>' + DRAW.format(""),
            "V006 error `RAYS_PER_PIXEL` <RAYS_PER_PIXEL> of <pass> is 0; it must be at least 1",
        ),
        (
            DRAW.format("<TARGET_ERROR value='0.1' />"),
            "P007 error `TARGET_ERROR` pass 'draw': TARGET_ERROR is a parameter of class "
            "'raytrace', 'rt', 'optix'; class 'default' has no parameters of its own",
        ),
        (
            '<pass name="c" class="compute"><material name="m" fromLibrary="L"/>'
            '<RAY_COUNT value="2"/></pass>' + DRAW.format(""),
            "P007 error `RAY_COUNT` pass 'c': RAY_COUNT is a parameter of class 'optixPrime', "
            "'embree'; class 'compute' has 'DIM_X', 'DIM_Y', 'DIM_Z'",
        ),
        (
            DRAW.format("<DIM_X value='8' /><OCCLUSION_DISTANCE value='1' />"),
            "P007 error `OCCLUSION_DISTANCE` pass 'draw': OCCLUSION_DISTANCE is a parameter of "
            "class 'raytrace'",
        ),
        (
            DRAW.format("<lights><light/></lights>"),
            "S004 error `light` <light> needs the attribute 'name'",
        ),
        (
            DRAW.format("<scenes many=2><scene name='S'/></scenes>"),
            "S002 error `2` attribute 'many' (='2') of <scenes> is unknown; <scenes> takes "
            "'instances', 'drawIndirectBuffer'",
        ),
        (
            DRAW.format("<scenes><scene name='s'/></scenes>"),
            "R001 error `s` attribute 'name' of <scene> names the scene 's', which is undefined; "
            "there is 'S', 'C' (did you mean 'S'?)",
        ),
        (
            DRAW.format("<camera name='Cam'/>"),
            "R002 error `camera` <camera> of <pass> names the camera 'Cam', which is undefined; there "
            "is 'C', '__nauDefault'",
        ),
        (
            DRAW.format("<lights><light name='Son'/></lights>"),
            "R003 error `Son` attribute 'name' of <light> names the light 'Son', which is "
            "undefined; there is 'Sun', '__nauDefault' (did you mean 'Sun'?)",
        ),
        (
            DRAW.format("<viewport name='W'/>"),
            "R004 error `W` attribute 'name' of <viewport> names the viewport 'W'",
        ),
        (
            DRAW.format(
                "<materialMaps><map fromMaterial='*' toLibrary='K' toMaterial='m'/></materialMaps>"
            ),
            "R005 error `K` attribute 'toLibrary' of <map> names the library 'K', which is "
            "undefined; there is '__nau_material_lib', 'L'",
        ),
        (
            DRAW.format(
                "<materialMaps><map fromMaterial='*' toLibrary='L' toMaterial='n'/></materialMaps>"
            ),
            "R006 error `n` attribute 'toMaterial' of <map> names the material 'n' of library "
            "'L', which is undefined; it has 'm', 'reads'",
        ),
        (
            DRAW.format(
                "<materialMaps><map fromMaterial='Flor' toLibrary='L' toMaterial='m'/>"
                "</materialMaps>"
            ),
            "R018 warning `Flor` 'Flor' of pass 'draw' matches no material; there is 'Floor' "
            "(did you mean 'Floor'?)",
        ),
        (
            DRAW.format(
                "<injectionMaps><map toMaterial='*'><state name='t' fromLibrary='L'/></map>"
                "</injectionMaps>"
            ),
            "R008 error `t` attribute 'name' of <state> names the state 't' of library 'L', "
            "which is undefined; it has 's'",
        ),
        (
            DRAW.format("").replace('"rt"', '"tr"'),
            "R010 error `tr` attribute 'name' of <renderTarget> names the render target 'tr' of "
            "library 'L', which is undefined; it has 'rt', 'wide'",
        ),
        (
            '<pass name="a" class="quads"/>' + DRAW.format(""),
            "P001 error `quads` pass 'a': class 'quads' is unknown; there is 'default', 'quad'",
        ),
        (
            '<pass name="a" class="mesh"/>' + DRAW.format(""),
            "P002 warning `mesh` pass 'a': class 'mesh' is not supported by this version",
        ),
        (
            '<pass name="a" class="compute"/>' + DRAW.format(""),
            "P003 error `pass` compute pass 'a' needs a <material>",
        ),
        (
            DRAW.format("") + '<pass name="draw"/>',
            "N002 warning `draw` pass of pipeline 'P' 'draw' is defined a second time",
        ),
        (
            DRAW.format("").replace('"rt"', '"wide"') + DRAW.format(""),
            "D003 warning `pass` pass 'draw' of pipeline 'P' is left out: nothing that the picture "
            "needs reads what it writes (texture L::w, texture L::wide_depth)",
        ),
        (
            '<pass name="q" class="quad"><texture name="c" fromLibrary="L"/></pass>'
            + DRAW.format(""),
            "D001 note `pass` pass 'q' reads texture L::c, which only the later pass 'draw' writes: "
            "it sees the previous frame",
        ),
        (
            '<pass name="q" class="quad"><texture name="c" fromLibrary="L"/>'
            '<renderTarget name="wide" fromLibrary="L"/></pass>'
            '<pass name="r" class="quad"><texture name="w" fromLibrary="L"/>'
            '<renderTarget name="rt" fromLibrary="L"/></pass>',
            "D007 note `pass` cycle over frames: 'q' (project.xml:13:1) → texture L::w → 'r' "
            "(project.xml:13:114) → texture L::c → 'q'; it is closed by texture L::c of the previous "
            "frame",
        ),
        (
            '<pass name="q" class="quad"><texture name="w" fromLibrary="L"/></pass>'
            + DRAW.format(""),
            "D002 warning `pass` pass 'q' reads texture L::w, a target that no pass of pipeline 'P' "
            "writes",
        ),
        (
            DRAW.format(
                "<materialMaps><map fromMaterial='*' toLibrary='L' toMaterial='reads'/>"
                "</materialMaps>"
            ),
            "D004 error `pass` cycle: pass 'draw' samples texture L::c while drawing into it",
        ),
    ],
)
def test_pass_findings(folder: Folder, passes: str, expected: str) -> None:
    found = findings(folder, passes)
    assert any(line.startswith(expected) for line in found), "\n".join(found)


@pytest.mark.parametrize(
    "program, more, expected",
    [
        (
            MIRROR.replace("mirror", "miror"),
            "",
            "T006 error `miror` pass 'trace', material 'default', "
            "ray type 'R': there is no built-in CLOSEST_HIT program 'miror'; "
            "there is 'ambient_occlusion', 'blinn_phong', 'dielectric', ",
        ),
        (
            MIRROR.replace("builtin", "prog.pie"),
            "",
            "T003 error `prog.pie` pass 'trace', material "
            "'default', ray type 'R': program file 'prog.pie' does not exist (did you mean "
            "'prog.py'?)",
        ),
        (
            MIRROR.replace("builtin", "prog.py").replace("mirror", "shad"),
            "",
            "T004 error `shad` pass "
            "'trace', material 'default', ray type 'R': 'prog.py' defines no function 'shad'; it "
            "defines 'shade', 'np' (did you mean 'shade'?)",
        ),
        (
            MIRROR.replace("builtin", "a.vert"),
            "",
            "T005 error `a.vert` pass 'trace', material "
            "'default', ray type 'R': program 'mirror' is in 'a.vert', which does not run here, and no 'a.py'",
        ),
        (
            MIRROR,
            "<rtInput><buffer var='mask' texture='L::w'/></rtInput>",
            "T002 error `L::w` the "
            "mask 'L::w' of pass 'trace' is written by no earlier pass of pipeline 'P'",
        ),
        (
            MIRROR,
            "<rtInput><buffer var='m' texture='L::w'/></rtInput>",
            "D005 error `L::w` "
            "raytrace pass 'trace': input 'L::w' is 16 x 8, its render target 'rt' 8 x 8",
        ),
        (
            MIRROR,
            "<rtInput><buffer var='m' mask='w' texture='L::w'/></rtInput>",
            "D006 error `w` mask component 'w' of input 'L::w': the texture has 1 channels",
        ),
        (
            MIRROR,
            "<rtRayTypes><rayType name='Q'/></rtRayTypes>",
            "T007 warning `R` ray type 'R' of pass 'trace' is not declared; there is 'Q'",
        ),
        (
            MIRROR,
            "<rtGlobalParams><param name='x' type='LIGTH' context='CURRENT' component='COLOR'"
            "/></rtGlobalParams>",
            "R015 error `LIGTH` attribute 'type' of <param> names the object type 'LIGTH'",
        ),
        (
            MIRROR,
            "<rtGlobalParams><param name='x' type='LIGHT' context='CURRENT' component='COLOUR'"
            "/></rtGlobalParams>",
            "R016 error `COLOUR` LIGHT has no component 'COLOUR'; it has",
        ),
        (
            MIRROR,
            "<rtGlobalParams><param name='x' type='GRID' context='g' component='LENGTH'"
            "/></rtGlobalParams>",
            "L007 warning `GRID` 'LENGTH' of type GRID is not supplied by this version",
        ),
        (
            MIRROR,
            "<rtGlobalParams><param name='x' type='LIGHT' context='Son' component='COLOR'"
            "/></rtGlobalParams>",
            "R017 error `Son` context 'Son' is no light of the project",
        ),
    ],
)
def test_raytrace_findings(folder: Folder, program: str, more: str, expected: str) -> None:
    folder.write("prog.py", "import numpy as np\n\n\ndef shade(hits):\n    return np.ones(3)\n")
    found = findings(folder, TRACE.format(program=program, more=more))
    assert any(line.startswith(expected) for line in found), "\n".join(found)


PTX = """\
.version 6.4
.visible .entry __closesthit__glass(
)
{ ret; }
	.visible .entry __anyhit__shadow(
.visible .entry _Z9tracePathv(
.visible .func helper(
"""


def test_what_a_compiled_file_exports_is_one_finding(folder: Folder) -> None:
    """Names as OptiX 7 decorates them and as C++ compilers mangle ``tracePath()``."""
    folder.write("x.ptx", PTX)
    hit = MIRROR.replace("builtin", "x.ptx").replace("mirror", "__closesthit__glass")
    again = hit.replace("__closesthit__glass", "tracePath").replace("CLOSEST_HIT", "MISS")
    passes = TRACE.format(program=hit + again, more="")
    whose = "material 'default', ray type 'R'"
    assert findings(folder, passes) == [
        "T005 error `x.ptx` pass 'trace': 'x.ptx' does not run here, and no 'x.py' beside it "
        f"stands in; the file exports __closesthit__glass (closest hit, {whose}), "
        f"__anyhit__shadow (not used any hit), tracePath (miss, {whose})"
    ]
    found = findings(folder, passes.replace("tracePath", "traecPath"))
    assert any(
        line.startswith(f"T004 error `traecPath` pass 'trace', {whose}: 'x.ptx' exports no ")
        and line.endswith("(did you mean 'tracePath'?)")
        for line in found
    ), "\n".join(found)
    folder.write("x.py", "def glass(hits): ...\n\n\ndef tracePath(hits): ...\n")
    assert findings(folder, passes) == []


def test_programs_are_not_executed_by_lint(folder: Folder) -> None:
    folder.write("prog.py", "raise SystemExit('executed')\n\n\ndef shade(hits): ...\n")
    program = MIRROR.replace("builtin", "prog.py").replace("mirror", "shade")
    assert findings(folder, TRACE.format(program=program, more="")) == []


def test_two_raytrace_passes_are_an_error_naming_both(folder: Folder) -> None:
    second = TRACE.format(program=MIRROR, more="").replace('"trace"', '"again"')
    passes = TRACE.format(program=MIRROR, more="") + second
    found = [line for line in findings(folder, passes) if line.startswith("T001")]
    path = folder.path / "project.xml"
    assert found == [
        "T001 error `pass` pass 'again' of pipeline 'P' is a second raytrace pass; the first is "
        f"'trace' of pipeline 'P' at {path}:13:1. A project has one, unless <project "
        'raytracePasses="many">'
    ]
    text = path.read_text().replace(
        '<project name="P">', '<project name="P" raytracePasses="many">'
    )
    path.write_text(text)
    assert not [d for d in nau_py.lint(folder.load()) if d.rule == "T001"]


@pytest.mark.parametrize(
    "assets, expected",
    [
        ("<cameras/>", "X004 warning `cameras` <cameras> is given a second time in <assets>"),
        (
            "<stringAliases/>",
            "S003 warning `stringAliases` element <stringAliases> of <assets> is ignored",
        ),
        (
            "<cameraz/>",
            "S001 error `cameraz` element <cameraz> of <assets> is unknown; <assets> takes",
        ),
        ("words", "X003 warning `words` text between elements is ignored: 'words'"),
        (
            "<physicsLibs><physicsLib filename='x.plib'/></physicsLibs>",
            "L002 warning `physicsLib` physics library 'x.plib' is checked, not simulated",
        ),
    ],
)
def test_asset_findings(folder: Folder, assets: str, expected: str) -> None:
    found = findings(folder, assets=assets)
    assert any(line.startswith(expected) for line in found), "\n".join(found)


@pytest.mark.parametrize(
    "old, new, expected",
    [
        (
            'vs="a.vert"',
            'vs="b.vert"',
            "F001 error `b.vert` 'vs' of <shader>: the shader file 'b.vert' does not exist",
        ),
        (
            'vs="a.vert"',
            'vs="A.vert"',
            "F002 warning `A.vert` 'vs' of <shader>: 'A.vert' differs in "
            "letter case from 'a.vert' on disk",
        ),
        (
            'vs="a.vert"',
            r'vs=".\a.vert"',
            r"F003 note `.\a.vert` 'vs' of <shader>: '.\a.vert' has "
            "backslashes; './a.vert' works everywhere",
        ),
        (
            'name="sh"/></material>',
            'name="sj"/></material>',
            "R007 error `sj` attribute 'name' of "
            "<shader> names the shader 'sj' of library 'L', which is undefined; it has 'sh'",
        ),
        (
            '<texture name="c" UNIT=0 />',
            '<texture name="d" UNIT=0 />',
            "R009 error `d` attribute "
            "'name' of <texture> names the texture 'd' of library 'L', which is undefined; it has "
            "'c', 'rt_depth', 'w', 'wide_depth'",
        ),
        (
            '<material name="reads">',
            '<material name="m">',
            "N001 error `m` material of library 'L' 'm' is defined a second time",
        ),
        (
            "width=8 height=8",
            "width=0 height=8",
            "P004 error `renderTarget` render target 'rt': SIZE is 0 x 8; both must be above 0",
        ),
        (
            '"RGBA32F"',
            '"RGBA8"',
            "V005 error `RGBA8` attribute 'internalFormat' of <color> is 'RGBA8'",
        ),
        (
            '<color name="c" internalFormat="RGBA32F"/>',
            '<cubemap name="c" internalFormat="RGBA32F"/><color name="e" internalFormat="RGBA"/>',
            "P006 error `cubemap` render target 'rt': cube map 'c' is mixed with textures that are "
            "not cube maps",
        ),
        (
            '<SIZE width=8 height=8 />\n<colors><color name="c" internalFormat="RGBA32F"/>',
            "<SIZE width=8 height=8 /><SAMPLES value=4 /><colors>"
            '<cubemap name="c" internalFormat="RGBA32F"/>',
            "P006 error `SAMPLES` render target 'rt': SAMPLES is 4, but cube map 'c' has one "
            "sample",
        ),
        (
            "<SIZE width=8 height=8 />",
            "<SIZE width=8 />",
            "V003 error `SIZE` <SIZE> is a UIVEC2 and lacks 'y or height'",
        ),
    ],
)
def test_library_findings(folder: Folder, old: str, new: str, expected: str) -> None:
    assert old in LIB
    found = findings(folder, lib=LIB.replace(old, new, 1))
    assert any(line.startswith(expected) for line in found), "\n".join(found)


def test_a_missing_library_is_one_error(folder: Folder) -> None:
    folder.write("project.xml", PROJECT.format(passes="", assets=""))
    found = [d for d in nau_py.lint(folder.load()) if d.rule == "F001"]
    assert ["lib.mlib" in d.message for d in found] == [True]


def test_a_pipeline_without_an_end(folder: Folder) -> None:
    """In mode RUN_ALL only: the last one and one with a frameCount are fine."""
    two = (
        '<project name="P"><assets/><pipelines{mode}><pipeline name="A" {count}>{quad}</pipeline>'
        '<pipeline name="B">{quad}</pipeline></pipelines></project>'
    )
    quad = '<pass name="p" class="quad"/>'
    found = {}
    for mode in ("", ' mode="RUN_ALL"'):
        for count in ("", 'frameCount="3"'):
            folder.write("project.xml", two.format(mode=mode, count=count, quad=quad))
            lines = [d.message for d in nau_py.lint(folder.load()) if d.rule == "L006"]
            found[mode != "", count != ""] = lines
    message = "has neither frameCount nor testScript, so in mode RUN_ALL 'B' never runs"
    assert found.pop((True, False)) == [f"pipeline 'A' {message}"]
    assert list(found.values()) == [[], [], []]

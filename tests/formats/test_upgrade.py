"""Old dialects: the optix elements of the report, old user attributes, old clears."""

from __future__ import annotations

from nau_py.diagnostics.problem import ProblemKind
from nau_py.model.linked import Project
from nau_py.model.raytrace import RaytracePass
from tests.conftest import Folder

OPTIX = """\
<project name="O"><pipelines><pipeline name="P">
<pass name="trace" class="optix">
  <optixEntryPoint>
    <optixProgram type="RayGen" file="a.ptx" proc="camera"/>
    <optixProgram type="Exception" file="a.ptx" proc="oops"/>
  </optixEntryPoint>
  <optixDefaultMaterial>
    <optixProgram type="Closest_Hit" ray="Phong" file="a.ptx" proc="shade"/>
    <optixProgram type="Miss" ray="Shadow" file="a.ptx" proc="lit"/>
    <optixProgram type="Any_Hit" ray="Phong" file="a.ptx" proc="alpha"/>
  </optixDefaultMaterial>
  <optixMaterialMap>
    <optixMap to="Vidro"><optixProgram type="Closest_Hit" ray="Phong" file="a.ptx" proc="glass"/>
    </optixMap>
  </optixMaterialMap>
  <optixGeometryProgram>
    <optixProgram type="Bounding_Box" file="a.ptx" proc="box"/>
  </optixGeometryProgram>
  <optixVertexAttributes><attribute name="position"/></optixVertexAttributes>
  <optixMaterialAttributes>
    <valueof optixVar="diffuse" type="COLOR" context="CURRENT" component="DIFFUSE"/>
  </optixMaterialAttributes>
  <optixGlobalAttributes>
    <valueof optixVar="dir" type="LIGHT" context="CURRENT" id=0 component="DIRECTION"/>
  </optixGlobalAttributes>
  <optixInput><buffer var="pos" texture="L::position"/></optixInput>
  <optixOutput><buffer var="out" texture="L::out"/></optixOutput>
</pass>
</pipeline></pipelines></project>
"""


def raytrace_pass(project: Project) -> RaytracePass:
    found = project.pipelines[0].passes[0]
    assert isinstance(found, RaytracePass)
    return found


def test_optix_elements_become_the_neutral_ones(folder: Folder) -> None:
    folder.write("project.xml", OPTIX)
    project = folder.load()
    found = raytrace_pass(project)
    assert found.pass_class == "raytrace"
    assert not found.unknown_children
    entry = found.rtEntryPoint
    assert entry is not None
    assert entry.rayGen is not None
    assert entry.exception is not None
    assert (entry.rayGen.proc, entry.exception.proc) == ("camera", "oops")
    assert found.ray_types == ["Phong", "Shadow"]
    default, glass = found.materials
    assert [(g.name, p.type, p.proc) for g in default.rayTypes for p in g.programs] == [
        ("Phong", "CLOSEST_HIT", "shade"),
        ("Phong", "ANY_HIT", "alpha"),
        ("Shadow", "MISS", "lit"),
    ]
    assert (glass.to, glass.rayTypes[0].programs[0].proc) == ("Vidro", "glass")
    assert [(v.name, v.component) for v in found.rtMaterialParams] == [("diffuse", "DIFFUSE")]
    assert [(v.name, v.id) for v in found.rtGlobalParams] == [("dir", 0)]
    assert found.rtInput[0].texture == "L::position"
    assert found.rtGeometryProgram[0].proc == "box"


def test_messages_speak_of_the_written_tag(folder: Folder) -> None:
    folder.write("project.xml", OPTIX.replace('proc="shade"', 'prok="shade"'))
    program = raytrace_pass(folder.load()).materials[0].rayTypes[0].programs[0]
    assert program.tag == "optixProgram"
    assert program.unknown_attributes == {"prok": "shade"}
    assert program.location.line == 8


def test_old_user_attributes_and_clears(folder: Folder) -> None:
    folder.write(
        "project.xml",
        """\
<project name="O"><assets><attributes>
<attribute name="steps" context="PASS" type="INT" value="7"/></attributes></assets>
<pipelines><pipeline name="P"><pass name="q" class="quad">
<color clear="false" enable="true"/></pass></pipeline></pipelines></project>
""",
    )
    project = folder.load()
    assert [p.kind for p in project.problems] == [ProblemKind.LEGACY, ProblemKind.LEGACY]
    assert project.registry["PASS"].default("steps") == (7,)
    quad = project.pipelines[0].passes[0]
    assert quad.get("COLOR_CLEAR") == (False,)
    assert quad.get("COLOR_ENABLE") == (True,)

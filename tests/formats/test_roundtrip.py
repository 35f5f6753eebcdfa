"""formats.bind, formats.yaml: XML → model → YAML → model is the identity; nothing is lost."""

from __future__ import annotations

from pathlib import Path

import pytest

import nau_py
from nau_py.formats.bind import make_element
from nau_py.formats.load import Reader, load_library, load_project
from nau_py.formats.write import format_node
from nau_py.model.library import MaterialLibrary
from nau_py.model.linked import Project
from nau_py.model.node import Node
from nau_py.model.project import ProjectFile
from tests.conftest import PROJECTS, ROOT, Folder

EVERYTHING = """\
<project name="E" width=640 height=360 raytracePasses="many" extra="kept">
  <assets>
    <constants><constant name="side" value="256" type="FLOAT"/></constants>
    <aliases><alias name="other" value=2/></aliases>
    <attributes>
      <attribute type="RENDERER" name="depth" data="INT" value="3"/>
      <attribute type="PASS" name="tint" data="VEC4" x=1 y=2 z=3 w=4/>
    </attributes>
    <attributes><attribute type="PASS" name="second" data="INT"/></attributes>
    <scenes>
      <scene name="S" type="Scene" param="UNITIZE ">
        <geometry name="ball" type="SPHERE" SLICES=12 STACKS="side"><SCALE x=1 y=2 z=3/></geometry>
        <file name="a.obj" material="ignored"/>
        <folder name="models"/>
        <buffers name="b" primitive="TRIANGLES"><position name="p" fromLibrary="L"/></buffers>
        <TRANSLATE x=1 y=2 z=3 />
      </scene>
    </scenes>
    <viewports><viewport name="V" fixed="true"><SIZE width=0.5 height=1/></viewport></viewports>
    <lights><light name="Sun" type="x"><COLOR r=1 g=1 b=1/><odd a="1"><deep b="2"/></odd></light></lights>
    <cameras>
      <camera name="C">
        <UP x=0 y=0 z=1/><VIEW x=0 y=1 z=0/>
        <projection TYPE="ORTHO" LEFT=-2 RIGHT=2 />
      </camera>
    </cameras>
    <sensors><sensor name="t" class="TimeSensor"><loop value=1/></sensor></sensors>
    <interpolators>
      <interpolator name="i" class="PositionInterpolator">
        <keyFrames><keyFrame key=0 x=1/><keyFrame key=1 x=2/></keyFrames>
      </interpolator>
    </interpolators>
    <routes><route name="r" sender="t" receiver="i" eventIn="A" eventOut="B"/></routes>
    <events/>
  </assets>
  <pipelines default="P" mode="RUN_ALL">
    <pipeline name="P" default="true" frameCount=3>
      <preScript file="a.lua" script="f"/>
      <pass name="one" class="default">
        <mode value="RUN_ONCE"/>
        <testScript file="a.lua" script="g" TEST_MODE="RUN_IF"/>
        <preProcess><buffer name="b" fromLibrary="L" CLEAR="true"/>
          <texture name="t" fromLibrary="L" MIPMAP="true"/></preProcess>
        <scenes instances="other"><scene name="S"/></scenes>
        <COLOR_CLEAR value=false /><tint x=1 y=1 z=1/>
        <camera name="C"/><viewports><viewport name="V"/></viewports>
        <renderTarget name="r" fromLibrary="L"/>
        <injectionMaps><map toMaterial="*"><state name="s" fromLibrary="L"/>
          <textures><texture name="t" fromLibrary="L" toUnit=1><WRAP_S value="REPEAT"/></texture>
          </textures></map></injectionMaps>
        <materialMaps><map fromMaterial="*" toLibrary="L" toMaterial="m"/></materialMaps>
      </pass>
      <pass name="two" class="compute"><material name="m" fromLibrary="L" dimX="side" dimY=2/></pass>
      <pass name="three" class="optixPrime"><scene name="S"/><rays buffer="b" queryType="ANY"/>
        <hits buffer="h" fromLibrary="L"/><rayCount value=5/></pass>
      <pass name="four" class="someday"><thing a="1"/></pass>
    </pipeline>
  </pipelines>
  <interface><window label="w"><var label="l" type="LIGHT" context="Sun" component="COLOR"
    def="min=0 max=1" mode="COLOR"/></window></interface>
</project>
"""


def reread(project: Project, node: Node, style: str, path: Path) -> Node:
    """``node`` written in ``style`` and read again."""
    path.write_text(format_node(node, project.registry, style))
    if isinstance(node, MaterialLibrary):
        return load_library(path).libraries[-1]
    return load_project(path).file


@pytest.mark.parametrize("style", ["xml", "yaml"])
def test_everything_survives(folder: Folder, style: str) -> None:
    project = nau_py.load(folder.write("project.xml", EVERYTHING))
    assert reread(project, project.file, style, folder.path / f"again.{style}") == project.file


def test_no_attribute_is_lost(folder: Folder) -> None:
    path = folder.write("project.xml", EVERYTHING)
    project = nau_py.load(path)
    raw = Reader().element(path, "project", ProjectFile)
    assert raw is not None
    written = make_element(project.file, "project", project.registry)
    assert raw.count_attributes() == EVERYTHING.count("=") - 2  # two stand inside def="…"
    assert written.count_attributes() == raw.count_attributes()


def test_a_change_is_not_equal(folder: Folder) -> None:
    first = nau_py.load(folder.write("a.xml", EVERYTHING))
    second = nau_py.load(
        folder.write("b.xml", EVERYTHING.replace('<deep b="2"/>', "<deep b='3'/>"))
    )
    assert first.file != second.file


@pytest.mark.parametrize("name", ["half", "selective"])
def test_the_demos_are_the_same_in_yaml(name: str) -> None:
    xml = nau_py.load(PROJECTS / name / "project.xml")
    yaml = nau_py.load(PROJECTS / name / "project.yaml")
    assert xml.file == yaml.file


def test_a_library_survives(folder: Folder) -> None:
    path = ROOT / "materials" / "hybrid.mlib"
    project = load_library(path)
    for style, name in (("xml", "again.mlib"), ("yaml", "again.mlib.yaml")):
        assert (
            reread(project, project.libraries[-1], style, folder.path / name)
            == (project.libraries[-1])
        )


def test_yaml_is_idiomatic(folder: Folder) -> None:
    project = nau_py.load(folder.write("project.xml", EVERYTHING))
    text = format_node(project.file, project.registry, "yaml")
    for line in (
        "SCALE: [1.0, 2.0, 3.0]",
        "COLOR_CLEAR: false",
        "camera: C",
        "mode: RUN_ONCE",
        "instances: other",
        "STACKS: side",
    ):
        assert line in text


def test_an_unknown_child_may_be_called_like_an_attribute(folder: Folder) -> None:
    text = '<project name="P"><name x="1"/><odd y="2" z="3"><y z="4"/></odd></project>'
    project = nau_py.load(folder.write("project.xml", text))
    assert reread(project, project.file, "yaml", folder.path / "again.yaml") == project.file

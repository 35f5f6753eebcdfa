"""nau-lsp by its protocol: a real client drives the program over stdin and stdout."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

import nau_py
from tests.conftest import PROJECTS, ROOT

pytest.importorskip("pygls", reason="the extra [lsp] is not installed")

from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcException

from tests.lsp.client import Editor, edit


@pytest.fixture
def demo(tmp_path: Path) -> Path:
    """A copy of the selective demo with what it uses."""
    shutil.copytree(PROJECTS / "selective", tmp_path / "projects" / "selective")
    shutil.copytree(PROJECTS / "models", tmp_path / "projects" / "models")
    shutil.copytree(ROOT / "materials", tmp_path / "materials")
    return tmp_path


TWO_SIDED = (
    'state name="two',
    'Sided" fromLibrary="Hybrid" />\n            <shader fromMaterial="caster"',
)


def test_the_demo_in_an_editor(demo: Path) -> None:
    project = demo / "projects" / "selective" / "project.xml"
    library = demo / "materials" / "hybrid.mlib"

    async def work(editor: Editor) -> None:
        assert await editor.open(project) == []
        await completion(editor)
        await reading(editor)
        await renaming(editor)

    async def completion(editor: Editor) -> None:
        labels = editor.labels
        assert await labels(project, "    <lights>\n      <", 'light name="Sun">') == ["light"]
        assert "MAX_DEPTH" in await labels(project, "<MAX", "_DEPTH")
        named = await labels(project, '<camera name="SunEye">\n        <projection TYPE="ORT', "HO")
        assert named == ["PERSPECTIVE", "ORTHO"]
        assert await labels(project, '<camera name="Sun', 'Eye" />') == ["Eye", "SunEye"]
        assert "caster" in await labels(project, '<shader fromMaterial="cas', 'ter"')
        target = ('<renderTarget name="sha', 'dow" fromLibrary="Hybrid" />')
        assert {"raster", "shadow", "traced", "mask"} <= set(await labels(project, *target))
        scene = (
            '<pass name="raster" class="default">\n        <camera name="Eye" />\n        <scenes>\n          <scene name="Pl',
            'aza" />\n        </scenes>\n        <lights>',
        )
        assert "Plaza" in await labels(project, *scene)
        kinds = await labels(
            project, 'proc="pinhole_camera" />\n          <optixProgram type="', "Exc"
        )
        assert kinds == ["RayGen", "Exception"]
        assert "raytrace" in await labels(project, '<pass name="trace" class="ray', "trace")
        assert "Hybrid::color" in await labels(project, 'texture="Hybrid::posi', "tion")
        assert "shade" in await labels(project, 'proc="exce', "ption")
        assert "GradePortao" in await labels(project, '<map toMaterial="Vid', 'ro">')
        typed = editor.text(project).replace("    <viewports>", "    <view\n    <viewports>")
        await editor.type(project, typed)  # no XML at all, for the moment
        assert "viewports" in await labels(project, "    <view", "\n")
        await editor.type(project, project.read_text())

    async def reading(editor: Editor) -> None:
        about = await editor.hover(project, "<MAX", "_DEPTH")
        assert "Longest chain of rays." in about
        assert "INT; default 1; at least 1." in about
        about = await editor.hover(project, '<camera name="Sun', 'Eye" />')
        assert about.startswith("**camera `SunEye`** — defined at ")
        assert await editor.definition(project, *TWO_SIDED) == ["hybrid.mlib:40: twoSided"]
        assert await editor.definition(project, 'proc="pin', "hole") == ["hybrid.py:17: def"]
        assert await editor.definition(project, "plaza/pla", "za.obj") == ["plaza.obj:1: "]
        assert await editor.open(library) == []
        found = await editor.definition(library, 'ps="shaders/caster.f', "rag")
        assert found == ["caster.frag:1: "]
        half = '<material name="half">\n      <shader name="ha'
        names = await editor.labels(library, half, "lf")
        assert {"lit", "masked", "half", "caster", "combine"} <= set(names)
        shader = library.parent / "shaders" / "lit.vert"
        ends = 'component="TS05_PVM_MATRIX" />\n        </values>\n      </shader>\n    </material>\n    <!-- Traced'
        found = await editor.definition(
            library, 'uniform="sunM', f'atrix" type="CAMERA" context="SunEye" {ends}'
        )
        assert found == ["sun.frag:12: sunMatrix"]
        program = project.parent / "programs" / "hybrid.py"
        bound = await editor.definition(program, "def sha", "de(hits)")
        assert {place.split(":")[0] for place in bound} == {
            "project.xml",
            "full.xml",
            "project.yaml",
        }
        assert {place.split(": ")[1] for place in bound} == {"shade"}
        bound = await editor.definition(shader, "uniform mat4 P", "VM")
        assert {place.split(":")[0] for place in bound} == {"hybrid.mlib"}

    async def renaming(editor: Editor) -> None:
        used = await editor.references(library, '<state name="two', 'Sided">')
        three = [[name] * 3 for name in ("optix.xml", "project.yaml")]
        files = ["hybrid.mlib", *["project.xml"] * 3, "full.xml", *three[0], *three[1]]
        assert [line.split(":")[0] for line in used] == files
        await editor.rename(library, "bothSides", '<state name="two', 'Sided">')
        for file in (project, library):
            assert "twoSided" not in editor.text(file)
            assert editor.found[file] == []
            file.write_text(editor.text(file))
        for name in ("project.xml", "full.xml", "optix.xml", "project.yaml"):
            found = nau_py.lint(nau_py.load(project.parent / name))
            assert [d for d in found if d.severity == "error"] == []
        with pytest.raises(JsonRpcException, match="there is a material 'lit' already"):
            await editor.rename(library, "lit", '<material name="mas', 'ked">')
        with pytest.raises(JsonRpcException, match="is not defined in the project's own files"):
            await editor.rename(project, "Glass", '<map toMaterial="Vid', 'ro">')

    edit(demo, work)


def test_yaml_in_an_editor(demo: Path) -> None:
    project = demo / "projects" / "selective" / "project.yaml"

    async def work(editor: Editor) -> None:
        assert await editor.open(project, "yaml") == []
        assert "caster" in await editor.labels(project, "fromMaterial: cas", "ter")
        assert await editor.labels(project, "TYPE: ORT", "HO") == ["PERSPECTIVE", "ORTHO"]
        assert "MAX_DEPTH" in await editor.labels(project, "          MAX", "_DEPTH")
        assert "Longest chain of rays" in await editor.hover(project, "MAX", "_DEPTH")
        (place,) = await editor.definition(project, "fromMaterial: cas", "ter")
        assert place.split(":")[0::2] == ["hybrid.mlib", " caster"]
        used = await editor.references(project, "    - name: Sun", "Eye")
        assert {u.split(":")[0] for u in used} == {"project.yaml", "hybrid.mlib"}
        await editor.rename(project, "Lamp", "lights:\n    - name: S", "un\n")
        assert "- Sun\n" not in editor.text(project)
        assert editor.found[project] == []
        typed = editor.text(project).replace("class: raytrace", "class: raytrce")
        fault = next(d for d in await editor.type(project, typed) if d.code == "P001")
        (action,) = await editor.actions(project, fault)
        assert action.edit is not None
        await editor.apply(action.edit)
        assert editor.found[project] == []

    edit(demo, work)


LIBRARY = """\
<materialLib name="L">
<renderTargets><renderTarget name="rt"><SIZE width="8" height="8"/>
<colors><color name="c" internalFormat="RGBA32F"/></colors></renderTarget></renderTargets>
<states><state name="blend"/></states>
<shaders><shader name="phong" vs="a.vert" ps="a.frag"/></shaders>
<materials><material name="lit"><shader name="phong"/></material></materials>
</materialLib>
"""
TWENTY = """\
<project name="Faults" widht="64" height="64">
  <assets>
    <scenes>
      <scene name="Box"><geometry name="g" type="BOXX" material="Grey"/></scene>
      <scene name="File"><file name="Models\\Box.obj"/></scene>
    </scenes>
    <viewports><viewport name="Window"/></viewports>
    <lights>
      <light name="Sun"><COLOR r="2" g="1" b="1"/><ENABLED value="true"/></light>
    </lights>
    <cameras>
      <camera name="Eye"><projection TYPE="PERSPECTVE" FOV="60.0.0" NEAR="0" FAR="9"/></camera>
      <camera name="Eye"><POSITION x="1" y="2"/></camera>
    </cameras>
    <materialLibs><materialLib filename="L.mlib"/></materialLibs>
  </assets>
  stray words
  <pipelines default="Manin">
    <pipeline name="Main" defaultCamera="Eey">
      <pass name="draw" class="defalt" colour="red">
        <camera name="Eye"/>
        <scenes><scene name="Bax"/></scenes>
        <viewport name="Windw"/>
        <renderTarget name="rtt" fromLibrary="L"/>
        <lights><light name="Son"/></lights>
        <DEPTH_TETS value="true"/>
        <injectionMaps><map toMaterial="*"><state name="blnd" fromLibrary="L"/></map></injectionMaps>
      </pass>
      <pass name="show" class="quad"><texture name="cc" fromLibrary="LL"/></pass>
    </pipeline>
  </pipelines>
</project>
"""


def test_twenty_faults_and_their_fixes(tmp_path: Path) -> None:
    (tmp_path / "models").mkdir()
    (tmp_path / "models" / "box.obj").write_text("v 0 0 0\n")
    for name, text in (("L.mlib", LIBRARY), ("a.vert", ""), ("a.frag", "")):
        (tmp_path / name).write_text(text)
    project = tmp_path / "project.xml"
    project.write_text(TWENTY)
    wanted = nau_py.lint(nau_py.load(project))
    assert len(wanted) >= 20

    async def work(editor: Editor) -> None:
        found = await editor.open(project)
        assert [(d.code, d.message) for d in found] == [(d.rule, d.message) for d in wanted]
        for shown, meant in zip(found, wanted):
            assert (shown.range.start.line + 1, shown.range.start.character + 1) == (
                meant.location.line,
                meant.location.column,
            )
        first = next(d for d in found if d.code == "N001")
        assert first.related_information is not None
        assert first.related_information[0].location.range.start.line == 11
        mended: list[str] = []
        while fixable := await fixes(editor, found):
            code, action = fixable[0]
            mended.append(code)
            assert action.edit is not None
            await editor.apply(action.edit)
            before, found = found, editor.found[project]
            assert len(found) < len(before) or code not in [d.code for d in found]
        wanted_codes = (
            "F002 P001 R001 R002 R003 R004 R005 R008 R009 R010 R013 S001 S002 S003 V002 V005"
        )
        assert sorted(mended) == [*wanted_codes.split(), "V005"]
        left = sorted(str(d.code) for d in found)
        assert left == ["N001", "Q001", "V003", "V006", "X003"]

    async def fixes(
        editor: Editor, found: list[lsp.Diagnostic]
    ) -> list[tuple[str, lsp.CodeAction]]:
        return [
            (str(d.code), a)
            for d in found
            for a in await editor.actions(project, d)
            if a.is_preferred and f"({d.code})" in a.title
        ]

    edit(tmp_path, work)


def test_safe_fixes_in_one_go_and_texts_that_end_early(tmp_path: Path) -> None:
    project = tmp_path / "project.xml"
    project.write_text(TWENTY)

    async def work(editor: Editor) -> None:
        await editor.open(project)
        (action,) = await editor.actions(project, kind="source.fixAll")
        assert action.edit is not None
        await editor.apply(action.edit)
        codes = [d.code for d in editor.found[project]]
        assert "V002" not in codes
        assert "P001" in codes  # a guess is the person's to make
        assert await editor.type(project, "") == []
        for end in range(97, len(TWENTY), 290):
            found = await editor.type(project, TWENTY[:end])
            assert [d.code for d in found] == ["X002"]

    edit(tmp_path, work)


def test_characters_are_counted_as_the_editor_counts_them(tmp_path: Path) -> None:
    """LSP counts UTF-16 units: a sign outside of the basic plane is two."""
    project = tmp_path / "project.xml"
    text = '<project name="\U0001f600" widht="8"><pipelines><pipeline name="P"/></pipelines></project>\n'
    project.write_text(text)

    async def work(editor: Editor) -> None:
        (fault,) = [d for d in await editor.open(project) if d.code == "S002"]
        assert fault.range.start.character == text.index("8") + 1
        (action,) = await editor.actions(project, fault)
        assert action.edit is not None
        assert action.edit.changes is not None
        ((change,),) = action.edit.changes.values()
        assert change.range.start.character == text.index("widht") + 1

    edit(tmp_path, work)

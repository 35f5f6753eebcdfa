"""Loading: load order, user attributes, constants, paths, files that cannot be read."""

from __future__ import annotations

from pathlib import Path

import nau_py
from nau_py.diagnostics.problem import ProblemKind
from nau_py.process.paths import resolve
from tests.conftest import Folder


def test_user_attributes_are_settings_in_libraries_too(folder: Folder) -> None:
    folder.write(
        "lib.mlib",
        '<materialLib name="L"><states><state name="s"><glow value=2/></state>'
        "</states></materialLib>",
    )
    folder.write(
        "project.xml",
        '<project name="P"><assets><attributes>'
        '<attribute type="STATE" name="glow" data="FLOAT" value="1"/></attributes>'
        '<materialLibs><materialLib filename="lib.mlib"/></materialLibs></assets></project>',
    )
    project = folder.load()
    state = project.state("L", "s")
    assert state is not None
    assert project.value(state, "STATE", "glow") == (2.0,)


def test_constants_resolve_in_libraries(folder: Folder) -> None:
    folder.write(
        "lib.mlib",
        '<materialLib name="L"><renderTargets><renderTarget name="r">'
        '<SIZE width="side" height=8 /></renderTarget></renderTargets></materialLib>',
    )
    folder.write(
        "project.xml",
        '<project name="P"><assets><constants>'
        '<constant name="side" value="96.7"/></constants>'
        '<materialLibs><materialLib filename="lib.mlib"/></materialLibs></assets></project>',
    )
    project = folder.load()
    target = project.render_target("L", "r")
    assert target is not None
    assert project.value(target, "RENDER_TARGET", "SIZE") == (96, 8)


def test_a_colour_without_alpha_gets_alpha_zero(folder: Folder) -> None:
    folder.write(
        "project.xml",
        '<project name="P"><assets><viewports><viewport name="V">'
        "<CLEAR_COLOR r=1 g=1 b=1/></viewport></viewports></assets></project>",
    )
    project = folder.load()
    assert project.value(project.assets.viewports[0], "VIEWPORT", "CLEAR_COLOR") == (1, 1, 1, 0)


def test_paths_are_found_as_on_windows(tmp_path: Path) -> None:
    (tmp_path / "Models").mkdir()
    (tmp_path / "Models" / "Teapot.3DS").write_text("x")
    found = resolve(tmp_path / "project", r"..\models\teapot.3ds")
    assert found.exists
    assert found.wrong_case
    assert found.best == tmp_path / "Models" / "Teapot.3DS"
    assert not resolve(tmp_path, "nothing.obj").exists


def test_a_missing_project_is_a_problem_not_a_traceback(tmp_path: Path) -> None:
    project = nau_py.load(tmp_path / "none.xml")
    assert [p.kind for p in project.problems] == [ProblemKind.UNREADABLE]


def test_deep_nesting_is_a_problem(folder: Folder) -> None:
    folder.write("project.xml", "<a>" * 5000 + "</a>" * 5000)
    assert [p.kind for p in folder.load().problems] == [ProblemKind.SYNTAX]


def test_broken_yaml_has_a_position(folder: Folder) -> None:
    folder.write("project.yaml", "name: P\nassets: [a\nb: c\n")
    (problem,) = folder.load("project.yaml").problems
    assert problem.kind is ProblemKind.SYNTAX
    assert problem.location.line >= 2


def test_latin1_files_are_read(tmp_path: Path) -> None:
    path = tmp_path / "project.xml"
    path.write_bytes('<project name="Praça"/>'.encode("latin-1"))
    assert nau_py.load(path).file.name == "Praça"


def test_characters_that_yaml_forbids_are_a_problem(folder: Folder) -> None:
    folder.write("project.yaml", "name: P\f\n")
    (problem,) = folder.load("project.yaml").problems
    assert problem.kind is ProblemKind.SYNTAX


def test_findings_in_yaml_point_at_the_value(folder: Folder) -> None:
    folder.write(
        "project.yaml",
        "name: P\nassets:\n  cameras:\n    - name: Eye\n      TYPE: PERSPECTIV\n"
        "      UP: [0, 1, 0, 0, 7]\npipelines:\n  default: Q\n  pipeline:\n    - name: Q\n"
        "      pass:\n        - name: a\n          class: quadd\n",
    )
    found = [
        (d.rule, d.location.line, d.location.column)
        for d in nau_py.lint(folder.load("project.yaml"))
    ]
    assert found == [("V005", 5, 7), ("S003", 6, 7), ("P001", 13, 18)]

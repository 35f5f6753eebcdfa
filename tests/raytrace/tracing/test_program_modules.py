"""Neighbours of ray programs: ``raytrace/programs/neighbours.py``, ``tracing/program_modules.py``."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

import nau_py
from nau_py.model.node import Setting
from nau_py.raytrace.programs.neighbours import list_imported_functions
from nau_py.raytrace.programs.source import parse_program
from nau_py.run.reload import HotReload
from nau_py.run.renderer import Renderer
from nau_py.run.used_files import PROGRAM, used_files
from tests.conftest import Folder, RayProject

BINDING = """\
<rtDefaultMaterial><rayType name="Radiance">
<rtProgram type="CLOSEST_HIT" file="prog.py" proc="shade" />
</rayType></rtDefaultMaterial>
"""
RED = [1, 0, 0, 1]


@pytest.fixture
def wall(folder: Folder) -> Folder:
    """A quad that fills the view."""
    folder.mtl("scene", {"Wall": {"Kd": "1 1 1"}})
    folder.obj("scene", [("Wall", [(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)])])
    return folder


def colour(project: nau_py.Project, **options: object) -> list[float]:
    settings = nau_py.RunOptions(**options)  # type: ignore[arg-type]
    frame = nau_py.Renderer(project, options=settings).render()
    found: list[float] = frame.targets["L::out"][20, 30].tolist()
    return found


def fail(project: nau_py.Project, **options: object) -> nau_py.Diagnostic:
    with pytest.raises(nau_py.NauError) as caught:
        colour(project, **options)
    return caught.value.diagnostics[0]


@pytest.mark.parametrize(
    "text",
    [
        "import common\n\n\ndef shade(hits):\n    return common.red()\n",
        "import common as other\n\n\ndef shade(hits):\n    return other.red()\n",
        "from common import red\n\n\ndef shade(hits):\n    return red()\n",
        "from common import *\n\n\ndef shade(hits):\n    return red()\n",
        "def shade(hits):\n    from common import red\n\n    return red()\n",
        "from common import shade\n",
    ],
)
def test_a_program_imports_its_neighbour(wall: Folder, ray_project: RayProject, text: str) -> None:
    wall.write(
        "common.py", "def red():\n    return (1, 0, 0)\n\n\ndef shade(hits):\n    return red()\n"
    )
    wall.write("prog.py", text)
    project = ray_project(BINDING)
    assert nau_py.lint(project) == []
    assert colour(project) == RED
    assert "common" not in sys.modules
    assert str(wall.path) not in sys.path
    assert not (wall.path / "__pycache__").exists()


def test_neighbours_import_each_other(wall: Folder, ray_project: RayProject) -> None:
    wall.write("prog.py", "import first\n\n\ndef shade(hits):\n    return first.colour()\n")
    wall.write(
        "first.py", "import second\n\nRED = (1, 0, 0)\n\n\ndef colour():\n    return second.get()\n"
    )
    wall.write("second.py", "import first\n\n\ndef get():\n    return first.RED\n")
    assert colour(ray_project(BINDING)) == RED


def pixel(frame: nau_py.Frame) -> list[float]:
    found: list[float] = frame.image[20, 30].tolist()
    return found


def test_the_edit_of_a_neighbour_is_noticed(wall: Folder, ray_project: RayProject) -> None:
    wall.write("common.py", "RED = (1, 0, 0)\n")
    wall.write("prog.py", "from common import RED\n\n\ndef shade(hits):\n    return RED\n")
    project = ray_project(BINDING)
    neighbour = (wall.path / "common.py").resolve()
    assert used_files(project)[neighbour] == PROGRAM
    watch = HotReload(project.path, nau_py.load, Renderer)
    assert pixel(watch.start()) == [1, 0, 0, 1]
    renderer = watch.renderer
    wall.write("common.py", "RED = (0, 1, 0)\n")
    changed = watch.watch.take_changes()
    assert changed == {neighbour: PROGRAM}
    assert pixel(watch.render(changed)) == [0, 1, 0, 1]
    wall.write("new.py", "RED = (0, 0, 1)\n")
    wall.write("prog.py", "from new import RED\n\n\ndef shade(hits):\n    return RED\n")
    assert pixel(watch.render(watch.watch.take_changes())) == [0, 0, 1, 1]
    wall.write("new.py", "RED = (1, 1, 1)\n")
    assert pixel(watch.render(watch.watch.take_changes())) == [1, 1, 1, 1]
    assert watch.renderer is renderer
    watch.close()


def test_a_neighbour_outside_the_folder_is_refused(
    wall: Folder, ray_project: RayProject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    other = tmp_path_factory.mktemp("other")
    marker = other / "ran"
    (other / "common.py").write_text(f"open({str(marker)!r}, 'w').close()\nRED = (1, 0, 0)\n")
    (wall.path / "common.py").symlink_to(other / "common.py")
    wall.write("prog.py", "\n\nimport common\n\n\ndef shade(hits):\n    return common.RED\n")
    found = fail(ray_project(BINDING))
    assert found.rule == "T012"
    assert (found.location.file, found.location.line) == (str(wall.path / "prog.py"), 3)
    assert f"allow it with --allow-programs {other}" in found.message
    assert not marker.exists()
    assert colour(ray_project(BINDING), allow_programs=(str(other),)) == RED


@pytest.mark.parametrize("text", ["import outside", "from .. import outside", "import sub.inside"])
def test_no_other_folder_is_searched(wall: Folder, ray_project: RayProject, text: str) -> None:
    (wall.path.parent / "outside.py").write_text("")
    wall.write("sub.py", "")
    wall.write("prog.py", f"\n{text}\n\n\ndef shade(hits):\n    return (1, 0, 0)\n")
    found = fail(ray_project(BINDING))
    assert found.rule == "T010"
    assert (found.location.file, found.location.line) == (str(wall.path / "prog.py"), 2)


def test_no_programs_runs_no_neighbour(wall: Folder, ray_project: RayProject) -> None:
    wall.write("common.py", "open('ran', 'w').close()\n")
    wall.write("prog.py", "import common\n\n\ndef shade(hits):\n    return (1, 0, 0)\n")
    found = fail(ray_project(BINDING), no_programs=True)
    assert found.rule == "T012"
    assert not (Path.cwd() / "ran").exists()


@pytest.mark.parametrize("name", ["typer", "numpy", "json", "nau_py", "lxml"])
def test_a_neighbour_replaces_no_package(wall: Folder, ray_project: RayProject, name: str) -> None:
    wall.write(f"{name}.py", "raise SystemExit('the project replaced a package')\n")
    body = f"assert {name}.__file__ != {str(wall.path / name) + '.py'!r}"
    wall.write("prog.py", f"import {name}\n\n{body}\n\n\ndef shade(hits):\n    return (1, 0, 0)\n")
    before = sys.modules.get(name)
    assert colour(ray_project(BINDING)) == RED
    assert before is None or sys.modules[name] is before


def test_a_module_of_the_working_folder_is_not_installed(
    wall: Folder,
    ray_project: RayProject,
    tmp_path_factory: pytest.TempPathFactory,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    other = tmp_path_factory.mktemp("working")
    (other / "common.py").write_text("raise RuntimeError\n")
    monkeypatch.chdir(other)
    monkeypatch.syspath_prepend(str(other))
    wall.write("common.py", "RED = (1, 0, 0)\n")
    wall.write("prog.py", "import common\n\n\ndef shade(hits):\n    return common.RED\n")
    assert colour(ray_project(BINDING)) == RED


@pytest.mark.parametrize(
    "neighbour, file, line, words",
    [
        ("def red(:\n", "common.py", 1, "invalid syntax"),
        ("\n\nRED = 1 / 0\n", "common.py", 3, "loading 'common.py' raised ZeroDivisionError"),
        ("BLUE = 1\n", "prog.py", 1, "cannot import name 'RED' from 'common'"),
        ("def RED():\n    return [].pop()\n", "common.py", 2, "raised IndexError"),
    ],
)
def test_errors_of_a_neighbour_have_its_lines(
    wall: Folder, ray_project: RayProject, neighbour: str, file: str, line: int, words: str
) -> None:
    wall.write("common.py", neighbour)
    wall.write("prog.py", "from common import RED\n\n\ndef shade(hits):\n    return RED()\n")
    found = fail(ray_project(BINDING))
    assert found.rule == "T010"
    assert (found.location.file, found.location.line) == (str(wall.path / file), line)
    assert words in found.message


@pytest.mark.parametrize(
    "text",
    [
        "import common\n\n\ndef shade(hits):\n    return common.bounce(hits)\n",
        "from common import bounce\n\n\ndef shade(hits):\n    return bounce(hits)\n",
        "from common import *\n\n\ndef shade(hits):\n    return bounce(hits)\n",
        "from second import bounce as b\n\n\ndef shade(hits):\n    return b(hits)\n",
    ],
)
def test_rays_that_a_neighbour_sends_are_called_for(
    wall: Folder, ray_project: RayProject, text: str
) -> None:
    """The analysis of effects reads the neighbours too, so that it leaves out no ray of theirs."""
    wall.write(
        "common.py",
        "def bounce(hits):\n"
        "    return hits.trace('Radiance', hits.facing_normal, kind='reflection')[:, :3] + 0.5\n",
    )
    wall.write("second.py", "from common import bounce\n")
    wall.write("prog.py", text)
    project = ray_project(BINDING)
    project.pipelines[0].passes[0].settings["MAX_DEPTH"] = Setting((2,))
    frame = nau_py.Renderer(project).render()
    reflection = next(e for e in frame.report["effects"] if e["effect"] == "reflection")
    assert reflection["called_for"]
    assert reflection["status"] == "simulated"
    assert frame.report["totals"]["rays"]["reflection"] > 0


@pytest.mark.parametrize(
    "source",
    [
        f"import {'a' * 300}\n\ndef shade(hits):\n    pass\n",
        f"from {'a' * 300} import b\n\ndef shade(hits):\n    pass\n",
        f"depth = {'-' * 200_000}1\n\ndef shade(hits):\n    pass\n",
    ],
    ids=["long_name", "long_module", "deep"],
)
def test_sources_that_break_a_parser_are_linted(
    wall: Folder, ray_project: RayProject, source: str
) -> None:
    """Names beyond the limit of the file system, and nesting beyond that of the parser."""
    file = wall.write("prog.py", source)
    assert not [d for d in nau_py.lint(ray_project(BINDING)) if d.severity == "error"]
    assert list_imported_functions(file) == []


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no named pipes")
def test_a_pipe_as_neighbour_is_not_read(wall: Folder, ray_project: RayProject) -> None:
    file = wall.write("prog.py", "import common\n\ndef shade(hits):\n    pass\n")
    os.mkfifo(wall.path / "common.py")
    assert not [d for d in nau_py.lint(ray_project(BINDING)) if d.severity == "error"]
    assert list_imported_functions(file) == []
    assert parse_program(wall.path / "common.py") is None

"""passes.models: faults of model files, found by ``nau-lint --models``."""

from __future__ import annotations

import subprocess
import sys

import pytest

import nau_py
from tests.conftest import Folder

PROJECT = """\
<project name="P" width="4" height="4"><assets><scenes><scene name="S"><file name="a.obj"/></scene></scenes>
<viewports><viewport name="V"/></viewports><cameras><camera name="C"><viewport name="V"/></camera></cameras>
<materialLibs><materialLib filename="l.mlib"/></materialLibs></assets><pipelines><pipeline name="Q">
<pass name="trace" class="raytrace"><scenes><scene name="S"/></scenes><camera name="C"/>
<renderTarget name="rt" fromLibrary="L"/><rtEntryPoint><rayGen file="builtin" proc="pinhole"/></rtEntryPoint>
<rtDefaultMaterial><rayType name="R"><rtProgram type="CLOSEST_HIT" file="builtin" proc="mirror"/></rayType>
</rtDefaultMaterial></pass></pipeline></pipelines></project>
"""
LIB = """\
<materialLib name="L"><renderTargets><renderTarget name="rt"><SIZE width="4" height="4"/><colors>
<color name="c" internalFormat="RGBA32F"/></colors></renderTarget></renderTargets></materialLib>
"""
SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n"


def faults(folder: Folder, model: str) -> list[str]:
    folder.write("project.xml", PROJECT)
    folder.write("l.mlib", LIB)
    folder.write("a.obj", model)
    project = folder.load()
    assert nau_py.lint(project) == []
    return [f"{d.rule}: {d.message}" for d in nau_py.lint(project, models=True)]


@pytest.mark.parametrize(
    "more, expected",
    [
        ("", None),
        ("v nan 0 0\nf 1 2 5\n", "M003: model 'a.obj': 1 vertices are not finite (the first is"),
        ("f 1 2 2\n", "M005: pass 'trace': 1 faces are without area and left out of ray tracing"),
        ("f 1 2 3\n", "M005: pass 'trace': 1 faces are the same as another"),
        ("v 1e19 0 0\nf 1 2 5\n", "M005: pass 'trace': 1 faces are too large"),
        (
            "v 1e7 0 0\nv 10000001 0 0\nv 10000001 1 0\nf 5 6 7\n",
            "M006: pass 'trace': the coordinates of 'S' are rounded to 1,",
        ),
    ],
)
def test_faults_of_models(folder: Folder, more: str, expected: str | None) -> None:
    found = faults(folder, SQUARE + more)
    if expected is None:
        assert found == []
    else:
        assert any(line.startswith(expected) for line in found), "\n".join(found)


def test_models_are_loaded_without_opengl_and_embree(folder: Folder) -> None:
    faults(folder, SQUARE)
    code = (
        "import sys, nau_py\n"
        f"nau_py.lint(nau_py.load({str(folder.path / 'project.xml')!r}), models=True)\n"
        "assert not {'moderngl', 'OpenGL', 'embreex'} & set(sys.modules), 'loaded'\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)

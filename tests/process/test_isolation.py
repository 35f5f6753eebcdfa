"""A working folder with files named as modules and configurations: no process of ours takes them."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from nau_py.passes.frame import RunOptions
from nau_py.process.isolation import isolated_environment, python_command
from nau_py.viewer.cost_run import ViewerCostRun
from nau_py.viewer.render_thread import make_worker
from nau_py.viewer.request import PictureRequest
from tests.conftest import LAMBERT, Folder, RayProject
from tests.raytrace.ptx.host.test_rt_environment import room as room

BIN = Path(sys.executable).parent
MODULES = [
    "typer",
    "numpy",
    "rich",
    "lxml",
    "yaml",
    "json",
    "multiprocessing",
    "subprocess",
    "tempfile",
    "importlib",
    "pathlib",
    "sitecustomize",
    "usercustomize",
    "nau_py",
    "numba",
    "llvmlite",
    "pydantic",
    "psutil",
    "lupa",
    "jinja2",
    "encodings",
]


def make_hostile(path: Path) -> None:
    """Put modules that note their execution, and settings of numba, into a folder."""
    for name in MODULES:
        (path / f"{name}.py").write_text(
            f"open({str(path / 'executed.txt')!r}, 'a').write({name + ' '!r})\n"
        )
    (path / ".numba_config.yaml").write_text("cache_dir: evil\ndisable_jit: 1\n")


def assert_untouched(path: Path) -> None:
    """Assert that nothing of :func:`make_hostile` was executed or had an effect."""
    note = path / "executed.txt"
    assert not note.exists(), note.read_text()
    assert not (path / "evil").exists()


def run(command: str, *arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    words = [str(BIN / command), *arguments]
    return subprocess.run(words, cwd=cwd, capture_output=True, text=True, timeout=300, check=False)


@pytest.fixture
def hostile(folder: Folder, ray_project: RayProject) -> Path:
    """A folder with a small project of rays, and with hostile files beside it."""
    folder.obj("scene", [("M", [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)])])
    folder.mtl("scene", {"M": {"Kd": "0.8 0 0"}})
    ray_project(LAMBERT, size=(16, 12))
    make_hostile(folder.path)
    return folder.path


def test_lint_and_run(hostile: Path) -> None:
    assert run("nau-lint", "project.xml", cwd=hostile).returncode == 0
    done = run("nau-run", "project.xml", "-o", "x.png", "--no-programs", cwd=hostile)
    assert (done.returncode, done.stderr) == (0, "")
    assert_untouched(hostile)


def test_batch(hostile: Path) -> None:
    done = run("nau-run", "--batch", ".", "--report", "page.html", "--no-programs", cwd=hostile)
    assert done.returncode == 0, done.stderr
    assert "1 of 1 projects rendered" in (hostile / "page.html").read_text()
    assert_untouched(hostile)


def test_guarded_run_of_compiled_programs(room: Folder) -> None:
    make_hostile(room.path)
    arguments = ["project.xml", "-o", "x.png", "--allow-programs", "."]
    done = run("nau-run", *arguments, cwd=room.path)
    assert done.returncode == 0, done.stderr
    run("nau-run", "project.xml", "-o", "x.png", "--no-programs", cwd=room.path)
    assert_untouched(room.path)


def test_processes_of_the_viewer(hostile: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(hostile)
    worker = make_worker(hostile / "project.xml", RunOptions(threads=1))
    try:
        assert worker.request("render", PictureRequest("P"), False).width == 16
    finally:
        worker.stop()
    cost = ViewerCostRun(hostile / "project.xml", hostile)
    try:
        cost.start("P")
        for _ in range(600):
            if cost.state()["state"] != "running":
                break
            time.sleep(0.1)
        assert cost.state()["state"] == "done", cost.state()
    finally:
        cost.stop()
    assert_untouched(hostile)


@pytest.mark.parametrize("path", ["", ".", os.pathsep, "{here}", "relative/folder"])
def test_python_path_of_the_environment(
    path: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    make_hostile(tmp_path)
    (tmp_path / "here").mkdir()
    (tmp_path / "here" / "mine.py").write_text("def main(): print('mine', *sys.argv)\nimport sys\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PYTHONPATH", f"{path.format(here=tmp_path)}{os.pathsep}{tmp_path / 'here'}")
    if path == "{here}":  # absolute folders are the user's decision
        assert isolated_environment()["PYTHONPATH"].startswith(str(tmp_path))
        return
    done = subprocess.run(
        python_command("mine:main", ["a", "b"]),
        env=isolated_environment(),
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout == "mine -c a b\n"
    assert_untouched(tmp_path)

"""The house rules that a machine can check."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import nau_py

PACKAGE = Path(nau_py.__file__).parent
LEAVES = {"diagnostic", "errors", "files", "html", "paths", "plugins", "version"}
ARROWS = {
    "model": set(),
    "formats": {"model"},
    "graph": {"model"},
    "lint": {"model", "graph"},
    "scene": {"model"},
    "raster": {"scene", "model"},
    "raytrace": {"scene", "model"},
    "effects": {"model"},
    "passes": {"raster", "raytrace", "graph", "scene", "effects", "model"},
    "run": {"passes", "raster", "graph", "scene", "lint", "model"},
    "accuracy": {"run", "formats", "passes", "raster", "scene", "graph", "lint", "model"},
    "batch": set(),
    "editor": {"api", "formats", "lint", "model", "run", "scene"},
    "view": {
        "accuracy",
        "api",
        "formats",
        "graph",
        "lint",
        "model",
        "passes",
        "run",
        "scene",
    },
    "cli": {
        "accuracy",
        "batch",
        "editor",
        "view",
        "api",
        "formats",
        "lint",
        "graph",
        "run",
        "passes",
        "raster",
        "raytrace",
        "model",
    },
}
"""Room to the rooms that it may import; what design.md draws, and the arrows lint → graph and
run → lint, without which data flow could not be linted nor a wrong project refused."""


def imports(path: Path) -> set[str]:
    """Names of the nau_py rooms and other top packages that a module imports."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        names = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            names = [node.module]
        for name in names:
            parts = name.split(".")
            found.add(".".join(parts[:2]) if parts[0] == "nau_py" and len(parts) > 1 else parts[0])
    return found


def modules(room: str) -> list[Path]:
    return sorted((PACKAGE / room).rglob("*.py"))


@pytest.mark.parametrize("room", sorted(ARROWS))
def test_imports_point_one_way(room: str) -> None:
    allowed = {f"nau_py.{r}" for r in ARROWS[room] | LEAVES | {room}} | {"nau_py"}
    for path in modules(room):
        wrong = {n for n in imports(path) if n.startswith("nau_py")} - allowed
        if room != "cli":
            wrong |= imports(path) & {"nau_py"}
        assert not wrong, f"{path.relative_to(PACKAGE)} imports {wrong}"


@pytest.mark.parametrize(
    "package, home", [("embreex", "raytrace/accel.py"), ("OpenGL", "raster/gl.py")]
)
def test_one_file_wraps(package: str, home: str) -> None:
    users = [str(p.relative_to(PACKAGE)) for p in PACKAGE.rglob("*.py") if package in imports(p)]
    assert users == [home]


def test_modules_are_small() -> None:
    lengths = sorted(len(p.read_text().splitlines()) for p in PACKAGE.rglob("*.py"))
    assert lengths[-1] <= 500
    assert lengths[len(lengths) // 2] < 200


def test_only_the_command_line_prints() -> None:
    for path in PACKAGE.rglob("*.py"):
        if "cli" in path.parts:
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            called = node.func if isinstance(node, ast.Call) else None
            assert not (isinstance(called, ast.Name) and called.id == "print"), path


def test_lint_and_plan_need_no_gl_and_no_embree() -> None:
    code = (
        "import sys, nau_py\n"
        "p = nau_py.load('projects/selective/project.xml')\n"
        "assert not [d for d in nau_py.lint(p) if d.severity == 'error']\n"
        "assert len(nau_py.plan(p).running) == 4\n"
        "bad = {'moderngl', 'OpenGL', 'embreex'} & set(sys.modules)\n"
        "assert not bad, bad\n"
    )
    root = PACKAGE.parent
    done = subprocess.run([sys.executable, "-c", code], cwd=root, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_public_surface() -> None:
    assert nau_py.__all__ == [
        "DeviceError",
        "Diagnostic",
        "Frame",
        "Location",
        "NauError",
        "OutputError",
        "Plan",
        "ProgramError",
        "Project",
        "ProjectError",
        "Renderer",
        "RunOptions",
        "Severity",
        "ShaderError",
        "__version__",
        "lint",
        "load",
        "plan",
    ]
    for name in nau_py.__all__:
        assert getattr(nau_py, name) is not None
    assert callable(nau_py.lint)

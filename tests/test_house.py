"""The house rules that a machine can check."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import nau_py

PACKAGE = Path(nau_py.__file__).parent
FOUNDATION = {"diagnostics", "syntax", "process", "plugins", "version"}
"""Rooms and modules that any room may import, except those of ``STRICT``."""
STRICT: dict[str, set[str]] = {
    "diagnostics": set(),
    "model": {"diagnostics", "syntax", "plugins"},
}
"""Room to the part of the foundation that it may import."""
REPEATED_CLASSES = {"Style"}
"""Class names that are used twice until they are renamed."""
ARROWS = {
    "diagnostics": set(),
    "syntax": set(),
    "process": set(),
    "model": set(),
    "formats": {"model"},
    "graph": {"model"},
    "rules": {"model", "graph", "raytrace/programs", "raytrace/ptx/compiler"},
    "scene": {"model"},
    "raster": {"scene", "model"},
    "raytrace/selection": {"scene", "model"},
    "raytrace/programs": {"raytrace/kernels", "model"},
    "raytrace/kernels": set(),
    "raytrace/tracing": {"raytrace/kernels", "raytrace/programs", "scene", "model"},
    "raytrace/ptx/runtime": {"raytrace/kernels", "raytrace/tracing"},
    "raytrace/ptx/compiler": {"raytrace/ptx/runtime", "raytrace/programs"},
    "raytrace/ptx/optix": {
        "raytrace/ptx/compiler",
        "raytrace/ptx/runtime",
        "raytrace/kernels",
        "raytrace/tracing",
    },
    "raytrace/ptx/host": {
        "raytrace/ptx/compiler",
        "raytrace/ptx/optix",
        "raytrace/ptx/runtime",
        "raytrace/kernels",
        "raytrace/programs",
        "raytrace/tracing",
        "scene",
        "model",
    },
    "effects": {"model", "raytrace/programs"},
    "passes": {
        "raster",
        "raytrace/kernels",
        "raytrace/programs",
        "raytrace/ptx/host",
        "raytrace/selection",
        "raytrace/tracing",
        "graph",
        "scene",
        "effects",
        "model",
    },
    "run": {
        "passes",
        "raster",
        "graph",
        "scene",
        "rules",
        "model",
        "reporting",
        "raytrace/programs",
        "raytrace/selection",
    },
    "reporting": {"model"},
    "accuracy": {
        "run",
        "passes",
        "raster",
        "raytrace/selection",
        "scene",
        "graph",
        "rules",
        "model",
        "reporting",
    },
    "grading": {"reporting"},
    "lsp": {"api", "formats", "model", "run", "scene", "raytrace/programs"},
    "viewer": {
        "accuracy",
        "api",
        "formats",
        "graph",
        "model",
        "passes",
        "reporting",
        "run",
        "scene",
    },
    "cli": {
        "accuracy",
        "api",
        "formats",
        "grading",
        "graph",
        "lsp",
        "model",
        "passes",
        "raster",
        "raytrace/ptx/host",
        "raytrace/tracing",
        "reporting",
        "run",
        "viewer",
    },
}
"""Room to the rooms that it may import. ``rules`` needs ``graph``, as data flow cannot be linted
without it; ``run`` needs ``rules``, as a wrong project must not run."""


def room(parts: list[str]) -> str:
    """Return the room of a module below ``nau_py``.

    The folders of ``raytrace`` and those of ``raytrace/ptx`` are rooms each.
    """
    if parts[:2] == ["raytrace", "ptx"] and len(parts) > 2:
        return f"raytrace/ptx/{parts[2]}"
    if parts[0] == "raytrace" and len(parts) > 1:
        return f"raytrace/{parts[1]}"
    return parts[0]


def imports(path: Path) -> set[str]:
    """Names of the nau_py rooms and other top packages that a module imports."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        names = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            names = [node.module]
            if node.module in ("nau_py", "nau_py.raytrace"):
                names = [f"{node.module}.{alias.name}" for alias in node.names]
        for name in names:
            parts = name.split(".")
            if parts[0] == "nau_py" and len(parts) > 1:
                found.add(f"nau_py/{room(parts[1:])}")
            else:
                found.add(parts[0])
    return found


def modules(name: str) -> list[Path]:
    return sorted((PACKAGE / name).rglob("*.py"))


@pytest.mark.parametrize("name", sorted(ARROWS))
def test_imports_point_one_way(name: str) -> None:
    common = STRICT.get(name, FOUNDATION)
    allowed = {f"nau_py/{other}" for other in ARROWS[name] | common | {name}}
    for path in modules(name):
        wrong = {n for n in imports(path) if n.startswith("nau_py/")} - allowed
        if name == "cli":
            wrong -= {"nau_py/load", "nau_py/lint", "nau_py/plan", "nau_py/Renderer", "nau_py/cli"}
        assert not wrong, f"{path.relative_to(PACKAGE)} imports {wrong}"


def test_every_room_has_its_arrows() -> None:
    rooms = {p.parent.relative_to(PACKAGE) for p in PACKAGE.rglob("__init__.py")}
    names = {room(list(p.parts)) for p in rooms if p.parts} - {"raytrace", "raytrace/ptx"}
    assert names == set(ARROWS)


@pytest.mark.parametrize(
    "package, home", [("embreex", "raytrace/tracing/accelerator.py"), ("OpenGL", "raster/gl.py")]
)
def test_one_file_wraps(package: str, home: str) -> None:
    users = [str(p.relative_to(PACKAGE)) for p in PACKAGE.rglob("*.py") if package in imports(p)]
    assert users == [home]


def test_only_process_starts_processes() -> None:
    starters = {"subprocess", "multiprocessing", "pty", "_posixsubprocess"}
    for path in PACKAGE.rglob("*.py"):
        if path.is_relative_to(PACKAGE / "process"):
            continue
        assert not imports(path) & starters, path
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
                name = f"{node.value.id}.{node.attr}"
                starts = ("os.fork", "os.exec", "os.spawn", "os.posix_spawn", "os.system")
                assert not name.startswith((*starts, "os.popen", "asyncio.create_subprocess")), path
            assert getattr(node, "id", "") != "ProcessPoolExecutor", path


def test_class_names_are_unique() -> None:
    found: dict[str, list[str]] = {}
    for path in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ClassDef):
                found.setdefault(node.name, []).append(str(path.relative_to(PACKAGE)))
    repeated = {name: files for name, files in found.items() if len(files) > 1}
    assert set(repeated) <= REPEATED_CLASSES, repeated


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
        "bad = {'moderngl', 'OpenGL', 'embreex', 'networkx'} & set(sys.modules)\n"
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

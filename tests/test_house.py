"""The house rules that a machine can check."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterable
from functools import cache
from pathlib import Path

import networkx
import pytest

import nau_py

PACKAGE = Path(nau_py.__file__).parent
FOUNDATION = {"diagnostics", "syntax", "process", "plugins", "version"}
"""Rooms and modules that any room may import, except those of ``STRICT``."""
STRICT: dict[str, set[str]] = {
    "diagnostics": set(),
    "process": {"diagnostics"},
    "syntax": {"diagnostics", "process"},
    "model": {"diagnostics", "syntax", "plugins"},
}
"""Room to the part of the foundation that it may import."""
HEAVY = {
    "OpenEXR",
    "OpenGL",
    "PIL",
    "assimp_py",
    "embreex",
    "flip_evaluator",
    "jinja2",
    "llvmlite",
    "lupa",
    "lxml",
    "matplotlib",
    "moderngl",
    "nau_py.raytrace.ptx.optix.compile",
    "networkx",
    "numba",
    "psutil",
    "pygls",
    "rich",
    "starlette",
    "uvicorn",
    "xml",
}
"""Packages that take long to import. Only they, and modules that need them, may be imported inside
a function: ``nau-lint`` and ``import nau_py`` start without them.
``xml.sax`` imports HTTP and SSL; the compiler of PTX has thirty modules, which few projects need."""
NOT_EVERYWHERE = {"resource"}
"""Modules of the standard library that some systems lack."""
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


@cache
def parse(path: Path) -> ast.Module:
    """Parse a module, once for all tests."""
    return ast.parse(path.read_text())


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
    for node in ast.walk(parse(path)):
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
        for node in ast.walk(parse(path)):
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
                name = f"{node.value.id}.{node.attr}"
                starts = ("os.fork", "os.exec", "os.spawn", "os.posix_spawn", "os.system")
                assert not name.startswith((*starts, "os.popen", "asyncio.create_subprocess")), path
            assert getattr(node, "id", "") != "ProcessPoolExecutor", path


def test_class_names_are_unique() -> None:
    found: dict[str, list[str]] = {}
    for path in PACKAGE.rglob("*.py"):
        for node in ast.walk(parse(path)):
            if isinstance(node, ast.ClassDef):
                found.setdefault(node.name, []).append(str(path.relative_to(PACKAGE)))
    repeated = {name: files for name, files in found.items() if len(files) > 1}
    assert not repeated


def count_lines(paths: Iterable[Path]) -> int:
    return sum(len(path.read_text().splitlines()) for path in paths)


def test_modules_are_small() -> None:
    lengths = {path: count_lines([path]) for path in PACKAGE.rglob("*.py")}
    assert not {path: n for path, n in lengths.items() if n > 400}
    assert sorted(lengths.values())[len(lengths) // 2] < 200


def test_rooms_are_small() -> None:
    """No room holds more than a tenth of the code."""
    whole = count_lines(PACKAGE.rglob("*.py"))
    sizes: dict[str, int] = {}
    for path in PACKAGE.rglob("*.py"):
        name = room(list(path.relative_to(PACKAGE).parts))
        sizes[name] = sizes.get(name, 0) + count_lines([path])
    assert not {name: size for name, size in sizes.items() if size > whole / 10}


class Imports:
    """Modules that one module imports, as dotted names."""

    def __init__(self, tree: ast.Module, modules: set[str]) -> None:
        self.modules = modules
        inside = (ast.FunctionDef, ast.AsyncFunctionDef)
        functions = [node for node in ast.walk(tree) if isinstance(node, inside)]
        self.local = {name for node in functions for name in self.names(node)}
        types = [
            node
            for node in ast.walk(tree)
            if isinstance(node, ast.If) and getattr(node.test, "id", "") == "TYPE_CHECKING"
        ]
        self.all = self.names(tree)
        typed = {name for node in types for name in self.names(node)}
        self.at_start = self.all - self.local - typed

    def names(self, tree: ast.AST) -> set[str]:
        found: set[str] = set()
        for node in ast.walk(tree):
            if isinstance(node, ast.Import):
                found |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module:
                for alias in node.names:
                    whole = f"{node.module}.{alias.name}"
                    found.add(whole if whole in self.modules else node.module)
        return found


@pytest.fixture(scope="module")
def package_imports() -> dict[str, Imports]:
    """Return the imports of every module of the package, by its dotted name."""
    names = {}
    for path in PACKAGE.rglob("*.py"):
        parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
        names[".".join(parts).removesuffix(".__init__")] = path
    return {name: Imports(parse(path), set(names)) for name, path in names.items()}


def test_modules_import_each_other_without_circles(package_imports: dict[str, Imports]) -> None:
    """Imports inside functions and those for types alone count."""
    graph: networkx.DiGraph[str] = networkx.DiGraph()
    for name, found in package_imports.items():
        graph.add_edges_from((name, other) for other in found.all if other in package_imports)
    circles = [part for part in networkx.strongly_connected_components(graph) if len(part) > 1]
    assert not circles


def test_only_heavy_modules_are_imported_inside_functions(
    package_imports: dict[str, Imports],
) -> None:
    graph: networkx.DiGraph[str] = networkx.DiGraph()
    for name, found in package_imports.items():
        graph.add_node(name)
        for other in found.at_start:
            graph.add_edge(name, other if other in package_imports else other.partition(".")[0])
    for name, found in package_imports.items():
        for other in found.local - NOT_EVERYWHERE:
            top = other if other in package_imports else other.partition(".")[0]
            needed = {top} | (networkx.descendants(graph, top) if top in graph else set())
            assert needed & HEAVY, f"{name} imports {other} inside a function"


QUESTIONS = ("What", "Whose", "Whether", "Where", "Which", "How")
"""First words that a docstring must not have: it names a thing or says what a function does."""
NOT_YET = {
    "nau_py/effects/analysis.py",
    "nau_py/effects/decision.py",
    "nau_py/effects/facts.py",
    "nau_py/model/effects.py",
    "nau_py/raytrace/kernels/core/jit.py",
    "nau_py/raytrace/kernels/core/tables.py",
    "nau_py/raytrace/kernels/geometry/surface.py",
    "nau_py/raytrace/kernels/geometry/texture.py",
    "nau_py/raytrace/kernels/shading/direct.py",
    "nau_py/raytrace/kernels/shading/sample_bsdf.py",
    "nau_py/raytrace/programs/source.py",
    "nau_py/raytrace/tracing/scene_tables.py",
}
"""Modules whose docstrings are still to be written anew."""


def list_docstrings(path: Path) -> Iterable[str]:
    """Yield the docstrings of a file: those of modules, classes, functions and constants."""
    for node in ast.walk(parse(path)):
        body = getattr(node, "body", None)
        for part in body if isinstance(body, list) else []:
            value = part.value if isinstance(part, ast.Expr) else None
            if isinstance(value, ast.Constant) and isinstance(value.value, str):
                yield value.value


@pytest.mark.parametrize("folder", ["nau_py", "tools", "benchmarks", "projects"])
def test_no_docstring_begins_with_a_question(folder: str) -> None:
    root = PACKAGE.parent
    for path in sorted((root / folder).rglob("*.py")):
        if path.relative_to(root).as_posix() in NOT_YET:
            continue
        for text in list_docstrings(path):
            assert not re.match(rf"\s*({'|'.join(QUESTIONS)})\b", text), f"{path}: {text[:60]}"


def test_only_the_command_line_prints() -> None:
    for path in PACKAGE.rglob("*.py"):
        if "cli" in path.parts:
            continue
        for node in ast.walk(parse(path)):
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

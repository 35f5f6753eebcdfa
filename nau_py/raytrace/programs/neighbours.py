"""Modules beside a ray program that it may import by their plain names. Nothing is run here.

``import common`` in a program means ``common.py`` in the folder of the program, unless the standard
library or an installed package has a module of that name: these are never replaced.
"""

from __future__ import annotations

import ast
import sys
from dataclasses import dataclass, field
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path

from nau_py.raytrace.programs.source import parse_program


def find_neighbour(folder: Path, name: str) -> Path | None:
    """Return the file that ``import name`` means in a program of ``folder``.

    None if there is no such file, or if the name belongs to the standard library or to an installed
    package.
    """
    path = folder / f"{name}.py"
    try:
        exists = name.isidentifier() and path.is_file()
    except OSError:  # a name longer than the file system allows
        return None
    return path if exists and not _is_installed(name, Path.cwd()) else None


@lru_cache(maxsize=256)
def _is_installed(name: str, working: Path) -> bool:
    """Return True if a module of the standard library or of an installed package has this name.

    Modules of the folder ``working`` do not count: Python may search the working folder, which
    differs from run to run.
    """
    if name in sys.stdlib_module_names or name == "nau_py":
        return True
    try:
        spec = find_spec(name)
    except (ImportError, ValueError):  # a module without a specification, such as __main__
        return True
    if spec is None or spec.origin is None:  # without an origin: a folder, not a package
        return False
    return working not in Path(spec.origin).resolve().parents[:2]


@dataclass(slots=True)
class NeighbourImports:
    """Names that a program file imports from its neighbours.

    ``names``: local name to file and name there; ``modules``: local name to file.
    """

    names: dict[str, tuple[Path, str]] = field(default_factory=dict)
    modules: dict[str, Path] = field(default_factory=dict)


def read_neighbour_imports(tree: ast.Module, folder: Path) -> NeighbourImports:
    """Collect the imports of neighbours in the source of a program of ``folder``."""
    found = NeighbourImports()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                path = find_neighbour(folder, alias.name)
                if path is not None:
                    found.modules[alias.asname or alias.name] = path
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            path = find_neighbour(folder, node.module)
            if path is not None:
                found.names |= {a.asname or a.name: (path, a.name) for a in node.names}
    return found


def list_imported_functions(path: Path) -> list[tuple[Path, str]]:
    """Return file and name of the functions that a program can call in its neighbours.

    These are the functions that the file imports by name, all functions of modules that it imports
    whole, and those that the neighbours import in turn.
    """
    found: dict[tuple[Path, str], None] = {}
    todo, done = [path], {path}
    while todo:
        for other, name in _list_imports(todo.pop()):
            found[other, name] = None
            if other not in done:
                done.add(other)
                todo.append(other)
    return list(found)


def _list_imports(path: Path) -> tuple[tuple[Path, str], ...]:
    """Return file and name of the functions that a file itself imports from neighbours."""
    tree = parse_program(path)
    if tree is None:
        return ()
    imports = read_neighbour_imports(tree, path.parent)
    whole = [*imports.modules.values(), *(p for p, name in imports.names.values() if name == "*")]
    found = [(other, name) for other, name in imports.names.values() if name != "*"]
    for other in whole:
        functions = parse_program(other)
        body = functions.body if functions is not None else []
        found += [(other, node.name) for node in body if isinstance(node, ast.FunctionDef)]
    return tuple(found)

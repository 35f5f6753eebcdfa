"""PTX modules of a pass: files, functions and their faults. Nothing is executed."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from nau_py.diagnostics.diagnostic import Diagnostic, error
from nau_py.model.raytrace import RaytracePass
from nau_py.process.paths import resolve
from nau_py.raytrace.programs.source import COMPILED, plain_name
from nau_py.raytrace.programs.used import used_programs
from nau_py.raytrace.ptx.compiler.module import PtxError, PtxFunction, PtxModule
from nau_py.raytrace.ptx.compiler.reader import read_ptx
from nau_py.raytrace.ptx.optix.compile import compile_all
from nau_py.raytrace.ptx.optix.variables import VariableLayout, calls_interface, uses_variables

Modules = dict[Path, "PtxModule | PtxError | OSError"]
"""Modules by file; an error for a file that cannot be read."""


def program_path(folder: Path, file: str | None) -> Path:
    """Return the path of a program's file; ``folder``: that of the project."""
    return resolve(folder, file or "").best


def find_function(module: PtxModule, name: str) -> PtxFunction | None:
    """Find a defined function by its name in the module, or by its name in C++."""
    found = module.functions.get(name)
    if found is None or found.body is None:
        named = (f for n, f in module.functions.items() if plain_name(n) == name)
        found = next((f for f in named if f.body is not None), None)
    return found


def read_module(path: Path) -> PtxModule:
    """Read a module. Raises :class:`PtxError` and OSError."""
    return read_ptx(path.read_text("utf-8", "replace"))


def read_modules(pass_: RaytracePass, folder: Path) -> Modules:
    """Read the modules of a pass, or the errors that prevent it."""
    found: Modules = {}
    for program, *_ in used_programs(pass_):
        path = program_path(folder, program.file)
        if path in found or path.suffix.lower() != COMPILED or not path.exists():
            continue
        try:
            found[path] = read_module(path)
        except (OSError, PtxError) as problem:
            found[path] = problem
    return found


def check_modules(pass_: RaytracePass, modules: Modules, folder: Path) -> Iterator[Diagnostic]:
    """Yield the errors of modules that cannot be read, compiled or used together (T015)."""
    label = f"pass '{pass_.name}'"
    seen: set[Path] = set()
    for program, *_ in used_programs(pass_):
        path = program_path(folder, program.file)
        module = modules.get(path)
        where = program.where("file")
        if path in seen:
            continue
        if program.file and path.suffix.lower() != COMPILED:
            text = f"{label}: '{program.file}' is no compiled program, as its others are"
            yield error("T015", where, text)
        elif module is not None:
            for line, text in _list_errors(module):
                yield error("T015", where, f"{label}: {path.name}:{line}: {text}")
        seen.add(path)
    read = {path: module for path, module in modules.items() if isinstance(module, PtxModule)}
    old = [path.name for path, module in read.items() if uses_variables(module)]
    new = [path.name for path, module in read.items() if calls_interface(module, "_optix_")]
    if old and new:
        yield error(
            "T015",
            pass_.location,
            f"{label}: '{new[0]}' is of OptiX 7, '{old[0]}' of OptiX 3 to 6: a pass has one of "
            "them",
        )
    layout = VariableLayout()
    for path, module in read.items():
        try:
            wrong = layout.add_module(module)
        except PtxError:
            continue  # reported above
        for text in wrong:
            yield error("T015", pass_.location, f"{label}: {path.name}: {text}")


def _list_errors(module: PtxModule | PtxError | OSError) -> list[tuple[int, str]]:
    if isinstance(module, PtxError):
        return [(module.line, str(module))]
    if isinstance(module, OSError):
        return [(1, module.strerror or str(module))]
    _, errors = compile_all(module)
    return [(e.line, str(e)) for e in errors]

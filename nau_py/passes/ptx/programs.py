"""The compiled programs of a pass: which ones, their modules, their addresses."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from nau_py.diagnostics.diagnostic import Diagnostic, error
from nau_py.diagnostics.errors import ProgramError
from nau_py.model.raytrace import Program, RaytracePass
from nau_py.process.paths import resolve as resolve_path
from nau_py.raytrace.programs.source import COMPILED, plain_name
from nau_py.raytrace.programs.used import used_programs
from nau_py.raytrace.ptx.compiler.module import PtxError, PtxFunction, PtxModule
from nau_py.raytrace.ptx.compiler.reader import read_ptx
from nau_py.raytrace.ptx.compiler.translate import CALLABLE
from nau_py.raytrace.ptx.optix.compile import compile_all
from nau_py.raytrace.ptx.optix.variables import VariableLayout, calls_interface, uses_variables

if TYPE_CHECKING:
    from nau_py.passes.frame import Session
    from nau_py.raytrace.ptx.runtime.native import NativeModule


Modules = dict[Path, "PtxModule | PtxError | OSError"]
"""By file; or why one cannot be read."""


def find_function(module: PtxModule, name: str) -> PtxFunction | None:
    """A function of a module, by its name as it stands or as C++ spells it."""
    found = module.functions.get(name)
    if found is None or found.body is None:
        named = (f for n, f in module.functions.items() if plain_name(n) == name)
        found = next((f for f in named if f.body is not None), None)
    return found


def read_module(path: Path) -> PtxModule:
    """Raises :class:`PtxError` and OSError."""
    return read_ptx(path.read_text("utf-8", "replace"))


def modules_of(pass_: RaytracePass, folder: Path) -> Modules:
    """The modules of a pass by file, or why one cannot be read."""
    found: Modules = {}
    for program, *_ in used_programs(pass_):
        path = resolve_path(folder, program.file or "").best
        if path in found or path.suffix.lower() != COMPILED or not path.exists():
            continue
        try:
            found[path] = read_module(path)
        except (OSError, PtxError) as problem:
            found[path] = problem
    return found


class Programs:
    """Machine code of everything that a pass uses. Raises
    :class:`~nau_py.ProgramError` with what cannot be run."""

    def __init__(self, pass_: RaytracePass, session: Session) -> None:
        from nau_py.passes.tracing.programs import make_trust_rule

        self.folder = session.project.folder
        self.label = f"project '{session.project.name}'"
        self.modules: dict[Path, PtxModule] = {}
        self.natives: dict[Path, NativeModule] = {}
        for program, *_ in used_programs(pass_):
            path = self._path(program)
            if path not in self.modules:
                where, label = program.where("file"), self._label(program)
                make_trust_rule(session).check(path, where, label)
                try:
                    self.modules[path] = read_module(path)
                except (OSError, PtxError) as problem:
                    said = f"{label}: '{path.name}' cannot be read: {problem}"
                    raise ProgramError(error("T015", where, said)) from None
        self.layout = VariableLayout()
        for module in self.modules.values():
            self.layout.add_module(module)
        self.old = any(uses_variables(module) for module in self.modules.values())
        self.flushes = any(module.flushes for module in self.modules.values())

    def _path(self, program: Program) -> Path:
        return resolve_path(self.folder, program.file or "").best

    def _label(self, program: Program) -> str:
        return f"{self.label}, program '{program.proc}'"

    def native(self, program: Program) -> NativeModule:
        """The machine code of a program's module."""
        from nau_py.raytrace.ptx.runtime.native import NativeError, NativeModule

        path = self._path(program)
        if path not in self.natives:
            where, label = program.where("file"), self._label(program)
            text, errors = compile_all(self.modules[path], self.layout)
            if errors:
                said = f"{label}: {path.name}:{errors[0].line}: {errors[0]}"
                raise ProgramError(error("T015", where, said))
            try:
                self.natives[path] = NativeModule(text)
            except NativeError as problem:
                said = f"{label}: '{path.name}' gives no machine code: {problem}"
                raise ProgramError(error("T015", where, said)) from None
        return self.natives[path]

    def address(self, program: Program | None) -> int:
        """The address of a procedure; 0 for none."""
        if program is None:
            return 0
        native = self.native(program)
        path = self._path(program)
        function = find_function(self.modules[path], program.proc or "")
        if function is None:
            said = f"{self._label(program)}: '{path.name}' exports no '{program.proc}'"
            raise ProgramError(error("T004", program.where("proc"), said))
        return native.address(function.name)

    def callables(self) -> list[int]:
        """The addresses of callable programs, in the order of their files and in them."""
        return [
            native.address(name)
            for path, native in self.natives.items()
            for name, function in self.modules[path].functions.items()
            if function.body is not None and name.startswith(CALLABLE)
        ]


def module_faults(pass_: RaytracePass, modules: Modules, folder: Path) -> Iterator[Diagnostic]:
    """What of a pass's modules cannot be read or compiled."""
    label = f"pass '{pass_.name}'"
    said: set[Path] = set()
    for program, *_ in used_programs(pass_):
        path = resolve_path(folder, program.file or "").best
        module = modules.get(path)
        where = program.where("file")
        if path in said:
            continue
        if program.file and path.suffix.lower() != COMPILED:
            text = f"{label}: its programs are compiled ones, '{program.file}' is none"
            yield error("T015", where, text)
        elif module is not None:
            for line, text in _errors(module):
                yield error("T015", where, f"{label}: {path.name}:{line}: {text}")
        said.add(path)
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
            continue  # said above
        for text in wrong:
            yield error("T015", pass_.location, f"{label}: {path.name}: {text}")


def _errors(module: PtxModule | PtxError | OSError) -> list[tuple[int, str]]:
    if isinstance(module, PtxError):
        return [(module.line, str(module))]
    if isinstance(module, OSError):
        return [(1, module.strerror or str(module))]
    _, errors = compile_all(module)
    return [(e.line, str(e)) for e in errors]

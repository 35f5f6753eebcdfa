"""Machine code of the programs of a pass."""

from __future__ import annotations

from pathlib import Path

from nau_py.diagnostics.diagnostic import error
from nau_py.diagnostics.errors import ProgramError
from nau_py.model.raytrace import Program
from nau_py.raytrace.programs.used import used_programs
from nau_py.raytrace.ptx.compiler.module import PtxError, PtxModule
from nau_py.raytrace.ptx.compiler.translate import CALLABLE
from nau_py.raytrace.ptx.host.inputs import PassSetup
from nau_py.raytrace.ptx.host.modules import find_function, program_path, read_module
from nau_py.raytrace.ptx.optix.compile import compile_all
from nau_py.raytrace.ptx.optix.variables import VariableLayout, uses_variables
from nau_py.raytrace.ptx.runtime.native import NativeError, NativeModule


class CompiledPrograms:
    """Programs of a pass, each module compiled when its first address is requested.

    Raises :class:`~nau_py.ProgramError` for a file that is not trusted (T012) or cannot be read or
    compiled (T015), and for a procedure that is missing (T004).
    """

    def __init__(self, setup: PassSetup) -> None:
        self.folder = setup.project.folder
        self.label = f"project '{setup.project.name}'"
        self.modules: dict[Path, PtxModule] = {}
        self.natives: dict[Path, NativeModule] = {}
        for program, *_ in used_programs(setup.pass_):
            path = self._path(program)
            if path not in self.modules:
                where, label = program.where("file"), self._label(program)
                setup.trust.check(path, where, label)
                try:
                    self.modules[path] = read_module(path)
                except (OSError, PtxError) as problem:
                    message = f"{label}: '{path.name}' cannot be read: {problem}"
                    raise ProgramError(error("T015", where, message)) from None
        self.layout = VariableLayout()
        for module in self.modules.values():
            self.layout.add_module(module)
        self.old = any(uses_variables(module) for module in self.modules.values())
        """True for programs of OptiX 3 to 6."""
        self.flushes = any(module.flushes for module in self.modules.values())

    def _path(self, program: Program) -> Path:
        return program_path(self.folder, program.file)

    def _label(self, program: Program) -> str:
        return f"{self.label}, program '{program.proc}'"

    def native(self, program: Program) -> NativeModule:
        """Return the machine code of a program's module; compile it the first time."""
        path = self._path(program)
        if path not in self.natives:
            where, label = program.where("file"), self._label(program)
            text, errors = compile_all(self.modules[path], self.layout)
            if errors:
                message = f"{label}: {path.name}:{errors[0].line}: {errors[0]}"
                raise ProgramError(error("T015", where, message))
            try:
                self.natives[path] = NativeModule(text)
            except NativeError as problem:
                message = f"{label}: '{path.name}' gives no machine code: {problem}"
                raise ProgramError(error("T015", where, message)) from None
        return self.natives[path]

    def address(self, program: Program | None) -> int:
        """Return the address of a procedure; 0 for None."""
        if program is None:
            return 0
        native = self.native(program)
        path = self._path(program)
        function = find_function(self.modules[path], program.proc or "")
        if function is None:
            message = f"{self._label(program)}: '{path.name}' exports no '{program.proc}'"
            raise ProgramError(error("T004", program.where("proc"), message))
        return native.address(function.name)

    def callables(self) -> list[int]:
        """Return the addresses of callable programs, in the order of files and of their text."""
        return [
            native.address(name)
            for path, native in self.natives.items()
            for name, function in self.modules[path].functions.items()
            if function.body is not None and name.startswith(CALLABLE)
        ]

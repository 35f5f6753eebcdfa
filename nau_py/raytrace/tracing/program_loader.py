"""Load the ray programs of a pass, and check their results at every call."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from nau_py.diagnostics.diagnostic import error
from nau_py.diagnostics.errors import NauError, ProgramError
from nau_py.diagnostics.location import Location
from nau_py.diagnostics.suggest import format_names, suggest_name
from nau_py.model.raytrace import BUILTIN, Program
from nau_py.raytrace.kernels.core.kernel_tables import USER
from nau_py.raytrace.programs.catalogue import CODES, FUNCTIONS
from nau_py.raytrace.programs.source import stand_in, strip_decoration
from nau_py.raytrace.tracing.arrays import F32, Mask
from nau_py.raytrace.tracing.program_modules import ProgramModules


@dataclass(frozen=True, slots=True)
class BoundProgram:
    """A loaded program. ``label``: project, pass, material and procedure, for messages."""

    function: Callable[..., Any] | None
    label: str
    location: Location
    file: str
    code: int = USER
    """Code of a compiled program, which has no function; USER for a program written in Python."""

    def call(self, argument: object) -> Any:
        """Run the program. Raises :class:`~nau_py.ProgramError` for any exception of it."""
        assert self.function is not None, f"{self.label} is compiled"
        try:
            return self.function(argument)
        except NauError:
            raise
        except Exception as bug:
            where = self._find_location(bug)
            message = f"{self.label} raised {type(bug).__name__}: {bug}"
            raise ProgramError(error("T010", where, message)) from bug

    def _find_location(self, bug: Exception) -> Location:
        """Return the innermost line of the program's file or of a neighbour that it imports, else
        its place in the project."""
        frames = traceback.extract_tb(bug.__traceback__)
        folder = Path(self.file).parent
        own = [f for f in frames if Path(f.filename).parent == folder]
        if not own:
            return self.location
        return Location(own[-1].filename, own[-1].lineno or 0, (own[-1].colno or 0) + 1)

    def _result_error(self, what: str) -> ProgramError:
        """Return the error for a program that returned ``what``."""
        code = getattr(self.function, "__code__", None)
        where = self.location
        if code is not None and code.co_filename == self.file:
            where = Location(self.file, code.co_firstlineno, 1)
        return ProgramError(error("T011", where, f"{self.label} returned {what}"))

    def compute_radiance(self, argument: object, count: int) -> F32:
        """Run the program and return its result as RGBA float32 (count, 4); colours get alpha 1.

        Raises :class:`~nau_py.ProgramError` for a result of another shape.
        """
        value = self.call(argument)
        try:
            array = np.asarray(value)
            numeric = array.dtype.kind in "fiub"
        except (ValueError, TypeError):
            array, numeric = np.zeros(0), False
        if not numeric:
            raise self._result_error(
                f"{type(value).__name__}; numbers of shape ({count}, 3) are expected"
            )
        if array.shape == (3,) or array.shape == (4,):
            array = np.broadcast_to(array, (count, len(array)))
        if array.shape not in ((count, 3), (count, 4)):
            raise self._result_error(
                f"an array of shape {array.shape}; ({count}, 3) or ({count}, 4) is expected"
            )
        result = np.ones((count, 4), np.float32)
        with np.errstate(over="ignore", invalid="ignore"):
            result[:, : array.shape[1]] = array
        return result

    def decide_hits(self, argument: object, count: int) -> Mask:
        """Run an any-hit program and return bool (count,): True accepts a hit, False ignores it.

        Raises :class:`~nau_py.ProgramError` for a result of another shape or type.
        """
        value = self.call(argument)
        array = np.asarray(value)
        if array.shape != (count,) or array.dtype != np.bool_:
            raise self._result_error(
                f"an array of shape {array.shape} and type {array.dtype}; "
                f"bool of shape ({count},) is expected (True accepts the hit)"
            )
        return array


@dataclass(frozen=True, slots=True)
class TrustRule:
    """Folders and files from which programs may be loaded."""

    folders: tuple[Path, ...]
    refuse_all: bool = False
    files: tuple[Path, ...] = ()
    """Files that are trusted in any folder: those of plug-ins."""

    def check(self, path: Path, where: Location, label: str) -> None:
        """Raise :class:`~nau_py.ProgramError` for a file outside the folders."""
        if self.refuse_all:
            message = f"{label}: '{path}' is not loaded, because --no-programs was given"
            raise ProgramError(error("T012", where, message))
        real = path.resolve()
        known = real in [file.resolve() for file in self.files]
        if not known and not any(real.is_relative_to(f.resolve()) for f in self.folders):
            message = (
                f"{label}: '{path}' is outside the project's folder; "
                f"allow it with --allow-programs {real.parent}"
            )
            raise ProgramError(error("T012", where, message))


class ProgramLoader:
    """Loads the programs of one pass: built-in ones, and functions of Python files.

    ``provided``: further built-ins by kind and name, which the caller makes.
    """

    def __init__(
        self,
        folder: Path,
        trust: TrustRule,
        provided: Mapping[tuple[str, str], Callable[..., Any]] | None = None,
    ) -> None:
        self._provided = provided or {}
        self._folder = folder
        self._modules = ProgramModules(trust.check)

    def load(self, program: Program, label: str, kind: str) -> BoundProgram:
        """Return the program of ``file`` and ``proc``. Raises :class:`~nau_py.ProgramError`."""
        proc = program.proc or ""
        if program.file == BUILTIN:
            codes, functions = CODES.get(kind, {}), FUNCTIONS.get(kind, {})
            functions = functions | {n: f for (k, n), f in self._provided.items() if k == kind}
            known = [*codes, *functions]
            if proc not in known:
                message = f"{label}: there is no built-in '{proc}'; there is {format_names(known)}"
                message += suggest_name(proc, known)
                raise ProgramError(error("T006", program.where("proc"), message))
            code = codes.get(proc, USER)
            return BoundProgram(functions.get(proc), label, program.location, "", code)
        path = stand_in(self._folder, program.file or "")
        if path is None:
            message = f"{label}: there is no Python file for '{program.file}'"
            raise ProgramError(error("T005", program.where("file"), message))
        module = self._modules.load(path, program.where("file"), label)
        function = getattr(module, proc, None) or getattr(module, strip_decoration(proc), None)
        if not callable(function):
            message = f"{label}: '{path.name}' defines no function '{proc}'"
            raise ProgramError(error("T004", program.where("proc"), message))
        return BoundProgram(function, label, program.location, str(path))

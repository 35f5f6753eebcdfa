"""Python files of ray programs as modules: each file once, with the neighbours that it imports.

A program imports the modules of its own folder by their plain names. ``sys.path`` stays as it is,
and the modules have private names in ``sys.modules``: a project's ``typer.py`` never replaces the
package that nau_py imports.
"""

from __future__ import annotations

import builtins
import hashlib
import sys
import traceback
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from threading import RLock
from types import ModuleType
from typing import Any

from nau_py.diagnostics.diagnostic import error
from nau_py.diagnostics.errors import NauError, ProgramError
from nau_py.diagnostics.location import Location
from nau_py.raytrace.programs.neighbours import find_neighbour

CheckTrust = Callable[[Path, Location, str], None]
"""``check(file, place, label)`` raises :class:`~nau_py.ProgramError` for a file without trust.

The place is the element of the project or the import that names the file."""


class ProgramModules:
    """Modules of the program files of one pass. A new instance reads all files again."""

    def __init__(self, check_trust: CheckTrust) -> None:
        self._check_trust = check_trust
        self._modules: dict[Path, ModuleType] = {}
        self._lock = RLock()  # programs may import inside functions, which run on threads

    def load(self, path: Path, where: Location, label: str) -> ModuleType:
        """Return the module of a file, which is run the first time.

        ``where`` names the file; ``label``: project, pass and program, for messages. Raises
        :class:`~nau_py.ProgramError` for a file that is not trusted or does not run.
        """
        self._check_trust(path, where, label)
        with self._lock:
            module = self._modules.get(path)
            if module is None:
                module = self._run(path, where, label)
        return module

    def _run(self, path: Path, where: Location, label: str) -> ModuleType:
        """Make the module of a file and run it."""
        digest = hashlib.sha256(str(path).encode()).hexdigest()[:12]
        module = ModuleType(f"nau_py_program_{path.stem}_{digest}")
        module.__file__, module.__package__ = str(path), ""
        module.__dict__["__builtins__"] = vars(builtins) | {
            "__import__": self._make_import(path, label)
        }
        sys.modules[module.__name__] = module  # dataclasses and pickle look modules up by name
        self._modules[path] = module  # before it runs: neighbours may import each other
        try:
            # not through a loader of importlib: it writes bytecode into the project's folder, and
            # compares it with the source by size and whole seconds only
            code = compile(path.read_bytes(), str(path), "exec", dont_inherit=True)
            exec(code, module.__dict__)
        except BaseException as bug:
            del self._modules[path]
            if isinstance(bug, NauError) or not isinstance(bug, Exception):
                raise
            raise _make_error(path, where, label, bug) from bug
        return module

    def _make_import(self, path: Path, label: str) -> Callable[..., Any]:
        """Return the ``__import__`` of a program file: as Python's, with its neighbours."""
        folder = path.parent

        def import_module(
            name: str,
            globals_: Mapping[str, object] | None = None,
            locals_: Mapping[str, object] | None = None,
            fromlist: Sequence[str] | None = (),
            level: int = 0,
        ) -> Any:
            first, _, rest = name.partition(".")
            neighbour = find_neighbour(folder, first) if level == 0 else None
            if neighbour is None:
                return builtins.__import__(name, globals_, locals_, fromlist or (), level)
            if rest:
                message = f"No module named '{name}'; '{first}' is not a package"
                raise ModuleNotFoundError(message, name=name)
            line = sys._getframe(1).f_lineno
            module = self.load(neighbour, Location(str(path), line, 1), label)
            if "*" in (fromlist or ()) or all(hasattr(module, part) for part in fromlist or ()):
                return module
            missing = next(part for part in fromlist or () if not hasattr(module, part))
            raise ImportError(f"cannot import name '{missing}' from '{first}' ({neighbour})")

        return import_module


def _make_error(path: Path, where: Location, label: str, bug: Exception) -> ProgramError:
    """Return the error for a file that does not run, at its own line if there is one."""
    if isinstance(bug, SyntaxError):
        place = Location(str(path), bug.lineno or 1, bug.offset or 1)
        return ProgramError(error("T010", place, f"{label}: {bug.msg}"))
    frames = [f for f in traceback.extract_tb(bug.__traceback__) if f.filename == str(path)]
    place = Location(str(path), frames[-1].lineno or 1, 1) if frames else where
    message = f"{label}: loading '{path.name}' raised {type(bug).__name__}: {bug}"
    return ProgramError(error("T010", place, message))

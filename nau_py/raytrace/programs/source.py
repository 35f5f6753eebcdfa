"""Find and parse the source of a program without running it."""

from __future__ import annotations

import ast
import re
from functools import lru_cache
from pathlib import Path
from stat import S_ISREG

from nau_py.model.raytrace import Program, RaytracePass
from nau_py.plugins import PREFIX, program_files
from nau_py.process.paths import resolve

COMPILED = ".ptx"
_DECORATIONS = ("raygen", "closesthit", "anyhit", "miss", "exception", "intersection")


_MANGLED = re.compile(r"_Z(\d+)(\w+)")


def plain_name(name: str) -> str:
    """Return the name of an entry point without C++ mangling (Itanium C++ ABI, 5.1).

    ``_Z``, a length, the name, for a function outside of namespaces.
    """
    found = _MANGLED.match(name)
    return found[2][: int(found[1])] if found else name


def strip_decoration(proc: str) -> str:
    """Return a name without OptiX's decoration: ``radiance`` for ``__closesthit__radiance``."""
    if proc.startswith("__"):
        kind, _, rest = proc[2:].partition("__")
        if kind in _DECORATIONS and rest:
            return rest
    return proc


def stand_in(folder: Path, file: str) -> Path | None:
    """Return the Python file behind ``file``: itself, or the sibling ``x.py`` of an ``x.ptx``.

    ``plugin:NAME`` names the programs of a plug-in. Return None if there is neither.
    """
    if file.startswith(PREFIX):
        return program_files().get(file.removeprefix(PREFIX))
    found = resolve(folder, file)
    suffix = found.path.suffix.lower()
    if suffix != ".py":
        if suffix != COMPILED:
            return None
        sibling = resolve(folder, str(Path(file.replace("\\", "/")).with_suffix(".py")))
        return sibling.best if sibling.exists else None
    return found.best if found.exists else None


def parse_program(path: Path) -> ast.Module | None:
    """Parse a Python file, each version of it once. The tree is shared: do not change it.

    None if it is no regular file (a pipe would block), cannot be read or cannot be parsed.
    """
    try:
        found = path.stat()
    except OSError:
        return None
    if not S_ISREG(found.st_mode):
        return None
    return _parse_version(path, found.st_mtime_ns, found.st_size)


@lru_cache(maxsize=256)
def _parse_version(path: Path, time: int, size: int) -> ast.Module | None:
    try:
        return ast.parse(path.read_bytes(), str(path))
    except (OSError, SyntaxError, ValueError, RecursionError, MemoryError):
        return None  # the last two: an expression nested too deeply


def is_compiled(program: Program | None) -> bool:
    """Return True for a program whose file is PTX."""
    return program is not None and (program.file or "").lower().endswith(COMPILED)


def launches_ptx(pass_: RaytracePass, folder: Path, programs: str = "") -> bool:
    """Test if a pass runs compiled programs: its ray generation program is one that exists.

    ``programs``: ``py`` requests the Python files beside them instead.
    """
    entry = pass_.rtEntryPoint
    program = entry.rayGen if entry else None
    if program is None or programs == "py" or not is_compiled(program):
        return False
    return resolve(folder, program.file or "").exists

"""Plug-ins: additions of other installed packages, found by entry points.

================== ============================ ==========================================
group              name                         object
================== ============================ ==========================================
nau_py.passes      any                          a module that registers pass classes
nau_py.rules       any                          a module that registers rules
nau_py.readers     the ending, as in ``.tri``   a function of a path, which returns objects
                                                and materials (:mod:`nau_py.scene.readers.registry`)
nau_py.programs    the name behind ``plugin:``  a module of ray programs
================== ============================ ==========================================

A plug-in that cannot be loaded is left out; lint reports it (rule E005).
"""

from __future__ import annotations

from functools import lru_cache
from importlib.metadata import EntryPoint, entry_points
from importlib.util import find_spec
from pathlib import Path
from typing import Any

PASSES, RULES, READERS, PROGRAMS = (
    "nau_py.passes", "nau_py.rules", "nau_py.readers", "nau_py.programs",
)  # fmt: skip
PREFIX = "plugin:"
"""Prefix of a ``file`` that names the ray programs of a plug-in."""


@lru_cache(maxsize=1)
def _entries() -> list[EntryPoint]:
    """Return the entry points of nau_py's groups; cached, since reading all packages is slow."""
    groups = (PASSES, RULES, READERS, PROGRAMS)
    everything = entry_points()
    return [entry for group in groups for entry in everything.select(group=group)]


_failures: dict[tuple[str, str], str] = {}


@lru_cache(maxsize=8)
def load_plugins(group: str) -> dict[str, Any]:
    """Load the plug-ins of a group, once a process; return name to object."""
    found: dict[str, Any] = {}
    for entry in (e for e in _entries() if e.group == group):
        try:
            found[entry.name] = entry.load()
        except Exception as problem:
            _failures[group, entry.name] = (
                f"{_describe(entry)}: {type(problem).__name__}: {problem}"
            )
    return found


def _describe(entry: EntryPoint) -> str:
    package = f" of package '{entry.dist.name}'" if entry.dist is not None else ""
    return f"plug-in '{entry.name}' ({entry.value}, group {entry.group}){package} cannot be loaded"


def failures() -> list[str]:
    """Return a message for each plug-in that could not be loaded so far."""
    return list(_failures.values())


@lru_cache(maxsize=1)
def program_files() -> dict[str, Path]:
    """Return name to file of the plug-ins' ray programs, without loading them."""
    found: dict[str, Path] = {}
    for entry in (e for e in _entries() if e.group == PROGRAMS):
        try:
            spec = find_spec(entry.module)
        except (ImportError, ValueError) as problem:
            _failures[PROGRAMS, entry.name] = f"{_describe(entry)}: {problem}"
            continue
        if spec is None or spec.origin is None:
            _failures[PROGRAMS, entry.name] = f"{_describe(entry)}: there is no such module"
        else:
            found[entry.name] = Path(spec.origin)
    return found

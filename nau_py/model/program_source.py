"""Where the source of a program is, without running it."""

from __future__ import annotations

from pathlib import Path

from nau_py.paths import resolve
from nau_py.plugins import PREFIX, program_files

_DECORATIONS = ("raygen", "closesthit", "anyhit", "miss", "exception", "intersection")


def strip_decoration(proc: str) -> str:
    """``__closesthit__radiance`` without OptiX's decoration: ``radiance``."""
    if proc.startswith("__"):
        kind, _, rest = proc[2:].partition("__")
        if kind in _DECORATIONS and rest:
            return rest
    return proc


def stand_in(folder: Path, file: str) -> Path | None:
    """The Python file behind ``file``: itself, or the sibling ``x.py`` of an ``x.ptx``.

    ``plugin:NAME`` names the programs of a plug-in. None where there is neither.
    """
    if file.startswith(PREFIX):
        return program_files().get(file.removeprefix(PREFIX))
    found = resolve(folder, file)
    suffix = found.path.suffix.lower()
    if suffix != ".py":
        if suffix != ".ptx":
            return None
        sibling = resolve(folder, str(Path(file.replace("\\", "/")).with_suffix(".py")))
        return sibling.best if sibling.exists else None
    return found.best if found.exists else None

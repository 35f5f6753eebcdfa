"""Entry points of a compiled program file, read from its text. Nothing is executed.

NVIDIA's *PTX ISA*, section 11.6: entry points are ``.visible .entry NAME(``.
"""

from __future__ import annotations

import re
from pathlib import Path

from nau_py.raytrace.programs.source import plain_name

_ENTRY = re.compile(rb"^\s*\.visible\s+\.entry\s+([\w$]+)", re.MULTILINE)
_KINDS = {
    "raygen": "ray generation",
    "anyhit": "any hit",
    "closesthit": "closest hit",
    "miss": "miss",
    "intersection": "intersection",
    "exception": "exception",
}


def read_exports(path: Path) -> list[str] | None:
    """Return the names of the entry points in file order, as C++ spells them.

    None where the file cannot be read.
    """
    try:
        data = path.read_bytes()
    except OSError:
        return None
    return [plain_name(found.decode()) for found in _ENTRY.findall(data)]


def program_kind(name: str) -> str:
    """Return the kind that OptiX 7 puts into a name, as in ``__anyhit__shadow``; else empty."""
    return _KINDS.get(name.split("__")[1], "") if name.startswith("__") else ""

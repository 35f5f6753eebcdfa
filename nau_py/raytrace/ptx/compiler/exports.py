"""What a compiled ray program file exports, read from its text: nothing is executed.

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


def exports(path: Path) -> list[str] | None:
    """Names of the entry points in file order, as C++ spells them; None: it cannot be read."""
    try:
        data = path.read_bytes()
    except OSError:
        return None
    return [plain_name(found.decode()) for found in _ENTRY.findall(data)]


def kind_of(name: str) -> str:
    """The kind that OptiX 7 writes into a name, as in ``__anyhit__shadow``; empty where it has
    none."""
    return _KINDS.get(name.split("__")[1], "") if name.startswith("__") else ""

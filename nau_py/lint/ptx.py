"""What a compiled ray program file exports, read from its text: nothing is executed.

NVIDIA's *PTX ISA*, section 11.6: entry points are ``.visible .entry NAME(``.
"""

from __future__ import annotations

import re
from pathlib import Path

_ENTRY = re.compile(rb"^\s*\.visible\s+\.entry\s+([\w$]+)", re.MULTILINE)
_MANGLED = re.compile(r"_Z(\d+)(\w+)")
_KINDS = {
    "raygen": "ray generation",
    "anyhit": "any hit",
    "closesthit": "closest hit",
    "miss": "miss",
    "intersection": "intersection",
    "exception": "exception",
}


def exports(path: Path) -> list[str] | None:
    """Names of the entry points in file order, as C++ spells them; None where it cannot be read.

    Itanium C++ ABI, 5.1: ``_Z``, a length, and the name for a function outside of namespaces.
    """
    try:
        data = path.read_bytes()
    except OSError:
        return None
    return [_plain(found.decode()) for found in _ENTRY.findall(data)]


def _plain(name: str) -> str:
    found = _MANGLED.match(name)
    return found[2][: int(found[1])] if found else name


def kind_of(name: str) -> str:
    """The kind that OptiX 7 writes into a name, as in ``__anyhit__shadow``; empty where it has
    none."""
    return _KINDS.get(name.split("__")[1], "") if name.startswith("__") else ""

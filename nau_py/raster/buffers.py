"""Buffers of material libraries: size and initial content (docs/format.md, 6.6)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from nau_py.model.buffer import Buffer
from nau_py.model.linked import Project
from nau_py.process.paths import resolve

_BASE_TYPES: dict[str, tuple[type[np.generic], int]] = {
    "INT": (np.int32, 1),
    "UINT": (np.uint32, 1),
    "BOOL": (np.uint32, 1),
    "FLOAT": (np.float32, 1),
    "DOUBLE": (np.float64, 1),
    "BYTE": (np.int8, 1),
    "UBYTE": (np.uint8, 1),
    "SHORT": (np.int16, 1),
    "USHORT": (np.uint16, 1),
}
_PREFIXES = {"IVEC": "INT", "UIVEC": "UINT", "BVEC": "BOOL", "VEC": "FLOAT", "DVEC": "DOUBLE"}


def list_scalar_types(name: str) -> list[type[np.generic]]:
    """List the scalar types of ``name``: vectors and matrices expanded, empty if unknown."""
    if name in _BASE_TYPES:
        return [_BASE_TYPES[name][0]]
    for prefix, base in _PREFIXES.items():
        if name.startswith(prefix) and name[len(prefix) :].isdigit():
            return [_BASE_TYPES[base][0]] * int(name[len(prefix) :])
    if name.startswith(("MAT", "DMAT")):
        columns, _, rows = name.split("MAT")[1].partition("x")
        scalar = _BASE_TYPES["DOUBLE" if name.startswith("D") else "FLOAT"][0]
        return [scalar] * (int(columns) * int(rows or columns))
    return []


def list_record_types(buffer: Buffer) -> list[type[np.generic]]:
    """List the scalar types of one record, in order."""
    return [basic for entry in buffer.structure for basic in list_scalar_types(entry.value or "")]


def compute_record_size(buffer: Buffer) -> int:
    """Compute the size of one record in bytes."""
    return sum(np.dtype(t).itemsize for t in list_record_types(buffer))


def read_initial_content(project: Project, buffer: Buffer) -> bytes:
    """Read the initial bytes of a buffer: its file, then zeros up to SIZE or DIM.

    Text files hold numbers in the order of the record's scalar types. Raises :class:`ValueError`
    for text that is not a number, and :class:`OSError` for a file that cannot be read.
    """
    size = int(project.value(buffer, "BUFFER", "SIZE")[0])
    if "DIM" in buffer.settings:
        x, y, z = (int(v) for v in project.value(buffer, "BUFFER", "DIM"))
        size = x * y * z * compute_record_size(buffer)
    data = b""
    if buffer.file is not None and buffer.file.name:
        folder = Path(buffer.location.file).parent
        path = resolve(folder, buffer.file.name).best
        data = path.read_bytes()
        if path.suffix.lower() != ".nbb":
            types = list_record_types(buffer) or [np.float32]
            words = data.split()
            data = b"".join(
                np.array(word.decode(), types[i % len(types)]).tobytes()
                for i, word in enumerate(words)
            )
    return data.ljust(size, b"\0")

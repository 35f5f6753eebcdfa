"""Volumes of VTK's legacy format (docs/format.md, 6.3; *VTK File Formats*, "Simple Legacy")."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.scene.images import ImageError

TYPES = {"unsigned_char": ">u1", "unsigned_short": ">u2", "float": ">f4"}
"""Data types that a texture can hold, and their form in binary files."""


def is_volume(path: Path) -> bool:
    """Decide by the file's name if it holds a volume."""
    return path.suffix.lower() == ".vtk"


def load_volume(path: Path) -> NDArray[Any]:
    """Load texels (depth, height, width), uint8, uint16 or float32: x runs fastest.

    The data set must be ``STRUCTURED_POINTS`` with one scalar per point. Raises
    :class:`~nau_py.scene.images.ImageError`.
    """
    try:
        data = path.read_bytes()
    except OSError as problem:
        raise ImageError(str(problem)) from None
    lines = data.split(b"\n", 2)
    if len(lines) < 3 or not lines[0].lower().startswith(b"# vtk"):
        raise ImageError("it does not begin as a VTK file does, with '# vtk DataFile Version'")
    header, rest = _split_header(lines[2])
    if header.get("DATASET") != ["STRUCTURED_POINTS"]:
        held = " ".join(header.get("DATASET", ["none"]))
        raise ImageError(f"its data set is '{held}'; STRUCTURED_POINTS makes a texture")
    type_ = (header.get("SCALARS") or ["", ""])[1:2]
    if not type_ or type_[0] not in TYPES or header["SCALARS"][2:] not in ([], ["1"]):
        held = " ".join(header.get("SCALARS", ["none"]))
        raise ImageError(f"its SCALARS are '{held}'; one of {', '.join(TYPES)} makes a texture")
    dtype = np.dtype(TYPES[type_[0]])
    try:
        width, height, depth = (int(v) for v in header.get("DIMENSIONS", []))
        count = width * height * depth
        if header["_"] == ["ASCII"]:
            found = np.array(rest.split()[:count], dtype)
        else:
            found = np.frombuffer(rest[: count * dtype.itemsize], dtype)
    except ValueError as problem:
        raise ImageError(f"it cannot be decoded: {problem}") from None
    if count < 1 or len(found) != count:
        raise ImageError(f"it holds {len(found)} of {width} x {height} x {depth} points")
    return found.astype(dtype.newbyteorder("=")).reshape(depth, height, width)


def _split_header(data: bytes) -> tuple[dict[str, list[str]], bytes]:
    """Split off the lines up to LOOKUP_TABLE, by first word; ``_`` is the encoding."""
    found: dict[str, list[str]] = {}
    line, _, rest = data.partition(b"\n")
    found["_"] = line.decode("latin-1").split()
    while rest and "LOOKUP_TABLE" not in found:
        line, _, rest = rest.partition(b"\n")
        words = line.decode("latin-1").split()
        if words:
            found[words[0].upper()] = words[1:]
    return found, rest

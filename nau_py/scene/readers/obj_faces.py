"""Faces of an OBJ file as corner indices, triangulated as fans."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nau_py.scene.readers.model_error import ModelError

I64 = NDArray[np.int64]
Counts = tuple[int, int, int]
"""Numbers of v, vt and vn lines."""


@dataclass(slots=True)
class Triangles:
    """Triangles of a file.

    ``corners`` (m, 3, 3): v, vt, vn indices from 0, or -1 if absent; ``face`` (m,): its face.
    """

    corners: I64
    face: I64


def _parse_corner(token: bytes, counts: Counts, line: int) -> Counts:
    parts = token.split(b"/")
    found = [-1, -1, -1]
    text = token.decode("latin-1")
    for slot, part in enumerate(parts[:3]):
        if not part:
            continue
        try:
            index = int(part)
        except ValueError:
            raise ModelError(f"face corner '{text}' is no index", line) from None
        index = index - 1 if index > 0 else counts[slot] + index
        if not 0 <= index < counts[slot]:
            raise ModelError(
                f"face corner '{text}' names vertex {part.decode()} of {counts[slot]}", line
            )
        found[slot] = index
    return found[0], found[1], found[2]


def _parse_each(lines: list[bytes], numbers: list[int], counts: list[Counts]) -> tuple[I64, I64]:
    """Parse corners one by one: any mixture of forms, negative indices, exact errors."""
    corners: list[Counts] = []
    sizes: list[int] = []
    for line, number, at in zip(lines, numbers, counts):
        tokens = line.split()[1:]
        sizes.append(len(tokens))
        corners += [_parse_corner(token, at, number + 1) for token in tokens]
    return np.array(corners, np.int64).reshape(-1, 3), np.array(sizes, np.int64)


def _parse_uniform(lines: list[bytes], counts: Counts) -> tuple[I64, I64] | None:
    """Parse corners at once if all have one form and positive indices; else return None."""
    sizes = np.array([len(line.split()) - 1 for line in lines], np.int64)
    text = b" ".join(line.lstrip()[1:] for line in lines)
    total, slashes = int(sizes.sum()), text.count(b"/")
    if b"//" in text or b"-" in text or slashes not in (0, total, 2 * total):
        return None
    width = slashes // total + 1 if total else 1
    try:
        flat = np.array(text.replace(b"/", b" ").split(), "S20").astype(np.int64)
    except ValueError:
        return None
    if len(flat) != total * width:
        return None
    corners = np.full((total, 3), -1, np.int64)
    corners[:, :width] = flat.reshape(-1, width) - 1
    for slot in range(width):
        if corners[:, slot].min(initial=0) < 0 or corners[:, slot].max(initial=-1) >= counts[slot]:
            return None
    return corners, sizes


def read_faces(
    lines: list[bytes], numbers: list[int], counts: list[Counts], last: Counts
) -> Triangles:
    """Triangulate the ``f`` lines. ``counts``: vertices before each line; ``last``: in all.

    Raises :class:`~nau_py.scene.readers.model_error.ModelError` with the line of a wrong corner.
    """
    found = _parse_uniform(lines, last)
    corners, sizes = found if found is not None else _parse_each(lines, numbers, counts)
    first = np.concatenate([[0], np.cumsum(sizes)[:-1]]) if len(sizes) else sizes
    fans = np.maximum(sizes - 2, 0)
    face = np.repeat(np.arange(len(sizes)), fans)
    step = np.arange(len(face)) - np.repeat(np.cumsum(fans) - fans, fans)
    start = first[face] if len(face) else face
    picked = np.stack([start, start + step + 1, start + step + 2], axis=1).astype(np.int64)
    return Triangles(corners[picked].reshape(-1, 3, 3), face)

"""Marks of a guarded run: a file shared with the process that supervises it.

The file has ``2 * SLOTS`` words of 64 bits. The first half is text, the name of the pass that runs;
the second half has the launch indices that threads work at, -1 for none. The supervising process
reads it after a crash or a time-out, and names the place in its report.
"""

from __future__ import annotations

import os

import numpy as np
from numpy.typing import NDArray

MARKS = "NAU_PTX_MARKS"
"""Environment variable with the path of the file."""
SLOTS = 64
"""Words of each half of the file."""


def open_marks(label: str, width: int) -> NDArray[np.int64] | None:
    """Open the marks of a supervised run and write their text; None where nothing supervises.

    ``label``: subject of the supervisor's message; ``width``: launch indices of a row, 0 where an
    index has no place in a picture. Returns the words of the launch indices, int64 (SLOTS).
    """
    path = os.environ.get(MARKS)
    if not path:
        return None
    words = np.memmap(path, np.int64, "r+", shape=(2 * SLOTS,))
    text = f"{width}\n{label}".encode()[: 8 * SLOTS]
    words[:SLOTS] = np.frombuffer(text.ljust(8 * SLOTS, b"\0"), np.int64)
    words[SLOTS:] = -1
    return words[SLOTS:]

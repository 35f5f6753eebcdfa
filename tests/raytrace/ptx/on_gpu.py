"""Runs ``data/instructions.cu`` on an NVIDIA card: ``python on_gpu.py instructions.ptx h200.npz``.

The PTX is that of ``nvcc -arch=compute_75 -DGPU --ptx``. Needs CuPy.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

import numpy as np

COUNT = 1024
_SPECIAL = [
    0.0, -0.0, 1.0, -1.0, 0.5, 3.75, -2.25, 1e-40, -1e-45, 3e38, -3e38, np.inf, -np.inf, np.nan,
    1e-20, 123456.789, np.pi / 2, -88.0,
]  # fmt: skip


def inputs() -> dict[str, np.ndarray[Any, Any]]:
    """Return the inputs of the kernels by member of their parameters.

    Special values in pairs come first, then random values, then random bits.
    """
    chance = np.random.default_rng(5)
    special = np.array(_SPECIAL, np.float32)
    pairs = len(special) ** 2

    def floats(first: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
        bits = chance.integers(0, 2**32, COUNT - pairs - 400, dtype=np.uint32).view(np.float32)
        plain = np.concatenate([chance.normal(size=300), 100 * chance.normal(size=100)])
        return np.concatenate([first, plain.astype(np.float32), bits])

    words = np.array([0, 1, -1, 2**31 - 1, -(2**31), 255, 256, -7, 31, 33], np.int64)
    rest = COUNT - len(words) ** 2
    a, b = floats(np.repeat(special, len(special))), floats(np.tile(special, len(special)))
    ia = np.concatenate([np.tile(words, 10), chance.integers(-(2**31), 2**31, rest)])
    ib = np.concatenate([np.repeat(words, 10), chance.integers(-(2**31), 2**31, rest)])
    with np.errstate(invalid="ignore"):
        wide = a.astype(np.float64) * 1.0000000001
    la = chance.integers(-(2**63), 2**63 - 1, COUNT, dtype=np.int64)
    return {
        "a": a, "b": b, "ia": ia.astype(np.int32), "ib": ib.astype(np.int32), "da": wide, "la": la,
    }  # fmt: skip


ORDER = ("a", "b", "f", "ia", "ib", "i", "da", "d", "la", "l")
"""Members of the kernels' parameters; the letter of an output begins the names of its kernels."""
OUTPUTS = {"f": np.float32, "i": np.int32, "d": np.float64, "l": np.int64}


def main() -> None:
    import cupy

    file, out = Path(sys.argv[1]), Path(sys.argv[2])
    names = re.findall(r"\.visible \.entry (\w+)", file.read_text())
    module = cupy.RawModule(path=str(file))
    given = {name: cupy.asarray(values) for name, values in inputs().items()}
    found = {}
    for name in names:
        written = {letter: cupy.zeros(COUNT, type_) for letter, type_ in OUTPUTS.items()}
        places = np.array([(given | written)[m].data.ptr for m in ORDER], np.uint64)
        module.get_global("optixLaunchParams").copy_from_host(places.ctypes.data, places.nbytes)
        module.get_function(name)((COUNT // 128,), (128,), ())
        found[name] = cupy.asnumpy(written[name[0]])
    np.savez_compressed(out, **found)


if __name__ == "__main__":
    main()

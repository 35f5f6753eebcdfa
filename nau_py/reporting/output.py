"""Pictures and targets to files."""

from __future__ import annotations

import io
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.diagnostics.diagnostic import error
from nau_py.diagnostics.errors import OutputError
from nau_py.diagnostics.location import NOWHERE
from nau_py.process.files import write_bytes
from nau_py.reporting.pixels import encode_png

ENDINGS = (".png", ".exr", ".npy")


def _failed(path: Path, why: str) -> OutputError:
    return OutputError(error("E002", NOWHERE, f"output '{path}' cannot be written: {why}"))


def _npy(image: NDArray[Any]) -> bytes:
    stream = io.BytesIO()
    np.save(stream, image)
    return stream.getvalue()


def exr(path: Path, image: NDArray[Any]) -> bytes:
    """Encode an EXR file; ``path`` is for the message. Raises
    :class:`~nau_py.OutputError` without the extra."""
    try:
        import OpenEXR  # type: ignore[import-not-found,unused-ignore]
    except ImportError:
        raise _failed(path, "EXR needs the extra: pip install 'nau_py[exr]'") from None

    values = image.astype(np.float32)
    if image.dtype == np.uint8:
        values /= 255
    names = "RGBA"[: values.shape[2]]
    channels = {name: np.ascontiguousarray(values[:, :, i]) for i, name in enumerate(names)}
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "image.exr"
        OpenEXR.File(header, channels).write(str(file))
        return file.read_bytes()


def check_output(path: Path) -> None:
    """Raise :class:`~nau_py.OutputError` early for a path that cannot be written."""
    if path.suffix.lower() not in ENDINGS:
        raise _failed(path, f"its ending must be one of {', '.join(ENDINGS)}")
    if not path.parent.is_dir():
        raise _failed(path, f"the folder '{path.parent}' does not exist")
    if path.is_dir():
        raise _failed(path, "it is a folder")


def write_image(path: Path, image: NDArray[Any]) -> None:
    """Write a picture, rows from the top, whole or not at all. The ending chooses the format.

    Raises :class:`~nau_py.OutputError`.
    """
    check_output(path)
    ending = path.suffix.lower()
    if ending == ".exr":
        data = exr(path, image)
    else:
        data = encode_png(image) if ending == ".png" else _npy(image)
    try:
        write_bytes(path, data)
    except OSError as problem:
        raise _failed(path, problem.strerror or str(problem)) from None


def write_targets(folder: Path, targets: dict[str, NDArray[Any]]) -> None:
    """Write every target as NAME.npy, and as NAME.png to look at."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        raise _failed(folder, problem.strerror or str(problem)) from None
    for name, values in targets.items():
        stem = "".join(c if c.isalnum() or c in "-_." else "_" for c in name.replace("::", "."))
        write_image(folder / f"{stem}.npy", values)
        write_image(folder / f"{stem}.png", values)

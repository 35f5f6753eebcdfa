"""Pictures and targets to files."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from nau_py.diagnostics.diagnostic import error
from nau_py.diagnostics.errors import OutputError
from nau_py.diagnostics.location import NOWHERE
from nau_py.process.files import write_bytes

ENDINGS = (".png", ".exr", ".npy")


def _failed(path: Path, why: str) -> OutputError:
    return OutputError(error("E002", NOWHERE, f"output '{path}' cannot be written: {why}"))


def to_bytes8(image: NDArray[Any]) -> NDArray[np.uint8]:
    """8-bit values of an image: 8-bit ones as they are, floats clamped to 0..1."""
    if image.dtype == np.uint8:
        return image
    values = np.nan_to_num(image.astype(np.float64), nan=0.0, posinf=1.0, neginf=0.0)
    if image.dtype.kind in "iu":
        values /= float(np.iinfo(image.dtype).max)
    return np.asarray(np.rint(np.clip(values, 0, 1) * 255), np.uint8)


def png(image: NDArray[Any]) -> bytes:
    """A PNG of a picture, rows from the top."""
    pixels = to_bytes8(image)
    channels = pixels.shape[2] if pixels.ndim == 3 else 1
    if channels == 2:
        pixels = np.concatenate([pixels, np.zeros_like(pixels[:, :, :1])], axis=2)
    pixels = pixels[:, :, 0] if channels == 1 and pixels.ndim == 3 else pixels[..., :3]
    stream = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(pixels)).save(stream, "PNG")
    return stream.getvalue()


def _npy(image: NDArray[Any]) -> bytes:
    stream = io.BytesIO()
    np.save(stream, image)
    return stream.getvalue()


def exr(path: Path, image: NDArray[Any]) -> bytes:
    """An EXR file's bytes; ``path`` is for the message. Raises
    :class:`~nau_py.OutputError` without the extra."""
    try:
        import OpenEXR  # type: ignore[import-not-found,unused-ignore]
    except ImportError:
        raise _failed(path, "EXR needs the extra: pip install 'nau_py[exr]'") from None
    import tempfile

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
        data = png(image) if ending == ".png" else _npy(image)
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

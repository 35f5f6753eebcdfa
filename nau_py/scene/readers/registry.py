"""The registry of model readers: one call that registers, one table.

:mod:`nau_py.scene.readers.loading` registers the built-in readers and those of plug-ins.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias, TypeVar

from nau_py.scene.mesh import SceneObject
from nau_py.scene.readers.model_material import ModelMaterial

Model: TypeAlias = tuple[list[SceneObject], list[ModelMaterial]]
"""Objects and materials of a model file."""
ReadModel: TypeAlias = Callable[[Path], Model]
"""Reads a file, and raises :class:`~nau_py.scene.readers.model_error.ModelError`."""
ReadSwapped: TypeAlias = Callable[[Path, bool], Model]
"""The same, and exchanges the y and z axes if the second argument is True."""
READERS: dict[str, ReadSwapped] = {}
"""Readers by the ending of the file, in lower case, as in ``.obj``."""
R = TypeVar("R", bound=ReadModel)
S = TypeVar("S", bound=ReadSwapped)


def register_reader(*suffixes: str) -> Callable[[R], R]:
    """Register a reader for files with one of these endings. The first one of an ending stays.

    SWAP_YZ of the scene has no effect on such files, as in Nau.
    """

    def register(read: R) -> R:
        for suffix in suffixes:
            READERS.setdefault(suffix, lambda path, swap_yz: read(path))
        return read

    return register


def register_swapping_reader(*suffixes: str) -> Callable[[S], S]:
    """Register a reader that obeys SWAP_YZ of the scene."""

    def register(read: S) -> S:
        for suffix in suffixes:
            READERS.setdefault(suffix, read)
        return read

    return register

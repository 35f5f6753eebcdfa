"""Registration of all model readers: the built-in ones, one module a format, and plug-ins."""

from __future__ import annotations

from pathlib import Path

from nau_py import plugins
from nau_py.scene.readers.assimp import load_assimp
from nau_py.scene.readers.model_error import ModelError
from nau_py.scene.readers.nbo import load_nbo
from nau_py.scene.readers.obj import read_obj
from nau_py.scene.readers.ogre import load_ogre
from nau_py.scene.readers.patch import read_patch
from nau_py.scene.readers.registry import (
    READERS,
    Model,
    register_reader,
    register_swapping_reader,
)

register_reader(".obj")(read_obj)
register_reader(".nbo", ".cbo")(load_nbo)
register_reader(".xml")(load_ogre)
register_reader(".patch")(read_patch)
register_swapping_reader(
    ".3ds", ".dae", ".fbx", ".blend", ".ply", ".lwo", ".stl", ".cob", ".scn", ".gltf", ".glb"
)(load_assimp)


def list_suffixes() -> list[str]:
    """List the endings of the model files that can be read: built-in ones, then plug-ins'."""
    for suffix, read in plugins.load_plugins(plugins.READERS).items():
        register_reader(suffix)(read)
    return list(READERS)


def read_model(path: Path, swap_yz: bool) -> Model:
    """Read a model file. Raises :class:`ModelError`, also for an unknown ending."""
    suffix = path.suffix.lower()
    if suffix not in READERS and suffix not in list_suffixes():
        known = ", ".join(READERS)
        raise ModelError(f"its format '{suffix}' is not supported (supported: {known})")
    return READERS[suffix](path, swap_yz)

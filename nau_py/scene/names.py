"""Names of the materials of models, read without building geometry."""

from __future__ import annotations

import re
from pathlib import Path

from nau_py.model.linked import Project
from nau_py.process.paths import resolve
from nau_py.scene.readers.model_error import ModelError
from nau_py.scene.readers.model_material import OBJ_MATERIAL, PRIMITIVE_MATERIAL
from nau_py.scene.readers.mtl import load_mtl

_LIBRARY = re.compile(rb"^[ \t]*m\w*[ \t]+(.+?)[ \t\r]*$", re.MULTILINE)


def list_default_materials(project: Project) -> frozenset[str] | None:
    """List the names in the default library: built in, of primitives, and of OBJ models.

    Return None if a model has another format, because only loading it gives its names.
    """
    names = set(project.default_materials()) | {PRIMITIVE_MATERIAL}
    for scene in project.assets.scenes:
        if scene.folders or scene.terrain or scene.buffers:
            return None
        names |= {g.material for g in scene.geometry if g.material}
        files = [scene.filename] if scene.filename else [f.name for f in scene.files]
        for file in files:
            found = resolve(Path(scene.location.file).parent, file or "")
            if not found.exists or found.path.suffix.lower() != ".obj":
                return None
            names |= _obj_names(found.best)
    return frozenset(names)


def _obj_names(path: Path) -> set[str]:
    libraries = _LIBRARY.findall(path.read_bytes())
    if not libraries:
        return {OBJ_MATERIAL}
    names: set[str] = set()
    for library in libraries:
        try:
            names |= {m.name for m in load_mtl(path, library.decode("utf-8", "replace"))}
        except ModelError:
            continue
    return names

"""The files that a project uses."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from nau_py.model.linked import Project
from nau_py.model.node import Node
from nau_py.model.schema import schema_of
from nau_py.model.walk import walk_nodes
from nau_py.process.paths import resolve
from nau_py.raytrace.programs.source import stand_in

SHADER, PROGRAM, PROJECT, MODEL = "shader", "program", "project", "model"
_SIBLINGS = {"script": (".lua",), PROGRAM: (".py",)}
"""Kinds of files that may read others of their folder, with these endings."""
_BESIDE_MODELS = (
    ".mtl", ".material", ".bin", ".skeleton", ".png", ".jpg", ".jpeg", ".tga", ".tif", ".tiff",
    ".bmp", ".gif", ".webp",
)  # fmt: skip
"""Endings of files that models of unknown formats may refer to."""
_WORD = re.compile(r"^\s*(?:mtllib|map_\w+|bump|disp|decal|refl|norm)\s+(.+?)\s*$", re.MULTILINE)


def used_files(project: Project) -> dict[Path, str]:
    """Return path to kind of every file that a picture depends on, existing or not.

    ``project``: the project and its libraries; else the kind of the attribute that names the file.
    The material files and textures of models are included.
    """
    found = {Path(p).resolve(): PROJECT for p in project.sources}
    found[project.path.resolve()] = PROJECT
    for node in walk_nodes(project):
        for kind, path in _named(project, node):
            found.setdefault(path.resolve(), kind)
            for other in _related(path.resolve(), kind):
                found.setdefault(other, kind)
    return found


def _named(project: Project, node: Node) -> Iterator[tuple[str, Path]]:
    """Yield (kind, path) of the files that a node names."""
    for attribute in schema_of(type(node)).attributes:
        value = attribute.of(node)
        if not attribute.file or not isinstance(value, str):
            continue
        if attribute.file == PROGRAM:
            path = stand_in(project.folder, value)
            if path is not None:
                yield PROGRAM, path
            continue
        folder = Path(node.where(attribute.name).file or ".").parent
        yield attribute.file, resolve(folder, value).best


def _related(path: Path, kind: str) -> Iterator[Path]:
    """Yield the files that a file refers to."""
    if kind == "folder":
        yield from (p for p in path.rglob("*") if p.is_file())
    elif kind == MODEL and path.suffix.lower() == ".obj":
        for material in _referenced(path):
            yield material
            yield from _referenced(material)
    elif kind == MODEL:
        yield from _of_endings(path.parent, _BESIDE_MODELS)
    elif kind in _SIBLINGS:
        yield from _of_endings(path.parent, _SIBLINGS[kind])


def _referenced(path: Path) -> Iterator[Path]:
    """Yield the material files of an OBJ file, or the images of an MTL file."""
    try:
        text = path.read_text("utf-8", "replace")
    except OSError:
        return
    for words in _WORD.findall(text):
        for name in (words, words.split()[-1]):  # options may precede it
            yield resolve(path.parent, name).best.resolve()


def _of_endings(folder: Path, endings: tuple[str, ...]) -> Iterator[Path]:
    yield from (p for p in folder.rglob("*") if p.suffix.lower() in endings and p.is_file())

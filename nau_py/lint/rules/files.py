"""F: files that a project names."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from nau_py.diagnostic import Diagnostic, listing
from nau_py.lint.rule import ERROR, NOTE, WARNING, Facts, check, rule
from nau_py.lint.walk import nodes
from nau_py.model.location import Location
from nau_py.model.node import Attr, file_key
from nau_py.paths import resolve, similar

F001 = rule(
    "F001",
    ERROR,
    "Missing file",
    "The file that is named does not exist. Paths are relative to the file that names them.",
    "<file name='plasa.obj'/>",
    "<file name='plaza.obj'/>",
)
F002 = rule(
    "F002",
    WARNING,
    "Wrong letter case",
    "The file exists under a name that differs in letter case; only Windows finds it as written.",
    "<file name='Plaza.OBJ'/>",
    "<file name='plaza.obj'/>",
)
F003 = rule(
    "F003",
    NOTE,
    "Backslash in a path",
    "Backslashes are read as slashes; slashes work on every system.",
    r"<file name='..\models\plaza.obj'/>",
    "<file name='../models/plaza.obj'/>",
)
F004 = rule(
    "F004",
    WARNING,
    "Texture file missing or unreadable",
    "Nau draws without the texture, silently.",
    "<texture name='wood' filename='wod.png'/>",
    "<texture name='wood' filename='wood.png'/>",
)
_SOFT = {"texture": F004}


@check
def files(facts: Facts) -> Iterator[Diagnostic]:
    """Every attribute that is a path, but those of ray programs (T)."""
    for node in nodes(facts.project):
        for name, marker in node.markers().items():
            if not isinstance(marker, Attr) or not marker.file or marker.file == "program":
                continue
            value = getattr(node, name)
            if isinstance(value, str):
                key = file_key(name, marker)
                yield from _path(value, marker.file, node.where(key), f"'{key}' of <{node.tag}>")


def _path(text: str, kind: str, where: Location, what: str) -> Iterator[Diagnostic]:
    found = resolve(Path(where.file).parent, text)
    if not found.exists:
        near = similar(found)
        hint = f" (did you mean {listing(near)}?)" if near else ""
        message = f"{what}: the {kind} file '{text}' does not exist: {found.path}{hint}"
        yield _SOFT.get(kind, F001).at(where, message)
        return
    if found.wrong_case:
        yield F002.at(
            where, f"{what}: '{text}' differs in letter case from '{found.best.name}' on disk"
        )
    if "\\" in text:
        slashed = text.replace("\\", "/")
        yield F003.at(where, f"{what}: '{text}' has backslashes; '{slashed}' works everywhere")

"""F: files that a project names."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from nau_py.diagnostics.catalogue import ERROR, NOTE, WARNING, rule
from nau_py.diagnostics.diagnostic import Change, Diagnostic, Fix, Part
from nau_py.diagnostics.location import Location
from nau_py.diagnostics.suggest import format_names
from nau_py.model.schema import schema_of
from nau_py.model.walk import walk_nodes
from nau_py.process.paths import resolve, similar
from nau_py.rules.registry import LintContext, check

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
def check_files(context: LintContext) -> Iterator[Diagnostic]:
    """Check every attribute that is a path, except those of ray programs (T)."""
    for node in walk_nodes(context.project):
        for attribute in schema_of(type(node)).attributes:
            value = attribute.of(node)
            if attribute.file in ("", "program") or not isinstance(value, str):
                continue
            key = attribute.name
            yield from _path(value, attribute.file, node.where(key), f"'{key}' of <{node.tag}>")


def _path(text: str, kind: str, where: Location, what: str) -> Iterator[Diagnostic]:
    found = resolve(Path(where.file).parent, text)
    if not found.exists:
        near = similar(found)
        hint = f" (did you mean {format_names(near)}?)" if near else ""
        message = f"{what}: the {kind} file '{text}' does not exist: {found.path}{hint}"
        fixes = tuple(
            Fix(f"Change to '{name}'", (Change(where, Part.VALUE, text, _renamed(text, name)),))
            for name in near
        )
        yield _SOFT.get(kind, F001).at(where, message, fixes=fixes)
        return
    if found.wrong_case:
        written = Path(os.path.relpath(found.best, Path(where.file).parent)).as_posix()
        fix = Fix("Write it as it is on disk", (Change(where, Part.VALUE, text, written),), True)
        yield F002.at(
            where,
            f"{what}: '{text}' differs in letter case from '{found.best.name}' on disk",
            fixes=(fix,),
        )
    if "\\" in text:
        slashed = text.replace("\\", "/")
        fix = Fix("Use slashes", (Change(where, Part.VALUE, text, slashed),), True)
        message = f"{what}: '{text}' has backslashes; '{slashed}' works everywhere"
        yield F003.at(where, message, fixes=() if found.wrong_case else (fix,))


def _renamed(text: str, name: str) -> str:
    """Replace the last part of the path ``text``."""
    return text[: max(text.rfind("/"), text.rfind("\\")) + 1] + name

"""Open project files for edits, and combine the edits of several fixes."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from nau_py.diagnostics.diagnostic import Fix
from nau_py.syntax.document import Document, Edit
from nau_py.syntax.language import is_yaml
from nau_py.syntax.xml_document import XmlDocument
from nau_py.syntax.yaml_document import YamlDocument

FileEdits = dict[Path, tuple[Document, list[Edit]]]
"""The text of each file, and its edits."""


def make_document(path: Path, text: str, encoding: str = "utf-8") -> Document:
    """Return the document of a file that has this text. The file is not read."""
    return (YamlDocument if is_yaml(path) else XmlDocument)(text, encoding)


def read_document(path: Path) -> Document:
    """Read a file as UTF-8, or else as Latin-1. Raises :class:`OSError`."""
    raw = path.read_bytes()
    try:
        return make_document(path, raw.decode("utf-8"))
    except UnicodeDecodeError:
        return make_document(path, raw.decode("latin-1"), "latin-1")


def plan_fixes(fixes: Iterable[Fix]) -> tuple[FileEdits, list[Fix]]:
    """Return the edits that make fixes, and the fixes that can be made.

    A fix can be made if every change of it fits the text. A file that cannot be read is not
    changed.
    """
    files: FileEdits = {}
    made: list[Fix] = []
    for fix in fixes:
        found: list[tuple[Path, list[Edit]]] = []
        for change in fix.changes:
            path = Path(change.location.file)
            try:
                if path not in files:
                    files[path] = (read_document(path), [])
            except OSError:
                break
            edits = files[path][0].make_change(change)
            if not edits:
                break
            found.append((path, edits))
        else:
            made.append(fix)
            for path, edits in found:
                files[path][1].extend(edits)
    return {path: (doc, edits) for path, (doc, edits) in files.items() if edits}, made

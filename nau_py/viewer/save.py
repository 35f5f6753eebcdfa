"""Edits that write changed values into the files of the project."""

from __future__ import annotations

from pathlib import Path

from nau_py.formats.settings import list_keys, list_spellings
from nau_py.model.camera import Camera, Projection
from nau_py.model.linked import Project
from nau_py.model.node import Configured, Node, Setting
from nau_py.model.project import UserAttribute
from nau_py.model.values import Scalar, format_scalar
from nau_py.syntax.document import Document, Edit
from nau_py.syntax.edit import FileEdits, read_document
from nau_py.viewer.controls import Values, home, parts_of


def save_edits(project: Project, values: Values) -> tuple[FileEdits, list[str]]:
    """Make the edits that write ``values``, by file; return them and the keys that no file can
    hold. Raises :class:`OSError` for a file that cannot be read."""
    files: FileEdits = {}
    left: list[str] = []
    for key, value in values.items():
        node = home(project, key)
        path = Path(node.location.file) if node is not None else None
        if node is None or path is None or not node.location.line:
            left.append(key)
            continue
        document, edits = files.setdefault(path, (read_document(path), []))
        found = _edits(project, document, node, key, value)
        if found is None:
            left.append(key)
        else:
            edits += found
    return {path: (doc, edits) for path, (doc, edits) in files.items() if edits}, left


def write_text(value: Scalar) -> str:
    """Write a number as short as single precision allows."""
    if isinstance(value, float):
        return f"{value:.7g}"
    return format_scalar(value)


def _edits(
    project: Project, document: Document, node: Node, key: str, value: tuple[Scalar, ...]
) -> list[Edit] | None:
    """Make the edits of one value; None if the file's form has no place for it."""
    type_, _, component = parts_of(key)
    if isinstance(node, UserAttribute):
        return _default_edits(document, node, value)
    if not isinstance(node, Configured):
        begin = document.offset(node.where(component))
        return document.set_value(begin, write_text(value[0]))
    attribute = project.registry[type_].attributes[component]
    written: Setting | None = node.settings.get(component)
    if isinstance(node, Projection):
        assert written is not None  # home() has found it here
        begin = document.offset(written.location)
        return document.set_value(begin, _texts(project, written, value)[0])
    if written is not None:
        begin = document.offset(written.location)
        texts = _texts(project, written, value)
        return document.set_components(begin, list_spellings(attribute), texts)
    texts = [write_text(v) for v in value]
    begin = document.offset(node.location)
    if isinstance(node, Camera) and node.projection and len(value) == 1:
        place = document.offset(node.projection.location)  # it is applied last, so it wins
        return document.set_attribute(place, component, texts[0]) or None
    return document.add_setting(begin, component, list_keys(attribute), texts) or None


def _default_edits(
    document: Document, node: UserAttribute, value: tuple[Scalar, ...]
) -> list[Edit]:
    """Make the edits of the default of a user attribute."""
    given = {**node.attribute_locations}
    vector = "rgba" if "r" in given else "xyzw"
    edits: list[Edit] = []
    for key, part in zip(["value"] if len(value) == 1 else vector, value):
        if key in given:
            edits += document.set_value(document.offset(given[key]), write_text(part))
        else:
            begin = document.offset(node.location)
            edits += document.set_attribute(begin, key, write_text(part))
    return edits


def _texts(project: Project, written: Setting, value: tuple[Scalar, ...]) -> list[str]:
    """Write the components as text; keep constants that have the value."""
    texts = [write_text(v) for v in value[: max(len(written.parts), 1)]]
    for index, part in enumerate(written.parts[: len(texts)]):
        if isinstance(part, str) and project.constants.get(part) == value[index]:
            texts[index] = part
    last = value[len(written.parts) :]
    return texts + [write_text(v) for v in last if v not in (0, 0.0)]

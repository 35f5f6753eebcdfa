"""Write a setting into a project file; only the changed values are edited."""

from __future__ import annotations

from pathlib import Path

from nau_py.accuracy.candidate import AS_IT_IS, Candidate
from nau_py.diagnostics.diagnostic import error
from nau_py.diagnostics.errors import ProjectError
from nau_py.model.knob import Value, find_knob_target
from nau_py.model.linked import Project
from nau_py.model.node import Node
from nau_py.model.passes import Pass
from nau_py.model.pipeline import Pipeline
from nau_py.syntax.document import Document, Edit
from nau_py.syntax.edit import read_document


def apply_setting(
    project: Project, pipeline: Pipeline, setting: Candidate, own: Candidate
) -> list[str]:
    """Write the values that differ from ``own`` into the project file; return the changes as text.

    Raises :class:`~nau_py.ProjectError` for a knob that no project file can hold (mask,
    scale, filter, format); the file is then as it was.
    """
    where = project.file.location
    path = Path(where.file)
    document = read_document(path)
    edits: list[Edit] = []
    changes: list[str] = []
    for name, value in setting.values:
        if value == own[name] or value == AS_IT_IS:
            continue
        found = find_knob_target(project, pipeline.passes, name)
        if not found.nodes:
            message = f"knob '{name}': no project file says it; only nau-cost turns it"
            raise ProjectError(error("E002", where, message))
        for node in found.nodes:
            edits += _edits(document, node, found.attribute, value)
        changes.append(f"{name} {own[name]} -> {value}")
    if edits:
        document.write(path, edits)
    return changes


def _edits(document: Document, node: Node, attribute: str, value: Value) -> list[Edit]:
    """Make the edits that set ``attribute`` of ``node``."""
    if not isinstance(node, Pass):
        return document.set_value(document.offset(node.where(attribute)), str(value))
    written = node.settings.get(attribute)
    if written is None:
        begin = document.offset(node.location)
        return document.add_setting(begin, attribute, ["value"], [str(value)])
    return document.set_components(document.offset(written.location), [("value",)], [str(value)])

"""Writing a setting back into a project file: only the values that it must, the rest as it was."""

from __future__ import annotations

import re
from pathlib import Path

from nau_py.accuracy.candidate import AS_IT_IS, Candidate
from nau_py.diagnostic import error
from nau_py.errors import ProjectError
from nau_py.files import write_text
from nau_py.model.knob import Value, subject
from nau_py.model.linked import Project
from nau_py.model.location import Location
from nau_py.model.node import Node
from nau_py.model.passes import Pass
from nau_py.model.pipeline import Pipeline


def apply(project: Project, pipeline: Pipeline, setting: Candidate, own: Candidate) -> list[str]:
    """Write what differs from ``own`` into the project file; returns what was written, in words.

    Raises :class:`~nau_py.errors.ProjectError` for a knob that no project file can hold (mask,
    scale, filter, format); the file is then as it was.
    """
    where = project.file.location
    path = Path(where.file)
    text = path.read_text(encoding="utf-8")
    yaml = path.suffix.lower() in (".yaml", ".yml")
    edits: list[tuple[int, int, str]] = []
    said: list[str] = []
    for name, value in setting.values:
        if value == own[name] or value == AS_IT_IS:
            continue
        found = subject(project, pipeline.passes, name)
        if not found.nodes:
            message = f"knob '{name}': no project file says it; only nau-cost turns it"
            raise ProjectError(error("E002", where, message))
        for node in found.nodes:
            edits.append(_edit(text, node, found.attribute, value, yaml))
        said.append(f"{name} {own[name]} -> {value}")
    for begin, end, new in sorted(edits, reverse=True):
        text = text[:begin] + new + text[end:]
    if edits:
        write_text(path, text)
    return said


def _edit(text: str, node: Node, attribute: str, value: Value, yaml: bool) -> tuple[int, int, str]:
    """(begin, end, new text) that gives ``attribute`` of ``node`` the value."""
    if isinstance(node, Pass) and attribute not in node.settings:
        return _inserted(text, node, attribute, value, yaml)
    if isinstance(node, Pass):
        begin = _offset(text, node.settings[attribute].location)
        pattern = r":\s*([^\s,}#]+)" if yaml else r"value\s*=\s*(\"[^\"]*\"|'[^']*'|[^\s/>]+)"
        found = re.compile(pattern).search(text, begin)
        assert found is not None, f"{attribute} has no value"
        return found.start(1), found.end(1), str(value) if yaml else f'"{value}"'
    begin = _offset(text, node.where(attribute))
    found = re.compile(r"[^\"'\s/>,}]+").match(text, begin)
    assert found is not None, f"{attribute} has no value"
    return found.start(), found.end(), str(value)


def _inserted(
    text: str, node: Node, attribute: str, value: Value, yaml: bool
) -> tuple[int, int, str]:
    """The attribute as the first thing inside ``node``, indented as what follows it."""
    begin = _offset(text, node.location)
    if yaml:
        return begin, begin, f"{attribute}: {value}\n{' ' * (node.location.column - 1)}"
    end = text.index(">", begin) + 1
    following = re.compile(r"\s*").match(text, end)
    blank = following.group() if following else "\n"
    return end, end, f'{blank}<{attribute} value="{value}" />'


def _offset(text: str, location: Location) -> int:
    """The character at a location."""
    lines = text.splitlines(keepends=True)
    return sum(len(line) for line in lines[: location.line - 1]) + location.column - 1

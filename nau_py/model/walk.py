"""Nodes of a project and of its own libraries, without the built-in library."""

from __future__ import annotations

from collections.abc import Iterator

from nau_py.model.library import MaterialLibrary
from nau_py.model.linked import Project
from nau_py.model.node import Node


def list_own_libraries(project: Project) -> list[MaterialLibrary]:
    """List every library except the built-in one."""
    return project.libraries[1:]


def walk_nodes(project: Project) -> Iterator[Node]:
    """Yield every node of the project file and of its libraries, parents first."""
    if project.file.tag:
        yield from project.file.walk()
    for library in [*list_own_libraries(project), *project.physics]:
        yield from library.walk()

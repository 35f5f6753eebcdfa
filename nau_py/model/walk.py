"""The nodes that lint looks at: the project's and its libraries', not the built-in ones."""

from __future__ import annotations

from collections.abc import Iterator

from nau_py.model.library import MaterialLibrary
from nau_py.model.linked import Project
from nau_py.model.node import Node


def own_libraries(project: Project) -> list[MaterialLibrary]:
    """Every library but the built-in one."""
    return project.libraries[1:]


def nodes(project: Project) -> Iterator[Node]:
    """Every node of the project file and of its libraries, in document order of declaration."""
    if project.file.tag:
        yield from project.file.walk()
    for library in [*own_libraries(project), *project.physics]:
        yield from library.walk()

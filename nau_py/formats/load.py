"""Loading of a project with all of its files, in Nau's load order (docs/format.md, 3.1)."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TypeVar

from nau_py.diagnostics.location import Location
from nau_py.diagnostics.problem import Problem, ProblemKind
from nau_py.formats.bind import Binder
from nau_py.formats.settings import parse_setting
from nau_py.formats.upgrade import upgrade_dialect
from nau_py.formats.yaml import YamlReader
from nau_py.model.attribute import Attribute
from nau_py.model.attributes import Registry
from nau_py.model.library import MaterialLibrary
from nau_py.model.linked import Project
from nau_py.model.node import Node
from nau_py.model.physics import PhysicsLibrary
from nau_py.model.project import ProjectFile
from nau_py.model.values import DataType
from nau_py.process.paths import resolve
from nau_py.syntax.element import Element
from nau_py.syntax.language import YAML_SUFFIXES, is_yaml
from nau_py.syntax.parse_error import ParseError
from nau_py.syntax.xml import parse_xml
from nau_py.syntax.yaml import parse_yaml

BUILTIN_LIBRARY = Path(__file__).parent / "builtin" / "system.mlib"
N = TypeVar("N", bound=Node)
_DEFAULT_KEYS = ("value", "x", "y", "z", "w", "r", "g", "b", "a")


class Reader:
    """Reads files into models. Collects problems and the text of each file.

    ``texts`` replaces the content of files, by resolved path: unsaved text of an editor.
    """

    def __init__(self, texts: Mapping[Path, str] | None = None) -> None:
        self._texts = texts or {}
        self.registry = Registry()
        self.problems: list[Problem] = []
        self.sources: dict[str, str] = {}

    def read_text(self, path: Path) -> str | None:
        """Read the text of a file (UTF-8, else Latin-1). Returns None and adds a problem on
        failure."""
        if self._texts and (unsaved := self._texts.get(path.resolve())) is not None:
            self.sources[str(path)] = unsaved
            return unsaved
        try:
            raw = path.read_bytes()
        except OSError as error:
            detail = error.strerror or str(error)
            self.problems.append(
                Problem(ProblemKind.UNREADABLE, Location(str(path)), value=str(path), detail=detail)
            )
            return None
        try:
            text = raw.decode("utf-8")
        except UnicodeDecodeError:
            text = raw.decode("latin-1")
        self.sources[str(path)] = text
        return text

    def element(self, path: Path, tag: str, cls: type[Node]) -> Element | None:
        """Read and upgrade the elements of a file. Returns None and adds a problem on failure."""
        text = self.read_text(path)
        if text is None:
            return None
        try:
            if is_yaml(path):
                data = parse_yaml(text, str(path))
                self._yaml_user_attributes(data)
                where = Location(str(path), 1, 1)
                root = YamlReader(str(path), self.registry).node(tag, data, cls, where)
            else:
                root = parse_xml(text, str(path), self.problems)
        except ParseError as error:
            self.problems.append(Problem(ProblemKind.SYNTAX, error.location, detail=error.message))
            return None
        except RecursionError:
            where = Location(str(path), 1, 1)
            self.problems.append(
                Problem(ProblemKind.SYNTAX, where, detail="elements are nested too deeply")
            )
            return None
        return upgrade_dialect(root, self.problems)

    def _yaml_user_attributes(self, data: object) -> None:
        """Declare user attributes first: they decide which keys of the rest are settings."""
        assets = data.get("assets") if isinstance(data, dict) else None
        listed = assets.get("attributes") if isinstance(assets, dict) else None
        if isinstance(listed, dict):  # the long form of a wrapper
            listed = listed.get("items")
        for item in listed if isinstance(listed, list) else []:
            if isinstance(item, dict):
                texts = {str(k): str(v) for k, v in item.items()}
                self.declare(Element("attribute", texts))

    def declare(self, element: Element) -> None:
        """Add the user attribute that an ``<attribute>`` element declares, if it is complete."""
        type_, name = element.attributes.get("type", ""), element.attributes.get("name", "")
        set_ = self.registry.common(type_)
        data = element.attributes.get("data", "")
        if set_ is None or not name or name in set_ or data not in DataType.__members__:
            return
        data_type = DataType(data)
        keys = "rgba" if "r" in element.attributes else "xyzw"
        plain = Attribute(name, data_type, keys=keys)
        values = {k: v for k, v in element.attributes.items() if k in _DEFAULT_KEYS}
        default = parse_setting(Element(name, values), plain, []) if values else None
        parts = default.parts if default else (0,) * data_type.components
        parts += (0,) * (data_type.components - len(parts))
        self.registry.add(
            type_, Attribute(name, data_type, parts, "User attribute of the project.", keys=keys)
        )

    def declare_all(self, root: Element) -> None:
        """Add all user attributes of a project file."""
        assets = root.first("assets")
        section = assets.first("attributes") if assets else None
        for child in section.children if section else []:
            if child.tag == "attribute":
                self.declare(child)

    def library(self, path: Path) -> MaterialLibrary | None:
        """Read a material library. Returns None and adds a problem on failure."""
        return self._bound(path, "materialLib", MaterialLibrary)

    def physics(self, path: Path) -> PhysicsLibrary | None:
        """Read a physics library. Returns None and adds a problem on failure."""
        return self._bound(path, "physicslib", PhysicsLibrary)

    def _bound(self, path: Path, tag: str, cls: type[N]) -> N | None:
        root = self.element(path, tag, cls)
        return Binder(self.registry, self.problems).bind(root, cls) if root is not None else None


def load_project(path: Path | str, texts: Mapping[Path, str] | None = None) -> Project:
    """Read a project file (XML or YAML) with its material libraries.

    ``texts`` replaces the content of files, by resolved path.

    Never raises for the content of a file: problems are collected in ``Project.problems``, and lint
    reports them.
    """
    path = Path(path)
    reader = Reader(texts)
    root = reader.element(path, "project", ProjectFile)
    project = Project(path, ProjectFile(location=Location(str(path), 1, 1)), reader.registry)
    project.problems, project.sources = reader.problems, reader.sources
    builtin = reader.library(BUILTIN_LIBRARY)
    if builtin is not None:
        project.libraries.append(builtin)
    if root is None:
        return project
    reader.declare_all(root)
    project.file = Binder(reader.registry, reader.problems).bind(root, ProjectFile)
    for named in project.assets.physicsLibs:
        found = resolve(path.parent, named.filename or "")
        if named.filename and found.exists:
            physics = reader.physics(found.best)
            if physics is not None:
                project.physics.append(physics)
    for reference in project.assets.materialLibs:
        found = resolve(path.parent, reference.filename or "")
        if reference.filename and found.exists:
            library = reader.library(found.best)
            if library is not None:
                project.libraries.append(library)
    return project


def load_library(path: Path | str, texts: Mapping[Path, str] | None = None) -> Project:
    """Read one material library as a project of its own, for lint and formatting."""
    path = Path(path)
    reader = Reader(texts)
    project = Project(path, ProjectFile(location=Location(str(path), 1, 1)), reader.registry)
    project.problems, project.sources = reader.problems, reader.sources
    for file in (BUILTIN_LIBRARY, path):
        library = reader.library(file)
        if library is not None:
            project.libraries.append(library)
    return project


def is_library(path: Path) -> bool:
    """Return True for a material library, by its ending."""
    if is_yaml(path):
        return path.name.lower().endswith(tuple(f".mlib{s}" for s in YAML_SUFFIXES))
    return path.suffix.lower() == ".mlib"

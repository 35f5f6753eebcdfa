"""The files that are open in an editor, and the projects that they belong to."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from nau_py.api import lint
from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.formats.load import is_library, load_library, load_project
from nau_py.lsp.complete import Grammar
from nau_py.lsp.symbols import Symbols
from nau_py.model.linked import Project
from nau_py.process.paths import forget_folders
from nau_py.run.reload import Stamp, stamp
from nau_py.run.used_files import used_files
from nau_py.syntax.language import YAML_SUFFIXES, is_yaml

_SUFFIXES = (".xml", ".mlib", *YAML_SUFFIXES)
_MOST = 2000
"""Files of a workspace that are looked at for projects."""


class Session:
    """``folders``: where projects are looked for that use a file. Paths are absolute."""

    def __init__(self, folders: list[Path] | None = None) -> None:
        self.folders = folders or []
        self.texts: dict[Path, str] = {}
        self._good: dict[Path, Project] = {}
        self._known: dict[Path, tuple[dict[Path, Stamp | str], Project]] = {}

    def set(self, path: Path, text: str) -> None:
        """The editor's text of a file."""
        self.texts[path.resolve()] = text

    def close(self, path: Path) -> None:
        """The file on disk counts again."""
        self.texts.pop(path.resolve(), None)

    def text(self, path: Path) -> str:
        """The text of a file, as the editor has it or as it is on disk; empty for none."""
        found = self.texts.get(path.resolve())
        if found is not None:
            return found
        try:
            return path.read_text("utf-8", "replace")
        except OSError:
            return ""

    def is_project_file(self, path: Path) -> bool:
        """Whether a file is a project or a library."""
        if path.suffix.lower() not in _SUFFIXES:
            return False
        text = self.text(path)
        if path.suffix.lower() == ".xml":
            return "<project" in text[:4096]
        return is_library(path) or "pipelines:" in text or "assets:" in text

    def load(self, path: Path) -> Project:
        """The project or library of a file, by the editor's texts."""
        now = self._now(path)
        known = self._known.get(path)
        if known is not None and known[0] == now:
            return known[1]
        project = (load_library if is_library(path) else load_project)(path, self.texts)
        self._known[path] = (self._now(path, project), project)
        if project.file.tag or len(project.libraries) > 1:
            self._good[path] = project
        return project

    def _now(self, path: Path, project: Project | None = None) -> dict[Path, Stamp | str]:
        """What the project was made of, or would be now."""
        if project is None:
            known = self._known.get(path)
            sources = list(known[0]) if known is not None else [path]
        else:
            sources = [Path(p) for p in project.sources]
        return {p: self.texts.get(p.resolve()) or stamp(p) for p in sources}

    def diagnostics(self, path: Path) -> list[Diagnostic]:
        """Lint's findings about a project or library, in all its files."""
        forget_folders()
        return lint(self.load(path))

    def grammar(self, path: Path) -> Grammar:
        """What may stand in a file. Names come from a project that uses it, or from its last
        state that could be read."""
        text = self.text(path)
        library = is_library(path)
        yaml = is_yaml(path)
        self.load(path)
        names = self._good.get(path) or self.load(path)
        if library:
            names = next(self._users(path), names)
        return Grammar(text, yaml, library, path, names)

    def symbols(self, path: Path) -> Symbols:
        """The names that a file speaks of, as a project that uses it has them."""
        if is_library(path) or not self.is_project_file(path):
            user = next(self._users(path), None)
            if user is not None:
                return Symbols(user)
        return Symbols(self.load(path))

    def all_symbols(self, path: Path) -> list[Symbols]:
        """Those of every project that uses a file: what a rename must change."""
        found = [Symbols(project) for project in self._users(path)]
        return found or [self.symbols(path)]

    def _users(self, path: Path) -> Iterator[Project]:
        """The projects, open ones first, that use a file or are it."""
        wanted = path.resolve()
        for other in self._projects():
            project = self.load(other)
            if wanted == other.resolve() or wanted in used_files(project):
                yield project

    def users(self, path: Path) -> list[Project]:
        """The projects that use a file."""
        return list(self._users(path))

    def _projects(self) -> list[Path]:
        found = [p for p in self.texts if self.is_project_file(p) and not is_library(p)]
        looked = 0
        for folder in self.folders:
            for file in sorted(folder.rglob("*")):
                hidden = any(part.startswith(".") for part in file.relative_to(folder).parts)
                if hidden or file.suffix.lower() not in _SUFFIXES or is_library(file):
                    continue
                looked += 1
                if looked > _MOST:
                    break
                if self.is_project_file(file):
                    found.append(file.resolve())
        return list(dict.fromkeys(found))

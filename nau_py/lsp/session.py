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
from nau_py.process.file_watch import Stamp, read_stamp
from nau_py.process.paths import forget_folders
from nau_py.run.used_files import used_files
from nau_py.syntax.language import YAML_SUFFIXES, is_yaml

_SUFFIXES = (".xml", ".mlib", *YAML_SUFFIXES)
_MOST = 2000
"""The most files of a workspace that are searched for projects."""


class EditorSession:
    """Texts and projects of one editor.

    ``folders``: the folders that are searched for projects that use a file. Paths are absolute.
    """

    def __init__(self, folders: list[Path] | None = None) -> None:
        self.folders = folders or []
        self.texts: dict[Path, str] = {}
        self._good: dict[Path, Project] = {}
        self._known: dict[Path, tuple[dict[Path, Stamp | str], Project]] = {}

    def set_text(self, path: Path, text: str) -> None:
        """Keep the editor's text of a file."""
        self.texts[path.resolve()] = text

    def forget_text(self, path: Path) -> None:
        """Drop the editor's text of a file: the file on disk is read again."""
        self.texts.pop(path.resolve(), None)

    def read_text(self, path: Path) -> str:
        """Return the text of a file, from the editor or else from disk; empty for none."""
        found = self.texts.get(path.resolve())
        if found is not None:
            return found
        try:
            return path.read_text("utf-8", "replace")
        except OSError:
            return ""

    def is_project_file(self, path: Path) -> bool:
        """Report if a file is a project or a library."""
        if path.suffix.lower() not in _SUFFIXES:
            return False
        text = self.read_text(path)
        if path.suffix.lower() == ".xml":
            return "<project" in text[:4096]
        return is_library(path) or "pipelines:" in text or "assets:" in text

    def load(self, path: Path) -> Project:
        """Load the project or library of a file with the editor's texts."""
        now = self._stamp_sources(path)
        known = self._known.get(path)
        if known is not None and known[0] == now:
            return known[1]
        project = (load_library if is_library(path) else load_project)(path, self.texts)
        self._known[path] = (self._stamp_sources(path, project), project)
        if project.file.tag or len(project.libraries) > 1:
            self._good[path] = project
        return project

    def _stamp_sources(self, path: Path, project: Project | None = None) -> dict[Path, Stamp | str]:
        """Return the present state of the files that a project was loaded from."""
        if project is None:
            known = self._known.get(path)
            sources = list(known[0]) if known is not None else [path]
        else:
            sources = [Path(p) for p in project.sources]
        return {p: self.texts.get(p.resolve()) or read_stamp(p) for p in sources}

    def lint_file(self, path: Path) -> list[Diagnostic]:
        """Lint a project or library, in all its files."""
        forget_folders()
        return lint(self.load(path))

    def make_grammar(self, path: Path) -> Grammar:
        """Return the grammar of a file.

        Names are those of a project that uses it, or of its last state that could be read.
        """
        text = self.read_text(path)
        library = is_library(path)
        yaml = is_yaml(path)
        self.load(path)
        names = self._good.get(path) or self.load(path)
        if library:
            names = next(self._users(path), names)
        return Grammar(text, yaml, library, path, names)

    def find_symbols(self, path: Path) -> Symbols:
        """Return the names of a file, as a project that uses it resolves them."""
        if is_library(path) or not self.is_project_file(path):
            user = next(self._users(path), None)
            if user is not None:
                return Symbols(user)
        return Symbols(self.load(path))

    def find_all_symbols(self, path: Path) -> list[Symbols]:
        """Return the names of every project that uses a file; a rename must change them all."""
        found = [Symbols(project) for project in self._users(path)]
        return found or [self.find_symbols(path)]

    def _users(self, path: Path) -> Iterator[Project]:
        """Load the projects that use a file or are it, open ones first."""
        wanted = path.resolve()
        for other in self._list_projects():
            project = self.load(other)
            if wanted == other.resolve() or wanted in used_files(project):
                yield project

    def find_users(self, path: Path) -> list[Project]:
        """Return the projects that use a file."""
        return list(self._users(path))

    def _list_projects(self) -> list[Path]:
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

"""The language server's state: open texts, published findings, and answers in LSP's types."""

from __future__ import annotations

import asyncio
from collections.abc import Iterable
from pathlib import Path

from lsprotocol import types as lsp
from pygls.lsp.server import LanguageServer
from pygls.uris import from_fs_path, to_fs_path
from pygls.workspace import TextDocument

from nau_py.diagnostics.diagnostic import Diagnostic, Fix, Severity
from nau_py.diagnostics.location import Location
from nau_py.formats.load import is_library
from nau_py.lsp.navigate import Occurrence
from nau_py.lsp.ranges import find_word, make_range
from nau_py.lsp.session import EditorSession
from nau_py.syntax.document import Document, Edit
from nau_py.syntax.edit import make_document
from nau_py.version import __version__

DELAY = 0.15
"""Seconds without typing until the text is linted."""
_SEVERITY = {
    Severity.ERROR: lsp.DiagnosticSeverity.Error,
    Severity.WARNING: lsp.DiagnosticSeverity.Warning,
    Severity.NOTE: lsp.DiagnosticSeverity.Information,
}


def path_of(uri: str) -> Path:
    """Return the path of a file by its address."""
    return Path(to_fs_path(uri) or uri)


class NauServer(LanguageServer):
    """Keeps a session in step with the editor's documents, and publishes lint's findings."""

    def __init__(self) -> None:
        super().__init__("nau-lsp", __version__)
        self.session = EditorSession()
        self.published: dict[Path, set[Path]] = {}
        self.findings: dict[Path, list[Diagnostic]] = {}
        self._waiting: dict[Path, asyncio.Task[None]] = {}

    def find_document(self, path: Path) -> TextDocument:
        """Return the document of a path, which knows how the editor counts characters."""
        uri = from_fs_path(str(path)) or str(path)
        if uri in self.workspace.text_documents:
            return self.workspace.get_text_document(uri)
        source = self.session.read_text(path)
        return TextDocument(uri, source, position_codec=self.workspace.position_codec)

    def lint_soon(self, path: Path) -> None:
        """Lint after :data:`DELAY`, unless there is another change until then."""
        before = self._waiting.pop(path, None)
        if before is not None:
            before.cancel()
        self._waiting[path] = asyncio.get_running_loop().create_task(self._lint_later(path))

    async def _lint_later(self, path: Path) -> None:
        await asyncio.sleep(DELAY)
        self.lint(path)

    def lint(self, path: Path) -> None:
        """Publish the findings of every open project that a file belongs to."""
        roots = self._find_roots(path)
        if not roots:
            self.publish(path, [])
        for root in roots:
            by_file: dict[Path, list[Diagnostic]] = {root: [], path: []}
            for found in self.session.lint_file(root):
                by_file.setdefault(Path(found.location.file or root), []).append(found)
            for old in self.published.get(root, set()) - set(by_file):
                self.publish(old, [])
            self.published[root] = set(by_file)
            for file, listed in by_file.items():
                self.publish(file, listed)

    def _find_roots(self, path: Path) -> list[Path]:
        """Return the open projects that use an open file; the file itself where none does."""
        if not is_library(path):
            return [path] if self.session.is_project_file(path) else []
        users = [p.path.resolve() for p in self.session.find_users(path)]
        opened = [p for p in users if p in self.session.texts]
        return opened or users[:1] or [path]

    def publish(self, file: Path, listed: list[Diagnostic]) -> None:
        """Send the findings of one file to the editor; they replace earlier ones."""
        self.findings[file] = listed
        document = self.find_document(file)
        items = [
            lsp.Diagnostic(
                find_word(document, found.location),
                found.message,
                _SEVERITY[found.severity],
                found.rule,
                source="nau-lint",
                related_information=[
                    lsp.DiagnosticRelatedInformation(self._locate(where), text)
                    for where, text in found.related
                ],
            )
            for found in listed
        ]
        self.text_document_publish_diagnostics(lsp.PublishDiagnosticsParams(document.uri, items))

    def _locate(self, location: Location) -> lsp.Location:
        document = self.find_document(Path(location.file))
        return lsp.Location(document.uri, find_word(document, location))

    def make_locations(self, found: Iterable[Occurrence]) -> list[lsp.Location]:
        """Return words of files as LSP's locations."""
        made = []
        for item in found:
            document = self.find_document(item.path)
            made.append(lsp.Location(document.uri, make_range(document, item.begin, item.end)))
        return made

    def make_workspace_edit(self, changes: dict[Path, list[Edit]]) -> lsp.WorkspaceEdit:
        """Return edits of several files as LSP's edit."""
        made: dict[str, list[lsp.TextEdit]] = {}
        for path, edits in changes.items():
            document = self.find_document(path)
            made[document.uri] = [
                lsp.TextEdit(make_range(document, begin, end), new)
                for begin, end, new in sorted(set(edits))
            ]
        return lsp.WorkspaceEdit(changes=made)

    def plan_fix(self, fix: Fix, texts: dict[Path, Document]) -> dict[Path, list[Edit]]:
        """Return the edits of a fix in the editor's texts; none where one of them does not fit.

        ``texts`` keeps the documents that were made, for the next fix.
        """
        made: dict[Path, list[Edit]] = {}
        for change in fix.changes:
            path = Path(change.location.file)
            if path not in texts:
                texts[path] = make_document(path, self.session.read_text(path))
            edits = texts[path].make_change(change)
            if not edits:
                return {}
            made.setdefault(path, []).extend(edits)
        return made

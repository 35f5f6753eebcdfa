"""The Language Server Protocol (Microsoft, LSP 3.17) over :mod:`nau_py.lsp`, by pygls."""

from __future__ import annotations

import asyncio
from collections.abc import Iterable
from pathlib import Path

from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcInvalidParams
from pygls.lsp.server import LanguageServer
from pygls.uris import from_fs_path, to_fs_path
from pygls.workspace import TextDocument

from nau_py.diagnostics.diagnostic import Diagnostic, Fix, Severity
from nau_py.diagnostics.location import Location
from nau_py.formats.load import is_library
from nau_py.lsp.complete import complete
from nau_py.lsp.hover import hover
from nau_py.lsp.navigate import (
    CannotRename,
    Found,
    definition,
    references,
    renamable,
    rename,
)
from nau_py.lsp.session import Session
from nau_py.syntax.document import Edit
from nau_py.syntax.edit import make_document
from nau_py.syntax.language import YAML_SUFFIXES
from nau_py.version import __version__

DELAY = 0.15
"""Seconds without typing until the text is linted."""
_SEVERITY = {
    Severity.ERROR: lsp.DiagnosticSeverity.Error,
    Severity.WARNING: lsp.DiagnosticSeverity.Warning,
    Severity.NOTE: lsp.DiagnosticSeverity.Information,
}
_KINDS = {
    "element": lsp.CompletionItemKind.Class,
    "attribute": lsp.CompletionItemKind.Property,
    "value": lsp.CompletionItemKind.EnumMember,
    "name": lsp.CompletionItemKind.Reference,
    "file": lsp.CompletionItemKind.File,
}


def _path(uri: str) -> Path:
    return Path(to_fs_path(uri) or uri)


class NauServer(LanguageServer):
    """Keeps a session in step with the editor's documents, and publishes what lint finds."""

    def __init__(self) -> None:
        super().__init__("nau-lsp", __version__)
        self.session = Session()
        self.published: dict[Path, set[Path]] = {}
        self.findings: dict[Path, list[Diagnostic]] = {}
        self._waiting: dict[Path, asyncio.Task[None]] = {}

    def text(self, path: Path) -> TextDocument:
        """The document of a path, with the editor's text and its way to count characters."""
        uri = from_fs_path(str(path)) or str(path)
        if uri in self.workspace.text_documents:
            return self.workspace.get_text_document(uri)
        source = self.session.text(path)
        codec = self.workspace.position_codec
        return TextDocument(uri, source, position_codec=codec)

    def lint_soon(self, path: Path) -> None:
        """Lint after :data:`DELAY`, unless there is another change until then."""
        before = self._waiting.pop(path, None)
        if before is not None:
            before.cancel()
        self._waiting[path] = asyncio.get_running_loop().create_task(self._later(path))

    async def _later(self, path: Path) -> None:
        await asyncio.sleep(DELAY)
        self.lint(path)

    def lint(self, path: Path) -> None:
        """Publish the findings of every open project that a file belongs to."""
        roots = self._roots(path)
        if not roots:
            self._publish(path, [])
        for root in roots:
            by_file: dict[Path, list[Diagnostic]] = {root: [], path: []}
            for found in self.session.diagnostics(root):
                by_file.setdefault(Path(found.location.file or root), []).append(found)
            for old in self.published.get(root, set()) - set(by_file):
                self._publish(old, [])
            self.published[root] = set(by_file)
            for file, listed in by_file.items():
                self._publish(file, listed)

    def _roots(self, path: Path) -> list[Path]:
        """The open projects that use an open file; the file itself where there is none."""
        if not is_library(path):
            return [path] if self.session.is_project_file(path) else []
        users = [p.path.resolve() for p in self.session.users(path)]
        opened = [p for p in users if p in self.session.texts]
        return opened or users[:1] or [path]

    def _publish(self, file: Path, listed: list[Diagnostic]) -> None:
        self.findings[file] = listed
        document = self.text(file)
        uri = document.uri
        items = [
            lsp.Diagnostic(
                self.word(document, found.location),
                found.message,
                _SEVERITY[found.severity],
                found.rule,
                source="nau-lint",
                related_information=[
                    lsp.DiagnosticRelatedInformation(self.place(where), text)
                    for where, text in found.related
                ],
            )
            for found in listed
        ]
        self.text_document_publish_diagnostics(lsp.PublishDiagnosticsParams(uri, items))

    def word(self, document: TextDocument, location: Location) -> lsp.Range:
        """The word that stands at a location."""
        text = make_document(Path(), document.source)
        begin = text.offset(location)
        end = begin
        while end < len(text.text) and text.text[end] not in " \t\r\n\"'/>":
            end += 1
        return self.range(document, begin, max(end, begin + (begin < len(text.text))))

    def place(self, location: Location) -> lsp.Location:
        document = self.text(Path(location.file))
        return lsp.Location(document.uri, self.word(document, location))

    def range(self, document: TextDocument, begin: int, end: int) -> lsp.Range:
        """Characters of a text as the editor counts them."""
        codec, lines = document.position_codec, document.lines
        return codec.range_to_client_units(
            lines, lsp.Range(_position(document.source, begin), _position(document.source, end))
        )

    def locations(self, found: Iterable[Found]) -> list[lsp.Location]:
        result = []
        for item in found:
            document = self.text(item.path)
            result.append(lsp.Location(document.uri, self.range(document, item.begin, item.end)))
        return result

    def edit(self, changes: dict[Path, list[Edit]]) -> lsp.WorkspaceEdit:
        """Edits of several files."""
        made: dict[str, list[lsp.TextEdit]] = {}
        for path, edits in changes.items():
            document = self.text(path)
            made[document.uri] = [
                lsp.TextEdit(self.range(document, begin, end), new)
                for begin, end, new in sorted(set(edits))
            ]
        return lsp.WorkspaceEdit(changes=made)

    def fix(self, fix: Fix) -> dict[Path, list[Edit]]:
        """The edits of a fix in the editor's texts; none where one of them does not fit."""
        made: dict[Path, list[Edit]] = {}
        for change in fix.changes:
            path = Path(change.location.file)
            edits = make_document(path, self.session.text(path)).make_change(change)
            if not edits:
                return {}
            made.setdefault(path, []).extend(edits)
        return made


def _position(text: str, offset: int) -> lsp.Position:
    begin = text.rfind("\n", 0, offset) + 1
    return lsp.Position(text.count("\n", 0, offset), offset - begin)


def make_server() -> NauServer:
    """A server with every feature, ready to be started."""
    server = NauServer()

    @server.feature(lsp.INITIALIZED)
    def begin(_: lsp.InitializedParams) -> None:
        folders = server.workspace.folders.values()
        server.session.folders = [_path(f.uri) for f in folders]

    @server.feature(lsp.TEXT_DOCUMENT_DID_OPEN)
    def opened(params: lsp.DidOpenTextDocumentParams) -> None:
        path = _path(params.text_document.uri)
        server.session.set(path, params.text_document.text)
        server.lint(path)

    @server.feature(lsp.TEXT_DOCUMENT_DID_CHANGE)
    async def changed(params: lsp.DidChangeTextDocumentParams) -> None:
        path = _path(params.text_document.uri)
        document = server.workspace.get_text_document(params.text_document.uri)
        server.session.set(path, document.source)
        server.lint_soon(path)

    @server.feature(lsp.TEXT_DOCUMENT_DID_SAVE)
    def saved(params: lsp.DidSaveTextDocumentParams) -> None:
        server.lint(_path(params.text_document.uri))

    @server.feature(lsp.TEXT_DOCUMENT_DID_CLOSE)
    def closed(params: lsp.DidCloseTextDocumentParams) -> None:
        path = _path(params.text_document.uri)
        server.session.close(path)
        for file in server.published.pop(path, {path}):
            server._publish(file, [])

    _reading(server)
    _changing(server)
    return server


def _reading(server: NauServer) -> None:
    @server.feature(
        lsp.TEXT_DOCUMENT_COMPLETION,
        lsp.CompletionOptions(trigger_characters=["<", '"', "'", " ", "/", ":", "-"]),
    )
    def completion(params: lsp.CompletionParams) -> lsp.CompletionList:
        path, document, offset = _at(server, params)
        if not _reads(server, path):
            return lsp.CompletionList(False, [])
        cursor, found = complete(server.session.grammar(path), offset)
        span = server.range(document, cursor.begin, cursor.end)
        items = [
            lsp.CompletionItem(
                item.label,
                kind=_KINDS[item.kind],
                detail=item.detail or None,
                documentation=lsp.MarkupContent(lsp.MarkupKind.Markdown, item.doc)
                if item.doc
                else None,
                text_edit=lsp.TextEdit(span, item.text),
                filter_text=item.text,
                sort_text=f"{index:04}",
            )
            for index, item in enumerate(found)
        ]
        return lsp.CompletionList(False, items)

    @server.feature(lsp.TEXT_DOCUMENT_HOVER)
    def hovered(params: lsp.HoverParams) -> lsp.Hover | None:
        path, _, offset = _at(server, params)
        if not _reads(server, path):
            return None
        text = hover(server.session.grammar(path), server.session.symbols(path), offset)
        return lsp.Hover(lsp.MarkupContent(lsp.MarkupKind.Markdown, text)) if text else None

    @server.feature(lsp.TEXT_DOCUMENT_DEFINITION)
    def defined(params: lsp.DefinitionParams) -> list[lsp.Location]:
        path, _, offset = _at(server, params)
        return server.locations(definition(server.session, path, offset))

    @server.feature(lsp.TEXT_DOCUMENT_REFERENCES)
    def used(params: lsp.ReferenceParams) -> list[lsp.Location]:
        path, _, offset = _at(server, params)
        declaration = params.context.include_declaration
        return server.locations(references(server.session, path, offset, declaration))


def _changing(server: NauServer) -> None:
    @server.feature(lsp.TEXT_DOCUMENT_PREPARE_RENAME)
    def before_rename(params: lsp.PrepareRenameParams) -> lsp.Range:
        path, document, offset = _at(server, params)
        try:
            found = renamable(server.session, path, offset)
        except CannotRename as why:
            raise JsonRpcInvalidParams(str(why)) from None
        return server.range(document, found.begin, found.end)

    @server.feature(lsp.TEXT_DOCUMENT_RENAME, lsp.RenameOptions(prepare_provider=True))
    def renamed(params: lsp.RenameParams) -> lsp.WorkspaceEdit:
        path, _, offset = _at(server, params)
        try:
            found = rename(server.session, path, offset, params.new_name)
        except CannotRename as why:
            raise JsonRpcInvalidParams(str(why)) from None
        changes: dict[Path, list[Edit]] = {}
        for item in found:
            changes.setdefault(item.path, []).append((item.begin, item.end, params.new_name))
        return server.edit(changes)

    kinds = [lsp.CodeActionKind.QuickFix, lsp.CodeActionKind.SourceFixAll]

    @server.feature(
        lsp.TEXT_DOCUMENT_CODE_ACTION, lsp.CodeActionOptions(code_action_kinds=[*kinds])
    )
    def actions(params: lsp.CodeActionParams) -> list[lsp.CodeAction]:
        path = _path(params.text_document.uri)
        document = server.text(path)
        made: list[lsp.CodeAction] = []
        safe: dict[Path, list[Edit]] = {}
        for found in server.findings.get(path, []):
            span = server.word(document, found.location)
            for number, fix in enumerate(found.fixes):
                edits = server.fix(fix)
                if not edits:
                    continue
                if fix.safe and number == 0:
                    for file, listed in edits.items():
                        safe.setdefault(file, []).extend(listed)
                if _meets(span, params.range):
                    title = f"{fix.title} ({found.rule})"
                    made.append(
                        lsp.CodeAction(
                            title,
                            kinds[0],
                            is_preferred=number == 0,
                            edit=server.edit(edits),
                        )
                    )
        if safe:
            made.append(lsp.CodeAction("Apply all safe fixes", kinds[1], edit=server.edit(safe)))
        wanted = [_kind(k) for k in params.context.only or [""]]
        return [a for a in made if any(_kind(a.kind).startswith(k) for k in wanted)]


def _kind(kind: lsp.CodeActionKind | str | None) -> str:
    return kind.value if isinstance(kind, lsp.CodeActionKind) else kind or ""


def _meets(one: lsp.Range, other: lsp.Range) -> bool:
    a, b = (one.start.line, one.start.character), (one.end.line, one.end.character)
    c, d = (other.start.line, other.start.character), (other.end.line, other.end.character)
    return a <= d and c <= b


def _reads(server: NauServer, path: Path) -> bool:
    return server.session.is_project_file(path) or is_library(path) or _empty(server, path)


def _empty(server: NauServer, path: Path) -> bool:
    """A file that is only begun: its ending is all that tells."""
    known = (".xml", ".mlib", *YAML_SUFFIXES)
    return path.suffix.lower() in known and len(server.session.text(path).strip()) < 40


def _at(
    server: NauServer,
    params: lsp.CompletionParams
    | lsp.HoverParams
    | lsp.DefinitionParams
    | lsp.ReferenceParams
    | lsp.PrepareRenameParams
    | lsp.RenameParams,
) -> tuple[Path, TextDocument, int]:
    path = _path(params.text_document.uri)
    document = server.text(path)
    return path, document, document.offset_at_position(params.position)

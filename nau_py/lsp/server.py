"""The Language Server Protocol (Microsoft, LSP 3.17) over :mod:`nau_py.lsp`, by pygls."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcInvalidParams
from pygls.workspace import TextDocument

from nau_py.diagnostics.diagnostic import Diagnostic, Fix
from nau_py.formats.load import is_library
from nau_py.lsp.complete import Completion, complete
from nau_py.lsp.hover import describe_word
from nau_py.lsp.language_server import NauServer, path_of
from nau_py.lsp.navigate import (
    RenameError,
    check_rename,
    find_definitions,
    find_references,
    plan_rename,
)
from nau_py.lsp.ranges import find_word, is_overlapping, make_range
from nau_py.syntax.document import Document, Edit
from nau_py.syntax.language import YAML_SUFFIXES

_KINDS = {
    "element": lsp.CompletionItemKind.Class,
    "attribute": lsp.CompletionItemKind.Property,
    "value": lsp.CompletionItemKind.EnumMember,
    "name": lsp.CompletionItemKind.Reference,
    "file": lsp.CompletionItemKind.File,
}
_QUICK_FIX = lsp.CodeActionKind.QuickFix
_FIX_ALL = lsp.CodeActionKind.SourceFixAll
_BARELY_BEGUN = 40
"""Characters up to which a file counts as new: its ending alone decides that it is a project."""


def make_server() -> NauServer:
    """Make a server with every feature, ready to be started."""
    server = NauServer()
    _follow_documents(server)
    _add_completion(server)
    _add_navigation(server)
    _add_rename(server)
    _add_code_actions(server)
    return server


def _follow_documents(server: NauServer) -> None:
    @server.feature(lsp.INITIALIZED)
    def begin(_: lsp.InitializedParams) -> None:
        folders = server.workspace.folders.values()
        server.session.folders = [path_of(f.uri) for f in folders]

    @server.feature(lsp.TEXT_DOCUMENT_DID_OPEN)
    def open_text(params: lsp.DidOpenTextDocumentParams) -> None:
        path = path_of(params.text_document.uri)
        server.session.set_text(path, params.text_document.text)
        server.lint(path)

    @server.feature(lsp.TEXT_DOCUMENT_DID_CHANGE)
    async def change_text(params: lsp.DidChangeTextDocumentParams) -> None:
        path = path_of(params.text_document.uri)
        document = server.workspace.get_text_document(params.text_document.uri)
        server.session.set_text(path, document.source)
        server.lint_soon(path)

    @server.feature(lsp.TEXT_DOCUMENT_DID_SAVE)
    def save_text(params: lsp.DidSaveTextDocumentParams) -> None:
        server.lint(path_of(params.text_document.uri))

    @server.feature(lsp.TEXT_DOCUMENT_DID_CLOSE)
    def close_text(params: lsp.DidCloseTextDocumentParams) -> None:
        path = path_of(params.text_document.uri)
        server.session.forget_text(path)
        for file in server.published.pop(path, {path}):
            server.publish(file, [])


def _add_completion(server: NauServer) -> None:
    @server.feature(
        lsp.TEXT_DOCUMENT_COMPLETION,
        lsp.CompletionOptions(trigger_characters=["<", '"', "'", " ", "/", ":", "-"]),
    )
    def complete_word(params: lsp.CompletionParams) -> lsp.CompletionList:
        path, document, offset = _locate(server, params)
        if not _is_readable(server, path):
            return lsp.CompletionList(False, [])
        cursor, found = complete(server.session.make_grammar(path), offset)
        span = make_range(document, cursor.begin, cursor.end)
        items = [_make_item(item, span, index) for index, item in enumerate(found)]
        return lsp.CompletionList(False, items)


def _make_item(found: Completion, span: lsp.Range, index: int) -> lsp.CompletionItem:
    return lsp.CompletionItem(
        found.label,
        kind=_KINDS[found.kind],
        detail=found.detail or None,
        documentation=_markdown(found.doc) if found.doc else None,
        text_edit=lsp.TextEdit(span, found.text),
        filter_text=found.text,
        sort_text=f"{index:04}",
    )


def _markdown(text: str) -> lsp.MarkupContent:
    return lsp.MarkupContent(lsp.MarkupKind.Markdown, text)


def _add_navigation(server: NauServer) -> None:
    @server.feature(lsp.TEXT_DOCUMENT_HOVER)
    def show_hover(params: lsp.HoverParams) -> lsp.Hover | None:
        path, _, offset = _locate(server, params)
        if not _is_readable(server, path):
            return None
        session = server.session
        text = describe_word(session.make_grammar(path), session.find_symbols(path), offset)
        return lsp.Hover(_markdown(text)) if text else None

    @server.feature(lsp.TEXT_DOCUMENT_DEFINITION)
    def show_definitions(params: lsp.DefinitionParams) -> list[lsp.Location]:
        path, _, offset = _locate(server, params)
        return server.make_locations(find_definitions(server.session, path, offset))

    @server.feature(lsp.TEXT_DOCUMENT_REFERENCES)
    def show_references(params: lsp.ReferenceParams) -> list[lsp.Location]:
        path, _, offset = _locate(server, params)
        declaration = params.context.include_declaration
        return server.make_locations(find_references(server.session, path, offset, declaration))


def _add_rename(server: NauServer) -> None:
    @server.feature(lsp.TEXT_DOCUMENT_PREPARE_RENAME)
    def prepare_rename(params: lsp.PrepareRenameParams) -> lsp.Range:
        path, document, offset = _locate(server, params)
        try:
            found = check_rename(server.session, path, offset)
        except RenameError as reason:
            raise JsonRpcInvalidParams(str(reason)) from None
        return make_range(document, found.begin, found.end)

    @server.feature(lsp.TEXT_DOCUMENT_RENAME, lsp.RenameOptions(prepare_provider=True))
    def rename(params: lsp.RenameParams) -> lsp.WorkspaceEdit:
        path, _, offset = _locate(server, params)
        try:
            found = plan_rename(server.session, path, offset, params.new_name)
        except RenameError as reason:
            raise JsonRpcInvalidParams(str(reason)) from None
        changes: dict[Path, list[Edit]] = {}
        for item in found:
            changes.setdefault(item.path, []).append((item.begin, item.end, params.new_name))
        return server.make_workspace_edit(changes)


def _add_code_actions(server: NauServer) -> None:
    @server.feature(
        lsp.TEXT_DOCUMENT_CODE_ACTION,
        lsp.CodeActionOptions(code_action_kinds=[_QUICK_FIX, _FIX_ALL]),
    )
    def show_actions(params: lsp.CodeActionParams) -> list[lsp.CodeAction]:
        path = path_of(params.text_document.uri)
        document = server.find_document(path)
        made: list[lsp.CodeAction] = []
        safe: dict[Path, list[Edit]] = {}
        for found, fix, edits in _plan_fixes(server, path):
            preferred = fix is found.fixes[0]
            if fix.safe and preferred:
                for file, listed in edits.items():
                    safe.setdefault(file, []).extend(listed)
            if is_overlapping(find_word(document, found.location), params.range):
                title = f"{fix.title} ({found.rule})"
                edit = server.make_workspace_edit(edits)
                action = lsp.CodeAction(title, _QUICK_FIX, is_preferred=preferred, edit=edit)
                made.append(action)
        if safe:
            edit = server.make_workspace_edit(safe)
            made.append(lsp.CodeAction("Apply all safe fixes", _FIX_ALL, edit=edit))
        wanted = tuple(_kind_name(kind) for kind in params.context.only or [""])
        return [action for action in made if _kind_name(action.kind).startswith(wanted)]


def _plan_fixes(
    server: NauServer, path: Path
) -> Iterator[tuple[Diagnostic, Fix, dict[Path, list[Edit]]]]:
    """Yield the findings of a file with each fix that fits the text, and its edits."""
    texts: dict[Path, Document] = {}
    for found in server.findings.get(path, []):
        for fix in found.fixes:
            edits = server.plan_fix(fix, texts)
            if edits:
                yield found, fix, edits


def _kind_name(kind: lsp.CodeActionKind | str | None) -> str:
    return kind.value if isinstance(kind, lsp.CodeActionKind) else kind or ""


def _is_readable(server: NauServer, path: Path) -> bool:
    """Report if a file is a project or a library, or the begin of one."""
    if server.session.is_project_file(path) or is_library(path):
        return True
    known = path.suffix.lower() in (".xml", ".mlib", *YAML_SUFFIXES)
    return known and len(server.session.read_text(path).strip()) < _BARELY_BEGUN


def _locate(
    server: NauServer,
    params: lsp.CompletionParams
    | lsp.HoverParams
    | lsp.DefinitionParams
    | lsp.ReferenceParams
    | lsp.PrepareRenameParams
    | lsp.RenameParams,
) -> tuple[Path, TextDocument, int]:
    """Return the file, its document and the offset of a request."""
    path = path_of(params.text_document.uri)
    document = server.find_document(path)
    return path, document, document.offset_at_position(params.position)

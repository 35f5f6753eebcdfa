"""An editor for tests: pygls' own client, talking to nau-lsp as a program."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import Callable, Coroutine
from pathlib import Path
from typing import Any

from lsprotocol import types as lsp
from pygls.lsp.client import LanguageClient
from pygls.uris import from_fs_path, to_fs_path

SERVER = [sys.executable, "-c", "from nau_py.cli.lsp import main; main()"]
SECONDS = 20.0


class Editor:
    """Open documents with their texts; places are named by the words that stand there."""

    def __init__(self, client: LanguageClient) -> None:
        self.client = client
        self.found: dict[Path, list[lsp.Diagnostic]] = {}
        self.versions: dict[Path, int] = {}
        self.texts: dict[Path, str] = {}
        self.news = asyncio.Event()

    def uri(self, path: Path) -> str:
        return from_fs_path(str(path)) or ""

    def text(self, path: Path) -> str:
        return self.texts.get(path) or path.read_text()

    async def open(self, path: Path, language: str = "xml") -> list[lsp.Diagnostic]:
        """Open a document; what is published about it."""
        self.texts[path], self.versions[path] = path.read_text(), 1
        self.found.pop(path, None)
        item = lsp.TextDocumentItem(self.uri(path), language, 1, self.texts[path])
        self.client.text_document_did_open(lsp.DidOpenTextDocumentParams(item))
        return await self.diagnostics(path)

    async def type(self, path: Path, text: str) -> list[lsp.Diagnostic]:
        """Replace a document's text; what is published about it."""
        self.texts[path] = text
        self.versions[path] += 1
        self.found.pop(path, None)
        self.client.text_document_did_change(
            lsp.DidChangeTextDocumentParams(
                lsp.VersionedTextDocumentIdentifier(self.versions[path], self.uri(path)),
                [lsp.TextDocumentContentChangeWholeDocument(text)],
            )
        )
        return await self.diagnostics(path)

    async def diagnostics(self, path: Path) -> list[lsp.Diagnostic]:
        while path not in self.found:
            await asyncio.wait_for(self.news.wait(), SECONDS)
            self.news.clear()
        return self.found[path]

    def at(self, path: Path, before: str, after: str = "") -> dict[str, Any]:
        """The place between two pieces of text that stand side by side once."""
        text = self.text(path)
        assert text.count(before + after) == 1, f"{before + after!r}: {text.count(before + after)}"
        offset = text.index(before + after) + len(before)
        line = text.count("\n", 0, offset)
        column = offset - (text.rfind("\n", 0, offset) + 1)
        return {
            "text_document": lsp.TextDocumentIdentifier(self.uri(path)),
            "position": lsp.Position(line, column),
        }

    async def complete(self, path: Path, before: str, after: str = "") -> list[lsp.CompletionItem]:
        params = lsp.CompletionParams(**self.at(path, before, after))
        found = await self.client.text_document_completion_async(params)
        assert isinstance(found, lsp.CompletionList)
        return list(found.items)

    async def labels(self, path: Path, before: str, after: str = "") -> list[str]:
        return [item.label for item in await self.complete(path, before, after)]

    async def hover(self, path: Path, before: str, after: str = "") -> str:
        found = await self.client.text_document_hover_async(
            lsp.HoverParams(**self.at(path, before, after))
        )
        assert found is not None
        assert isinstance(found.contents, lsp.MarkupContent)
        return found.contents.value

    async def definition(self, path: Path, before: str, after: str = "") -> list[str]:
        """``file: words from there to the end of the line``."""
        found = await self.client.text_document_definition_async(
            lsp.DefinitionParams(**self.at(path, before, after))
        )
        assert isinstance(found, list)
        return [self.said(place) for place in found if isinstance(place, lsp.Location)]

    async def references(self, path: Path, before: str, after: str = "") -> list[str]:
        context = lsp.ReferenceContext(include_declaration=True)
        found = await self.client.text_document_references_async(
            lsp.ReferenceParams(context=context, **self.at(path, before, after))
        )
        return [self.said(place) for place in found or []]

    def said(self, place: lsp.Location) -> str:
        path = Path(to_fs_path(place.uri) or "")
        lines = self.text(path).split("\n")
        start, end = place.range.start, place.range.end
        word = lines[start.line][start.character : end.character]
        return f"{path.name}:{start.line + 1}: {word}"

    async def rename(self, path: Path, new: str, before: str, after: str = "") -> None:
        params = lsp.RenameParams(new_name=new, **self.at(path, before, after))
        edit = await self.client.text_document_rename_async(params)
        assert edit is not None
        await self.apply(edit)

    async def actions(
        self, path: Path, diagnostic: lsp.Diagnostic | None = None, kind: str = "quickfix"
    ) -> list[lsp.CodeAction]:
        whole = lsp.Range(lsp.Position(0, 0), lsp.Position(10_000, 0))
        params = lsp.CodeActionParams(
            lsp.TextDocumentIdentifier(self.uri(path)),
            diagnostic.range if diagnostic else whole,
            lsp.CodeActionContext([diagnostic] if diagnostic else [], only=[kind]),
        )
        found = await self.client.text_document_code_action_async(params)
        return [a for a in found or [] if isinstance(a, lsp.CodeAction)]

    async def apply(self, edit: lsp.WorkspaceEdit) -> None:
        """Make the edits, in open documents or on disk, from the last to the first."""
        assert edit.changes
        for uri, edits in edit.changes.items():
            path = Path(to_fs_path(uri) or "")
            lines = self.text(path).split("\n")
            starts = [0]
            for line in lines:
                starts.append(starts[-1] + len(line) + 1)
            text = self.text(path)
            spans = sorted(
                (
                    starts[e.range.start.line] + e.range.start.character,
                    starts[e.range.end.line] + e.range.end.character,
                    e.new_text,
                )
                for e in edits
                if isinstance(e, lsp.TextEdit)
            )
            for begin, end, new in reversed(spans):
                text = text[:begin] + new + text[end:]
            if path in self.versions:
                await self.type(path, text)
            else:
                path.write_text(text)


def edit(folder: Path, work: Callable[[Editor], Coroutine[Any, Any, None]]) -> None:
    """Start nau-lsp with ``folder`` as its workspace, and work with it."""

    async def run() -> None:
        client = LanguageClient("test", "1")
        editor = Editor(client)

        @client.feature(lsp.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
        def published(params: lsp.PublishDiagnosticsParams) -> None:
            editor.found[Path(to_fs_path(params.uri) or "")] = list(params.diagnostics)
            editor.news.set()

        await client.start_io(*SERVER)
        root = from_fs_path(str(folder)) or ""
        await client.initialize_async(
            lsp.InitializeParams(
                lsp.ClientCapabilities(),
                workspace_folders=[lsp.WorkspaceFolder(root, "w")],
            )
        )
        client.initialized(lsp.InitializedParams())
        try:
            await asyncio.wait_for(work(editor), 10 * SECONDS)
            await client.shutdown_async(None)
            client.exit(None)
        finally:
            server = client._server
            if server is not None and server.returncode is None:
                try:
                    await asyncio.wait_for(server.wait(), SECONDS / 4)
                except TimeoutError:
                    server.kill()
            await client.stop()

    asyncio.run(run())

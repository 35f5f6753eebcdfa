"""Definitions, references and rename, across every file of the projects that share a name."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from nau_py.diagnostics.location import Location
from nau_py.diagnostics.suggest import format_names
from nau_py.lsp.links import find_bindings, find_link
from nau_py.lsp.session import EditorSession
from nau_py.lsp.symbols import Symbol, Symbols
from nau_py.syntax.document import find_offset


@dataclass(frozen=True, slots=True)
class Occurrence:
    """A word of a file: characters ``begin`` to ``end`` of its text."""

    path: Path
    begin: int
    end: int


class RenameError(ValueError):
    """The reason for which a name cannot be changed."""


def find_definitions(session: EditorSession, path: Path, offset: int) -> list[Occurrence]:
    """Return the definitions of the word at a character.

    It may be a name of the project, a file, a procedure of a program or a uniform of GLSL. For a
    word of a GLSL or program file, return the places at which the project binds it.
    """
    if not session.is_project_file(path):
        text = session.read_text(path)
        return [
            _locate_word(session, where)
            for project in session.find_users(path)
            for where in find_bindings(project, path.resolve(), text, offset)
        ]
    symbols = session.find_symbols(path)
    link = find_link(symbols, str(path), offset)
    if link is not None:
        return [_locate_word(session, where) for where in link.targets]
    symbol = symbols.find_symbol(str(path), offset)
    return _spans(symbols, symbols.find_same(symbol)[0]) if symbol is not None else []


def find_references(
    session: EditorSession, path: Path, offset: int, declaration: bool
) -> list[Occurrence]:
    """Return the uses of the word at a character, in every project that uses the file."""
    if not session.is_project_file(path):
        return find_definitions(session, path, offset)
    symbol = session.find_symbols(path).find_symbol(str(path), offset)
    if symbol is None:
        return []
    found: list[Occurrence] = []
    for symbols in session.find_all_symbols(_defining_file(session, path, symbol)):
        defined, used = symbols.find_same(symbol)
        found += _spans(symbols, [*(defined if declaration else []), *used])
    return list(dict.fromkeys(found))


def _defining_file(session: EditorSession, path: Path, symbol: Symbol) -> Path:
    """Return the file that defines a name; the projects that use this file share the name."""
    defined, _ = session.find_symbols(path).find_same(symbol)
    return Path(defined[0].location.file) if defined else path


def check_rename(session: EditorSession, path: Path, offset: int) -> Occurrence:
    """Return the name at a character. Raises :class:`RenameError` where it cannot be changed."""
    symbols = session.find_symbols(path)
    symbol = symbols.find_symbol(str(path), offset)
    if symbol is None:
        raise RenameError("there is no name here")
    if not symbols.find_same(symbol)[0]:
        raise RenameError(
            f"{symbol.kind} '{symbol.text}' is not defined in the project's own files"
        )
    return _spans(symbols, [symbol])[0]


def plan_rename(session: EditorSession, path: Path, offset: int, new: str) -> list[Occurrence]:
    """Return the words to replace by ``new``. Raises :class:`RenameError`."""
    check_rename(session, path, offset)
    symbol = session.find_symbols(path).find_symbol(str(path), offset)
    assert symbol is not None  # check_rename has found it
    if not new.strip() or "::" in new or any(c in new for c in "\"'<>&\n"):
        raise RenameError(f"'{new}' is no name")
    for symbols in session.find_all_symbols(_defining_file(session, path, symbol)):
        home = symbol.name[: len(symbol.name) - len(symbol.text)]
        taken = [s for s in symbols.definitions if (s.kind, s.name) == (symbol.kind, home + new)]
        if taken and new != symbol.text:
            place = format_names([str(taken[0].location)])
            raise RenameError(f"there is a {symbol.kind} '{new}' already: {place}")
    return find_references(session, path, offset, declaration=True)


def _spans(symbols: Symbols, listed: list[Symbol]) -> list[Occurrence]:
    spans = [symbols.find_span(s) for s in listed]
    return [Occurrence(Path(s[0]), s[1], s[2]) for s in spans if s is not None]


def _locate_word(session: EditorSession, where: Location) -> Occurrence:
    """Return the word at a location."""
    path = Path(where.file)
    text = session.read_text(path)
    begin = end = find_offset(text, where)
    while end < len(text) and (text[end].isalnum() or text[end] == "_"):
        end += 1
    return Occurrence(path, begin, end)

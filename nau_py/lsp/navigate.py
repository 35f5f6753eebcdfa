"""Definitions, references and rename, across every file of the projects that share a name."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from nau_py.diagnostics.location import Location
from nau_py.diagnostics.suggest import format_names
from nau_py.lsp.links import link_at, uses_of_word
from nau_py.lsp.session import Session
from nau_py.lsp.symbols import Symbol, Symbols


@dataclass(frozen=True, slots=True)
class Found:
    """A stretch of a file: characters ``begin`` to ``end`` of its text."""

    path: Path
    begin: int
    end: int


class CannotRename(ValueError):
    """Why a name stays as it is."""


def definition(session: Session, path: Path, offset: int) -> list[Found]:
    """Where the word at a character is defined: a name of the project, a file, a procedure of a
    program, a uniform of GLSL; in GLSL and program files, where the project binds it."""
    if not session.is_project_file(path):
        text = session.text(path)
        return [
            _place(session, where)
            for project in session.users(path)
            for where in uses_of_word(project, path.resolve(), text, offset)
        ]
    symbols = session.symbols(path)
    link = link_at(symbols, str(path), offset)
    if link is not None:
        return [_place(session, where) for where in link.targets]
    symbol = symbols.at(str(path), offset)
    return _spans(symbols, symbols.same(symbol)[0]) if symbol is not None else []


def references(session: Session, path: Path, offset: int, declaration: bool) -> list[Found]:
    """Everywhere that the word at a character is used, in every project that uses the file."""
    if not session.is_project_file(path):
        return definition(session, path, offset)
    symbol = session.symbols(path).at(str(path), offset)
    if symbol is None:
        return []
    found: list[Found] = []
    for symbols in session.all_symbols(_home(session, path, symbol)):
        defined, used = symbols.same(symbol)
        found += _spans(symbols, [*(defined if declaration else []), *used])
    return list(dict.fromkeys(found))


def _home(session: Session, path: Path, symbol: Symbol) -> Path:
    """The file that defines a name: whose users share it."""
    defined, _ = session.symbols(path).same(symbol)
    return Path(defined[0].location.file) if defined else path


def renamable(session: Session, path: Path, offset: int) -> Found:
    """The word at a character, where it can be renamed. Raises :class:`CannotRename`."""
    symbols = session.symbols(path)
    symbol = symbols.at(str(path), offset)
    if symbol is None:
        raise CannotRename("there is no name here")
    if not symbols.same(symbol)[0]:
        raise CannotRename(
            f"{symbol.kind} '{symbol.text}' is not defined in the project's own files"
        )
    return _spans(symbols, [symbol])[0]


def rename(session: Session, path: Path, offset: int, new: str) -> list[Found]:
    """The stretches to replace by ``new``. Raises :class:`CannotRename`."""
    renamable(session, path, offset)
    symbol = session.symbols(path).at(str(path), offset)
    assert symbol is not None  # renamable has found it
    if not new.strip() or "::" in new or any(c in new for c in "\"'<>&\n"):
        raise CannotRename(f"'{new}' is no name")
    for symbols in session.all_symbols(_home(session, path, symbol)):
        home = symbol.name[: len(symbol.name) - len(symbol.text)]
        taken = [s for s in symbols.definitions if (s.kind, s.name) == (symbol.kind, home + new)]
        if taken and new != symbol.text:
            place = format_names([str(taken[0].location)])
            raise CannotRename(f"there is a {symbol.kind} '{new}' already: {place}")
    return references(session, path, offset, declaration=True)


def _spans(symbols: Symbols, listed: list[Symbol]) -> list[Found]:
    spans = [symbols.span(s) for s in listed]
    return [Found(Path(s[0]), s[1], s[2]) for s in spans if s is not None]


def _place(session: Session, where: Location) -> Found:
    """A location as the word that stands there."""
    path = Path(where.file)
    text = session.text(path)
    begin = 0
    for _ in range(where.line - 1):
        begin = text.find("\n", begin) + 1
    begin += where.column - 1
    end = begin
    while end < len(text) and (text[end].isalnum() or text[end] == "_"):
        end += 1
    return Found(path, begin, end)

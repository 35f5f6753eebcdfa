"""``nau-lint``: check projects and libraries without running them."""

from __future__ import annotations

import sys
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from nau_py.api import lint as check
from nau_py.cli.common import FAILED, say
from nau_py.diagnostics.diagnostic import Diagnostic, error
from nau_py.diagnostics.location import Location
from nau_py.diagnostics.reporters import format_path, must_fail, to_json, to_sarif, to_text
from nau_py.formats.load import is_library, load_library, load_project
from nau_py.syntax.edit import plan_fixes
from nau_py.version import __version__

app = typer.Typer(add_completion=False, pretty_exceptions_enable=False)
_SUFFIXES = (".xml", ".yaml", ".yml", ".mlib")


class ReportFormat(StrEnum):
    """Output formats."""

    TEXT = "text"
    JSON = "json"
    SARIF = "sarif"


def collect(paths: list[Path]) -> list[Path]:
    """Files to check: those given, and the projects and libraries below given folders."""
    found: list[Path] = []
    for path in paths:
        if path.is_dir():
            found += sorted(p for p in path.rglob("*") if _looks_like_a_project(p))
        else:
            found.append(path)
    return list(dict.fromkeys(found))


def _looks_like_a_project(path: Path) -> bool:
    if path.suffix.lower() not in _SUFFIXES or not path.is_file():
        return False
    if path.suffix.lower() == ".mlib":
        return True
    head = path.read_bytes()[:4096]
    if path.suffix.lower() == ".xml":
        return b"<project" in head
    return b"pipelines:" in path.read_bytes()


@app.command()
def lint(
    paths: Annotated[list[Path], typer.Argument(help="Projects, material libraries or folders.")],
    format: Annotated[ReportFormat, typer.Option(help="Output format.")] = ReportFormat.TEXT,
    models: Annotated[bool, typer.Option(help="Load and check the models too.")] = False,
    strict: Annotated[bool, typer.Option(help="Warnings fail too.")] = False,
    fix: Annotated[bool, typer.Option(help="Apply the safe fixes; report what is left.")] = False,
) -> None:
    """Check projects: exit status 1 where one has an error."""
    files = collect(paths)
    found, sources = _check(files, models)
    if fix and _fix(found):
        found, sources = _check(files, models)
    if format is ReportFormat.JSON:
        sys.stdout.write(to_json(found))
    elif format is ReportFormat.SARIF:
        sys.stdout.write(to_sarif(found, __version__))
    else:
        sys.stdout.write(to_text(found, sources))
    if must_fail(found, strict):
        raise typer.Exit(FAILED)


def _check(files: list[Path], models: bool) -> tuple[list[Diagnostic], dict[str, str]]:
    """Return all findings, and the texts of the files."""
    found: list[Diagnostic] = []
    sources: dict[str, str] = {}
    for path in files:
        project = load_library(path) if is_library(path) else load_project(path)
        found += check(project, models)
        sources |= project.sources
    return list(dict.fromkeys(found)), sources


def _fix(found: list[Diagnostic]) -> int:
    """Apply the safe fixes; returns how many files changed. Says on stderr what was done."""
    safe = [next((f for f in d.fixes if f.safe), None) for d in found]
    files, made = plan_fixes(f for f in safe if f is not None)
    written: set[str] = set()
    for path, (document, edits) in files.items():
        try:
            document.write(path, edits)
        except OSError as problem:
            say([error("E002", Location(str(path)), f"cannot be written: {problem.strerror}")], {})
        else:
            written.add(str(path))
    for fix in dict.fromkeys(made):
        where = fix.changes[0].location
        if str(Path(where.file)) not in written:
            continue
        place = Location(format_path(where.file), where.line, where.column)
        sys.stderr.write(f"{place}: fixed: '{fix.changes[0].old}': {fix.title}\n")
    return len(written)


def main() -> None:
    """Entry point of ``nau-lint``."""
    app()

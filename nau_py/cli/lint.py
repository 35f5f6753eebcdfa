"""``nau-lint``: check projects and libraries without running them."""

from __future__ import annotations

import sys
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from nau_py.cli.common import FAILED
from nau_py.diagnostic import Diagnostic

app = typer.Typer(add_completion=False, pretty_exceptions_enable=False)
_SUFFIXES = (".xml", ".yaml", ".yml", ".mlib")


class Style(StrEnum):
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
    format: Annotated[Style, typer.Option(help="Output format.")] = Style.TEXT,
    models: Annotated[bool, typer.Option(help="Load and check the models too.")] = False,
    strict: Annotated[bool, typer.Option(help="Warnings fail too.")] = False,
) -> None:
    """Check projects: exit status 1 where one has an error."""
    from nau_py.api import lint as check
    from nau_py.formats.load import is_library, load_library, load_project
    from nau_py.lint.report import to_json, to_sarif, to_text, worst
    from nau_py.version import __version__

    found: list[Diagnostic] = []
    sources: dict[str, str] = {}
    for path in collect(paths):
        project = load_library(path) if is_library(path) else load_project(path)
        found += check(project, models)
        sources |= project.sources
    found = list(dict.fromkeys(found))
    if format is Style.JSON:
        sys.stdout.write(to_json(found))
    elif format is Style.SARIF:
        sys.stdout.write(to_sarif(found, __version__))
    else:
        sys.stdout.write(to_text(found, sources))
    if worst(found, strict):
        raise typer.Exit(FAILED)


def main() -> None:
    """Entry point of ``nau-lint``."""
    app()

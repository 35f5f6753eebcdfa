"""What the commands share: exit statuses, diagnostics on stderr, no traceback for bad input."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

import typer

from nau_py.diagnostic import Diagnostic
from nau_py.errors import NauError
from nau_py.lint.report import to_text

FAILED = 1
USAGE = 2


def say(diagnostics: Iterable[Diagnostic], sources: Mapping[str, str]) -> None:
    """Write findings to stderr."""
    sys.stderr.write(to_text(diagnostics, sources))


def guarded(work: Callable[[], int], sources: Mapping[str, str], debug: bool) -> int:
    """Run a command's work: a :class:`NauError` becomes diagnostics and exit status 1."""
    try:
        return work()
    except NauError as problem:
        if debug:
            raise
        say(problem.diagnostics, sources)
        return FAILED
    except KeyboardInterrupt:
        sys.stderr.write("interrupted\n")
        return 130


def existing(path: Path) -> Path:
    """Refuse a path that does not exist, as wrong usage."""
    if not path.exists():
        sys.stderr.write(f"no such file: {path}\n")
        raise typer.Exit(FAILED)
    return path


def run_app(app: typer.Typer) -> None:
    """Run a typer application with its own exit status."""
    app()

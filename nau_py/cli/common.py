"""Common parts of the commands: exit statuses, diagnostics on stderr, no traceback."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

import typer

from nau_py.api import lint
from nau_py.diagnostics.diagnostic import Diagnostic, error
from nau_py.diagnostics.errors import NauError, OutputError
from nau_py.diagnostics.location import NOWHERE
from nau_py.diagnostics.reporters import to_text
from nau_py.model.linked import Project
from nau_py.process.files import write_text

FAILED = 1
USAGE = 2


def say(diagnostics: Iterable[Diagnostic], sources: Mapping[str, str]) -> None:
    """Write findings to stderr."""
    sys.stderr.write(to_text(diagnostics, sources))


def stop_if_unreadable(project: Project) -> None:
    """Report files that could not be read (rules X001, X002), and exit with status 1."""
    broken = [d for d in lint(project) if d.rule in ("X001", "X002")]
    if broken:
        say(broken, project.sources)
        raise typer.Exit(FAILED)


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


def write_result(output: Path | None, text: str) -> None:
    """Write a command's result to a file, whole or not at all, or to stdout.

    Raises :class:`~nau_py.OutputError`.
    """
    if output is None:
        sys.stdout.write(text)
        return
    try:
        write_text(output, text)
    except OSError as problem:
        message = f"output '{output}' cannot be written: {problem.strerror}"
        raise OutputError(error("E002", NOWHERE, message)) from None


def size_of(text: str | None) -> tuple[int, int] | None:
    """Width and height of WIDTHxHEIGHT. Raises typer.BadParameter."""
    if text is None:
        return None
    match = re.fullmatch(r"(\d+)[xX](\d+)", text)
    if match is None or 0 in (int(match[1]), int(match[2])):
        raise typer.BadParameter(f"'{text}' is no size; write WIDTHxHEIGHT, as in 512x512")
    return int(match[1]), int(match[2])

"""Commands and environments of child processes that import nothing from the working folder.

``python -c`` and ``python -m`` put the working folder first on the import path. A project's own
``typer.py`` would then run in the child, even where the user refused the project's programs.
Every child process of this package is started with a command of :func:`python_command` in an
environment of :func:`isolated_environment`.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

Process = subprocess.Popen[bytes]
PACKAGE_PARENT = str(Path(__file__).resolve().parents[2])
"""Folder that holds the package, for interpreters that do not have it installed."""
_BOOTSTRAP = (
    "import sys; folder = sys.argv.pop(1); folder in sys.path or sys.path.append(folder); "
    "from nau_py.process.entry import main; main()"
)


def python_command(entry: str, arguments: Sequence[str], file_limit: int = 0) -> list[str]:
    """Return the command that calls the function ``entry``, ``MODULE:FUNCTION``, in a new Python.

    ``arguments`` become its ``sys.argv``. ``file_limit``: bytes of the largest file that it may
    write, 0 for no limit. The interpreter is this one (``sys.executable``), so a virtual
    environment and an editable installation hold in the child too; ``-P`` keeps the working
    folder off its import path.
    """
    start = [sys.executable, "-P", "-c", _BOOTSTRAP, PACKAGE_PARENT]
    return [*start, entry, str(file_limit), *arguments]


def isolated_environment(more: Mapping[str, str] | None = None) -> dict[str, str]:
    """Return this process's environment without relative folders in ``PYTHONPATH``, and ``more``.

    An empty entry of ``PYTHONPATH`` (``PYTHONPATH=$PYTHONPATH:/folder``) means the working folder.
    ``PYTHONSAFEPATH`` isolates the Python processes that the child starts.
    """
    environment = dict(os.environ)
    folders = environment.pop("PYTHONPATH", "").split(os.pathsep)
    kept = [folder for folder in folders if os.path.isabs(folder)]
    if kept:
        environment["PYTHONPATH"] = os.pathsep.join(kept)
    return environment | {"PYTHONSAFEPATH": "1"} | dict(more or {})


def start_python(entry: str, arguments: Sequence[str], log: Path) -> Process:
    """Start ``entry`` in a new Python; standard error goes to ``log``, standard output nowhere."""
    with log.open("wb") as stream:
        return subprocess.Popen(
            python_command(entry, arguments),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=stream,
            env=isolated_environment(),
        )

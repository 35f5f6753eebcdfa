"""First function of every child process (see :mod:`nau_py.process.isolation`)."""

from __future__ import annotations

import os
import sys
from importlib import import_module


def main() -> None:
    """Limit the size of written files and call ``MODULE:FUNCTION``, both from ``sys.argv``."""
    module, _, function = sys.argv.pop(1).partition(":")
    file_limit = int(sys.argv.pop(1))
    if file_limit:
        limit_file_size(file_limit)
    getattr(import_module(module), function)()


def limit_file_size(size: int) -> None:
    """Forbid files beyond ``size`` bytes in this process, its redirected output included.

    Windows has no such limit.
    """
    if os.name != "posix":
        return
    import resource

    resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

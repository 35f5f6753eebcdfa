"""Import of numba without a configuration from the working folder.

numba reads ``.numba_config.yaml`` in the working folder when it is imported, and again before
each compilation. Such a file can move the cache of machine code into the project, whose index
files are pickles: loading one runs what it says. Environment variables (``NUMBA_*``) are the
user's own and stay in force.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager

_NO_FILE = ""
"""Name of no file: where numba looks for its configuration afterwards."""


def import_numba() -> None:
    """Import numba, and make it ignore ``.numba_config.yaml`` in this process.

    Call before the first ``import numba`` of the package. If the program imported numba earlier,
    the settings that such a file made are undone.
    """
    with _without_yaml():
        from numba.core import config
    config._config_fname = _NO_FILE
    config.reload_config()


@contextmanager
def _without_yaml() -> Iterator[None]:
    """Hide PyYAML: without it numba reads no configuration file, and warns that it does not."""
    missing = object()
    before = sys.modules.get("yaml", missing)
    sys.modules["yaml"] = None  # type: ignore[assignment]
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", "A Numba config file is found")
            yield
    finally:
        del sys.modules["yaml"]
        if before is not missing:
            sys.modules["yaml"] = before  # type: ignore[assignment]

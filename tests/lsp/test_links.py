"""Procedures of programs: ``lsp/links.py``."""

from __future__ import annotations

from nau_py.lsp.links import list_procedures
from tests.conftest import Folder


def test_procedures_of_neighbours_have_their_places(folder: Folder) -> None:
    folder.write("common.py", "from other import *\n\n\ndef sky(rays):\n    return 0\n")
    folder.write("other.py", "import common\n\n\ndef lit(rays):\n    return 1\n")
    folder.write(
        "prog.py", "from common import lit, sky as blue\n\n\ndef shade(hits):\n    return 1\n"
    )
    found = list_procedures(folder.path / "prog.py")
    places = {name: (where.file, where.line) for name, where in found.items()}
    assert places == {
        "lit": (str(folder.path / "other.py"), 4),
        "blue": (str(folder.path / "common.py"), 4),
        "shade": (str(folder.path / "prog.py"), 4),
    }

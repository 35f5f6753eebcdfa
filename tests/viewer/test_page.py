"""The JavaScript modules of the page: imports exist and make no circle."""

from __future__ import annotations

import re
from graphlib import TopologicalSorter
from pathlib import Path

import nau_py.viewer

PAGE = Path(nau_py.viewer.__file__).parent / "page"


def test_modules_import_without_circles() -> None:
    texts = {p.name: p.read_text() for p in PAGE.glob("*.js")}
    imports: dict[str, set[str]] = {}
    for name, text in texts.items():
        found = re.findall(r'^import \{([^}]*)\} from "\./([\w.]+)";$', text, re.MULTILINE)
        assert len(found) == len(re.findall(r"^import\b", text, re.MULTILINE)), name
        imports[name] = {file for _, file in found}
        for words, file in found:
            exported = re.findall(
                r"^export (?:async )?(?:const|function) ([\w$]+)", texts[file], re.M
            )
            for word in words.split(","):
                assert word.strip() in exported, f"{name}: {word} of {file}"
                rest = text.replace(words, "")
                assert re.search(rf"(?<![\w$]){re.escape(word.strip())}(?![\w$])", rest), word
    list(TopologicalSorter(imports).static_order())  # raises CycleError

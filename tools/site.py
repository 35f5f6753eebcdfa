"""Sources of the site: ``python -m tools.site ROOT OUT`` writes them for mkdocs."""

from __future__ import annotations

import json
import shutil
import sys
from pathlib import Path
from typing import Any

from nau_py.process.files import write_text
from tools.gallery import build_gallery, copy_sources

NAV: list[dict[str, Any]] = [
    {"nau_py": "index.md"},
    {
        "Guide": [
            {"Install": "docs/install.md"},
            {"First project": "docs/first-project.md"},
            {"Project format": "docs/format.md"},
            {"Where to trace": "docs/selection.md"},
            {"Ray programs": "docs/programs.md"},
            {"Effects on demand": "docs/effects-on-demand.md"},
            {"Accuracy against time": "docs/cost.md"},
            {"The graph of a pipeline": "docs/graph.md"},
            {"The viewer": "docs/viewer.md"},
            {"Help in the editor": "docs/editors.md"},
            {"Grading a class": "docs/grading.md"},
            {"A course": "projects/course/README.md"},
        ]
    },
    {"Gallery": "gallery/index.md"},
    {"Effects": "docs/effects/README.md"},
    {
        "Reference": [
            {"Project file": "docs/reference.md"},
            {"Extensions": "docs/extensions.md"},
            {"Lint rules": "docs/rules.md"},
            {"Report": "docs/report.md"},
        ]
    },
    {"Accuracy": "docs/accuracy.md"},
    {"Performance": "docs/performance.md"},
    {"Conformance": "docs/conformance.md"},
    {
        "Extending": [
            {"Plug-ins": "docs/extending.md"},
            {"Development": "docs/development.md"},
            {"Dependencies": "docs/dependencies.md"},
        ]
    },
]


def configuration() -> dict[str, Any]:
    """Return mkdocs' configuration. Links are checked; pages of the samples need no entry."""
    return {
        "site_name": "nau_py",
        "site_description": "Hybrid rendering from project files",
        "docs_dir": "src",
        "site_dir": "html",
        "theme": {"name": "readthedocs", "navigation_depth": 2, "highlightjs": True},
        "use_directory_urls": False,
        "validation": {
            "nav": {"omitted_files": "ignore", "not_found": "warn"},
            "links": {"not_found": "warn", "anchors": "warn", "unrecognized_links": "warn"},
        },
        "markdown_extensions": ["tables", "fenced_code", "toc"],
        "nav": NAV,
    }


def main() -> None:
    """Write ``OUT/src`` and ``OUT/mkdocs.yml``."""
    root, out = Path(sys.argv[1]), Path(sys.argv[2])
    shutil.rmtree(out, ignore_errors=True)
    source = out / "src"
    source.mkdir(parents=True)
    copy_sources(root, source)
    for line in build_gallery(root, source / "gallery"):
        sys.stderr.write(f"{line}\n")
    write_text(out / "mkdocs.yml", json.dumps(configuration(), indent=2) + "\n")  # JSON is YAML


if __name__ == "__main__":
    main()

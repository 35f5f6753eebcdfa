"""Sources of the site: ``python -m tools.site ROOT OUT`` writes them for mkdocs."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

from tools.gallery import build_gallery, copy_sources


def main() -> None:
    """Write ``OUT/src`` and copy ``mkdocs.yml`` beside it."""
    root, out = Path(sys.argv[1]), Path(sys.argv[2])
    shutil.rmtree(out, ignore_errors=True)
    source = out / "src"
    source.mkdir(parents=True)
    copy_sources(root, source)
    for line in build_gallery(root, source / "gallery"):
        sys.stderr.write(f"{line}\n")
    shutil.copy(root / "mkdocs.yml", out)


if __name__ == "__main__":
    main()

"""The language of a project file, by its ending."""

from __future__ import annotations

from pathlib import Path

YAML_SUFFIXES = (".yaml", ".yml")


def is_yaml(path: Path) -> bool:
    """Report if a file is written in YAML."""
    return path.suffix.lower() in YAML_SUFFIXES

"""The example package of docs/extending as if it were installed."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

from tests.conftest import ROOT

EXAMPLE = ROOT / "docs" / "extending"


def install(folder: Path, groups: dict[str, dict[str, str]], name: str) -> None:
    """Write what pip leaves of a package's entry points."""
    info = folder / f"{name}-0.1.0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 0.1.0\n")
    lines = []
    for group, entries in groups.items():
        lines += [f"[{group}]", *(f"{key} = {value}" for key, value in entries.items()), ""]
    (info / "entry_points.txt").write_text("\n".join(lines))


def run(command: str, *arguments: str, env: dict[str, str]) -> subprocess.CompletedProcess[str]:
    program = str(Path(sys.executable).parent / command)
    return subprocess.run(
        [program, *arguments], env=env, capture_output=True, text=True, timeout=120
    )


def install_example(site: Path) -> dict[str, str]:
    """Install the example package into the folder ``site``; return an environment that has it."""
    declared = tomllib.loads((EXAMPLE / "pyproject.toml").read_text())
    install(site, declared["project"]["entry-points"], "nau_example")
    for file in EXAMPLE.glob("nau_example_*.py"):
        shutil.copy(file, site)
    return os.environ | {"PYTHONPATH": str(site)}

"""The gallery of the site: every sample project with its picture, graph, time and rays."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from pathlib import Path

from nau_py.api import load, plan
from nau_py.graph.picture import draw_svg
from nau_py.model.linked import Project
from nau_py.process.files import write_bytes, write_text
from nau_py.reporting.pass_rows import make_pass_grid
from nau_py.reporting.pixels import encode_png
from nau_py.reporting.table import to_markdown
from nau_py.run.frame import Frame
from nau_py.run.renderer import Renderer


def sample_projects(root: Path) -> list[Path]:
    """List the sample projects of a repository: the demos first, then the course."""
    found = sorted((root / "projects").glob("*/project.xml"))
    return found + sorted((root / "projects").glob("course/*.xml"))


def name_project(root: Path, file: Path) -> str:
    """Return the name of a sample project: its folder, with its file where that has several."""
    parts = file.relative_to(root / "projects").with_suffix("").parts
    return "_".join(parts).removesuffix("_project")


def build_gallery(root: Path, out: Path) -> Iterator[str]:
    """Render the samples of ``root``; write ``index.md`` and pictures into ``out``.

    Yields a line of progress for each project. Raises
    :class:`~nau_py.diagnostics.errors.NauError`.
    """
    out.mkdir(parents=True, exist_ok=True)
    lines = [
        "# Gallery",
        "",
        "Every sample project: its picture, its passes, and their time on the machine that built "
        "this page.",
        "",
    ]
    for file in sample_projects(root):
        project = load(file)
        renderer = Renderer(project)
        try:
            frame = renderer.render()
        finally:
            renderer.close()
        name = name_project(root, file)
        write_bytes(out / f"{name}.png", encode_png(frame.image))
        write_text(out / f"{name}.svg", draw_svg(plan(project).graph))
        lines += _entry(root, file, project, frame, name)
        yield f"{name}: {frame.report['frames'][-1]['ms']:.0f} ms"
    write_text(out / "index.md", "\n".join(lines))


def _entry(root: Path, file: Path, project: Project, frame: Frame, name: str) -> list[str]:
    folder = file.parent.relative_to(root).as_posix()
    report = frame.report["frames"][-1]
    readme = file.parent / "README.md"
    text = readme.read_text("utf-8") if readme.exists() else ""
    titles = re.findall(r"^# (.+)$", text, re.MULTILINE) if file.stem == "project" else []
    title = titles[0] if titles else project.name
    height, width = frame.image.shape[:2]
    about = f"{width} × {height}, {report['ms']:,.0f} ms. Files: [README](../{folder}/README.md)"
    return [
        f"## {title}",
        "",
        f"![{title}]({name}.png)",
        "",
        f"{about}, [{file.name}](../{folder}/{file.name}).",
        "",
        *to_markdown(make_pass_grid(report)),
        "",
        f"![passes and targets of {title}]({name}.svg)",
        "",
    ]


def copy_sources(root: Path, out: Path) -> None:
    """Copy the pages of the site and the files they link to, in the folders of the repository.

    These are the README as the first page, docs, and the samples without their models.
    """
    shutil.copytree(root / "docs", out / "docs", ignore=shutil.ignore_patterns("__pycache__"))
    skip = shutil.ignore_patterns("models", "__pycache__", "*.nau_cache")
    shutil.copytree(root / "projects", out / "projects", ignore=skip)
    shutil.copytree(root / "materials", out / "materials")
    write_text(out / "index.md", (root / "README.md").read_text("utf-8"))

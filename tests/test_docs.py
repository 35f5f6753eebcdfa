"""The documentation: its first project renders, its links lead somewhere."""

from __future__ import annotations

import re

import numpy as np

import nau_py
from tests.conftest import ROOT, Folder

DOCS = ROOT / "docs"


def test_the_first_project_renders(folder: Folder) -> None:
    text = (DOCS / "first-project.md").read_text()
    blocks = re.findall(r"```xml\n(<project.*?)```", text, re.DOTALL)
    folder.write("box.xml", blocks[0])
    project = folder.load("box.xml")
    assert nau_py.lint(project) == []
    image = nau_py.Renderer(project, size=(64, 64)).render().image
    assert len(np.unique(image.reshape(-1, 4), axis=0)) >= 4


def test_every_built_in_name_in_the_docs_exists() -> None:
    from nau_py.raytrace.programs.catalogue import BUILTIN_PROGRAMS

    for page in DOCS.glob("*.md"):
        for name in re.findall(r'file="builtin" proc="(\w+)"', page.read_text()):
            assert name in BUILTIN_PROGRAMS, page


def test_links_lead_somewhere() -> None:
    for page in [ROOT / "README.md", *DOCS.glob("*.md")]:
        for target in re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", page.read_text()):
            assert (page.parent / target).exists(), f"{page.name}: {target}"


def test_no_sentence_begins_with_a_question_word() -> None:
    """Headings may: a reader's question is a heading. The reference has the texts of the models."""
    words = "What|Whose|Whether|Where|Which|How"
    for page in [ROOT / "README.md", *DOCS.rglob("*.md"), *(ROOT / "projects").rglob("*.md")]:
        if page.name == "reference.md":
            continue
        for line in page.read_text().splitlines():
            found = re.search(rf"(^|[.:;|] )({words}) ", line) if line[:1] != "#" else None
            assert found is None, f"{page.name}: {line}"


def test_the_reference_is_up_to_date() -> None:
    from tools.reference import reference_page

    assert (DOCS / "reference.md").read_text() == reference_page(), "run scripts/reference"

"""A pass class with a parameter is one file: docs/extending/nau_example_pass.py."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.conftest import ROOT
from tests.plugins import install_example, run

SIZE = (24, 16)
PROJECT = """\
<project name="P" width="24" height="16">
  <assets>
    <viewports><viewport name="V"><CLEAR_COLOR r="0.5" g="1" b="0.25" /></viewport></viewports>
    <cameras><camera name="C"><viewport name="V" /></camera></cameras>
    <materialLibs><materialLib filename="lib.mlib" /></materialLibs>
  </assets>
  <pipelines>
    <pipeline name="Q" defaultCamera="C">
      <pass name="draw" class="default">
        <camera name="C" />
        <renderTarget name="rt" fromLibrary="L" />
      </pass>
      <pass name="darken" class="vignette">
        <renderTarget name="rt" fromLibrary="L" />
        <STRENGTH value="0.8" />
      </pass>
    </pipeline>
  </pipelines>
</project>
"""
LIBRARY = """\
<materialLib name="L"><renderTargets>
<renderTarget name="rt"><SIZE width="24" height="16" /><CLEAR_VALUES r="0.5" g="1" b="0.25" />
<colors><color name="c" internalFormat="RGBA32F" /></colors></renderTarget>
</renderTargets></materialLib>
"""


class Site:
    """A project, and an environment in which the package of the example is installed."""

    def __init__(self, folder: Path) -> None:
        self.project = folder / "project.xml"
        self.project.write_text(PROJECT)
        (folder / "lib.mlib").write_text(LIBRARY)
        self.environment = install_example(folder / "site")

    def python(self, code: str) -> str:
        """Return what ``code`` prints; ``project`` is the path of the project."""
        path = f"{self.environment['PYTHONPATH']}{os.pathsep}{ROOT}"
        done = subprocess.run(
            [sys.executable, "-c", f"project = {str(self.project)!r}\n{code}"],
            env=self.environment | {"PYTHONPATH": path},
            capture_output=True,
            text=True,
            timeout=120,
        )
        assert done.returncode == 0, done.stderr
        return done.stdout


@pytest.fixture
def site(tmp_path: Path) -> Site:
    return Site(tmp_path)


@pytest.mark.parametrize(
    "old, new, expected",
    [
        ('"0.8"', '"0.5"', []),
        (
            "STRENGTH",
            "STRENGHT",
            [("S001", 15, 9, "(did you mean 'STRENGTH'?)")],
        ),
        (
            '"0.8"',
            '"1.5"',
            [("V006", 15, 9, "<STRENGTH> of <pass> is 1.5; it must be from 0 to 1")],
        ),
        (
            '<camera name="C" />\n',
            '<camera name="C" />\n        <STRENGTH value="1" />\n',
            [("P007", 11, 9, "pass 'draw': STRENGTH is a parameter of class 'vignette'")],
        ),
    ],
    ids=["legal", "unknown", "out of range", "of another class"],
)
def test_lint(site: Site, old: str, new: str, expected: list[tuple[str, int, int, str]]) -> None:
    site.project.write_text(PROJECT.replace(old, new))
    done = run("nau-lint", str(site.project), "--format", "json", env=site.environment)
    found = [d for d in json.loads(done.stdout) if d["rule"] != "Z001"]
    assert [(d["rule"], d["line"], d["column"]) for d in found] == [e[:3] for e in expected]
    for finding, (_, _, _, text) in zip(found, expected):
        assert text in finding["message"]


COMPLETE = """\
from pathlib import Path
import nau_py
from nau_py.lsp.complete import Grammar, complete
text = Path(project).read_text()
grammar = Grammar(text, False, False, Path(project), nau_py.load(project))
for place in ('<STRENGTH', '<camera name="C" />\\n'):
    print([p.label for p in complete(grammar, text.index(place) + 1)[1]].count('STRENGTH'))
(entry,) = [p for p in complete(grammar, text.index('<STRENGTH') + 1)[1] if p.label == 'STRENGTH']
print(entry.detail, entry.doc)
(entry,) = [p for p in complete(grammar, text.index('vignette'))[1] if p.label == 'vignette']
print(entry.doc)
"""


def test_completion(site: Site) -> None:
    """The parameter is proposed inside such a pass only, the class with its documentation."""
    assert site.python(COMPLETE).splitlines() == [
        "1",
        "0",
        "FLOAT Light that the corners lose.",
        "Darkens its render target towards the corners.",
    ]


def test_reference(site: Site) -> None:
    page = site.python("from tools.reference import reference_page\nprint(reference_page())")
    section = page[page.index("### VignettePass") :]
    section = section[: section.index("### ", 4)]
    assert "Darkens its render target towards the corners." in section
    assert (
        "| `STRENGTH` | FLOAT | 0.5 | 0 to 1 | share of the light | Light that the corners lose. |"
    ) in section


def test_picture(site: Site) -> None:
    """Each pixel keeps 1 - STRENGTH r^2 / 2 of its colour, r the distance from the middle in halves
    of the width and the height."""
    saved = site.project.with_suffix(".npy")
    site.python(
        "import numpy, nau_py\n"
        "frame = nau_py.Renderer(nau_py.load(project), keep_targets=True).render()\n"
        f"numpy.save({str(saved)!r}, frame.targets['L::c'])"
    )
    width, height = SIZE
    x = (np.arange(width) + 0.5) / width * 2 - 1
    y = (np.arange(height) + 0.5) / height * 2 - 1
    factor = 1 - 0.8 * (x[None, :] ** 2 + y[:, None] ** 2) / 2
    expected = factor[:, :, None] * np.array([0.5, 1, 0.25])
    found = np.load(saved)
    np.testing.assert_allclose(found[:, :, :3], expected, rtol=1e-5)
    assert found[0, 0, 1] == pytest.approx(0.2811, abs=1e-4)  # a corner, of a colour of 1

"""A class of projects: good ones, wrong ones, and such as hang, crash or eat memory."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.conftest import Folder, heed_interrupts
from tests.raytrace.studio import colour, program, square, studio

RUN = [str(Path(sys.executable).parent / "nau-run")]
TURN = '<ROTATE x="1" y="0" z="0" w="90" />'
EVIL = {
    "hangs": "import time\n\ndef shade(hits):\n    time.sleep(1000)\n",
    "crashes": "import ctypes\n\ndef shade(hits):\n    ctypes.string_at(0)\n",
    "eats": (
        "import numpy as np\nkept = []\n\ndef shade(hits):\n    while True:\n"
        "        kept.append(np.ones(4_000_000))\n"
    ),
    "raises": "def shade(hits):\n    raise RuntimeError('<script>alert(1)</script>')\n",
}


def project(path: Path, source: str = "") -> None:
    """A wall before the camera, shaded by a built-in program or by ``source``."""
    path.mkdir(parents=True)
    folder = Folder(path)
    studio(
        folder,
        square("wall", "Glow", [9, 1, 9], [0, 0, -1], TURN),
        {"Glow": colour("EMISSION", 0.2, 0.5, 0.8, 1.0)},
        program("Glow", "emission"),
        size=(24, 16),
    )
    if source:
        folder.write("mine.py", source)
        text = (path / "project.xml").read_text()
        own = 'type="CLOSEST_HIT" file="mine.py" proc="shade"'
        text = text.replace('type="CLOSEST_HIT" file="builtin" proc="emission"', own)
        folder.write("project.xml", text)


@pytest.fixture(scope="module")
def graded(
    tmp_path_factory: pytest.TempPathFactory,
) -> tuple[str, subprocess.CompletedProcess[str]]:
    """The page of a class of seven, and how the command ended."""
    root = tmp_path_factory.mktemp("class")
    project(root / "ana")
    for name, source in EVIL.items():
        project(root / name, source)
    project(root / "typo")
    file = root / "typo" / "project.xml"
    file.write_text(file.read_text().replace("<RAYS_PER_PIXEL", "<RAYS_PER_PIXL"))
    (root / "torn").mkdir()
    (root / "torn" / "project.xml").write_text("<project name='torn'><assets")
    # Compile the kernels first, so that a new cache costs no project its time.
    compiled = [*RUN, str(root / "raises" / "project.xml"), "-o", str(root.parent / "x.png")]
    subprocess.run(compiled, capture_output=True, timeout=300, check=False)
    page = root.parent / f"{root.name}.html"
    words = ["--batch", str(root), "--report", str(page), "--time-limit", "8"]
    done = subprocess.run(
        [*RUN, *words, "--memory-limit", "900", "--jobs", "2", "--quiet"],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    return page.read_text(), done


def test_each_has_its_status(graded: tuple[str, subprocess.CompletedProcess[str]]) -> None:
    page, done = graded
    assert done.returncode == 1
    assert "1 of 7 projects rendered" in page
    found = dict(
        re.findall(
            r'<a href="#p\d+">(\w+)/project\.xml</a></td><td><span class="\w+">(\w+)</span>', page
        )
    )
    assert found == {
        "ana": "rendered",
        "hangs": "stopped",
        "crashes": "stopped",
        "eats": "stopped",
        "raises": "wrong",
        "typo": "wrong",
        "torn": "wrong",
    }


@pytest.mark.parametrize(
    "name, why",
    [
        ("hangs", "it did not end within 8 s"),
        ("crashes", "it crashed (SIGSEGV)"),
        ("eats", "it took more than 900 MB of memory"),
        ("raises", "raised RuntimeError"),
        ("typo", "element <RAYS_PER_PIXL> of <pass> is unknown"),
    ],
)
def test_the_reason_is_said(
    graded: tuple[str, subprocess.CompletedProcess[str]], name: str, why: str
) -> None:
    """On stderr, with the project's path; the page has it, too."""
    page, done = graded
    lines = [line for line in done.stderr.splitlines() if f"/{name}/project.xml" in line]
    assert len(lines) == 1
    assert why in lines[0]
    section = page.split(f">{name}/project.xml</h2>")[1].split("<h2")[0]
    assert why.replace("<", "&lt;").replace(">", "&gt;") in section


def test_the_page_is_whole_and_harmless(
    graded: tuple[str, subprocess.CompletedProcess[str]],
) -> None:
    """A picture for the one that rendered, its passes, nothing of the projects as markup."""
    page, _ = graded
    assert page.count("<img ") == 1
    section = page.split(">ana/project.xml</h2>")[1].split("<h2")[0]
    assert "<td>trace</td><td>raytrace</td>" in section
    assert "<script" not in page
    assert re.findall(r"(?:src|href)=\"(?!data:|#)[^\"]*\"|https?://", page) == []


@pytest.mark.parametrize(
    "words, said",
    [
        (["--report", "x.json"], "name it with --report FILE.html"),
        (["--report", "x.html", "-o", "x.png"], "no PROJECT, -o or --targets with it"),
    ],
)
def test_wrong_use(tmp_path: Path, words: list[str], said: str) -> None:
    done = subprocess.run(
        [*RUN, "--batch", str(tmp_path), *words], capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert said in " ".join(done.stderr.replace("│", " ").split())


def test_an_interrupted_batch_ends_at_once(tmp_path: Path) -> None:
    """Ctrl-C kills what runs, and writes no page."""
    project(tmp_path / "class" / "hangs", EVIL["hangs"])
    page = tmp_path / "page.html"
    process = subprocess.Popen(
        [*RUN, "--batch", str(tmp_path / "class"), "--report", str(page), "--quiet"],
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=heed_interrupts,
    )
    time.sleep(4)
    begun = time.monotonic()
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=20)
    assert time.monotonic() - begun < 5
    assert process.returncode == 130
    assert "interrupted" in said
    assert "Traceback" not in said
    assert not page.exists()

"""Hot reload: what changes is taken in, what is wrong leaves the last good picture."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import nau_py
from nau_py.run.reload import HotReload
from nau_py.run.renderer import Renderer
from nau_py.run.used_files import used_files
from tests.conftest import PROJECTS, Folder, heed_interrupts

PROJECT = """\
<project name="Watched" width="16" height="16">
<assets>
<scenes><scene name="S"><file name="card.obj"/></scene></scenes>
<lights><light name="Sun"><DIRECTION x="0" y="0" z="-1"/></light></lights>
<cameras><camera name="C"><projection TYPE="PERSPECTIVE" FOV="60" NEAR="0.1" FAR="10"/>
<POSITION x="0" y="0" z="1"/></camera></cameras>
<materialLibs><materialLib filename="lib.mlib"/></materialLibs>
</assets>
<pipelines><pipeline name="P">
<pass name="trace" class="raytrace"><camera name="C"/><scenes><scene name="S"/></scenes>
<lights><light name="Sun"/></lights><renderTarget name="rt" fromLibrary="L"/>
<rtEntryPoint><rayGen file="builtin" proc="pinhole"/></rtEntryPoint>
<rtDefaultMaterial><rayType name="R">
<rtProgram type="CLOSEST_HIT" file="mine.py" proc="shade"/></rayType></rtDefaultMaterial></pass>
<pass name="show" class="quad"><material name="show" fromLibrary="L"/></pass>
</pipeline></pipelines>
</project>
"""
LIBRARY = """\
<materialLib name="L">
<renderTargets><renderTarget name="rt"><SIZE width="16" height="16"/>
<colors><color name="c" internalFormat="RGBA32F"/></colors></renderTarget></renderTargets>
<shaders><shader name="show" vs="a.vert" ps="a.frag"/></shaders>
<materials><material name="show"><shader name="show">
<values><valueof uniform="image" type="TEXTURE_BINDING" context="CURRENT" component="UNIT" id="0"/>
</values></shader><textures><texture name="c" UNIT="0"/></textures></material></materials>
</materialLib>
"""
VERTEX = """\
#version 330
in vec4 position;
void main() { gl_Position = position; }
"""
FRAGMENT = """\
#version 330
uniform sampler2D image;
out vec4 colour;
void main() { colour = texelFetch(image, ivec2(gl_FragCoord.xy), 0) * vec4(1.0, 1.0, 1.0, 1.0); }
"""
SHADE = "import numpy as np\n\ndef shade(hits):\n    return hits.texture(0)[:, :3] * 1.0\n"


@pytest.fixture
def watched(folder: Folder) -> Folder:
    """A card that fills the picture, its texture shown through a program of each kind."""
    for name, text in (
        ("project.xml", PROJECT), ("lib.mlib", LIBRARY), ("a.vert", VERTEX), ("a.frag", FRAGMENT),
        ("mine.py", SHADE),
    ):  # fmt: skip
        folder.write(name, text)
    folder.obj("card", [("Card", [(-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0)])])
    folder.mtl("card", {"Card": {"map_Kd": "card.png"}})
    texture(folder, 200)
    return folder


def texture(folder: Folder, grey: int) -> None:
    folder.image("card.png", np.full((4, 4, 3), grey, np.uint8))


def shown(frame: nau_py.Frame) -> list[int]:
    """The colour in the middle of the picture."""
    return [int(v) for v in frame.image[8, 8, :3]]


def change(folder: Folder, name: str, old: str, new: str) -> None:
    file = folder.path / name
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new))


def after(watch: HotReload) -> list[int]:
    changed = watch.watch.take_changes()
    assert changed
    return shown(watch.render(changed))


@pytest.fixture
def watch(watched: Folder) -> HotReload:
    made = HotReload(watched.path / "project.xml", nau_py.load, Renderer)
    assert shown(made.start()) == [200, 200, 200]
    assert made.watch.take_changes() == {}
    return made


def test_a_shader(watched: Folder, watch: HotReload) -> None:
    """It alone is exchanged: the renderer stays. A second change counts as well."""
    before = watch.renderer
    change(watched, "a.frag", "vec4(1.0, 1.0", "vec4(0.5, 1.0")
    assert after(watch) == [100, 200, 200]
    change(watched, "a.frag", "vec4(0.5, 1.0", "vec4(0.0, 1.0")
    assert after(watch) == [0, 200, 200]
    assert watch.renderer is before


def test_a_ray_program_of_the_same_size(watched: Folder, watch: HotReload) -> None:
    """Twice in one second and of one size: no bytecode of the version before, and none is left."""
    before = watch.renderer
    change(watched, "mine.py", "1.0", "0.5")
    assert after(watch) == [100, 100, 100]
    change(watched, "mine.py", "0.5", "0.0")
    assert after(watch) == [0, 0, 0]
    assert watch.renderer is before
    assert not (watched.path / "__pycache__").exists()


@pytest.mark.parametrize(
    "alter, expected",
    [
        (lambda f: texture(f, 60), [60, 60, 60]),
        (lambda f: f.mtl("card", {"Card": {"Kd": "1 1 1"}}), [255, 255, 255]),
        (
            lambda f: f.obj("card", [("Card", [(8, 8, 0), (9, 8, 0), (9, 9, 0), (8, 9, 0)])]),
            [0, 0, 0],
        ),
        (lambda f: change(f, "lib.mlib", "RGBA32F", "RG32F"), [200, 200, 0]),
        (lambda f: change(f, "project.xml", 'x="0" y="0" z="1"', 'x="9" y="0" z="1"'), [0, 0, 0]),
    ],
    ids=["texture", "material file", "model", "library", "project"],
)
def test_any_other_file(
    watched: Folder, watch: HotReload, alter: Callable[[Folder], None], expected: list[int]
) -> None:
    alter(watched)
    assert after(watch) == expected


@pytest.mark.parametrize(
    "name, old, new, words",
    [
        ("a.frag", "void main", "void mian(", "a.frag:4"),
        ("a.vert", "in vec4", "on vec4", "a.vert:2"),
        ("mine.py", "return", "retrun", "mine.py:4"),
        ("mine.py", "1.0", "1.0 / 'x'", "TypeError"),
        ("project.xml", '<pass name="show"', '<pass nmae="show"', "project.xml:15"),
        ("lib.mlib", "RGBA32F", "RGBA33F", "RGBA33F"),
        ("project.xml", "</project>", "", "project.xml"),
    ],
)
def test_what_is_wrong_is_said_and_mended(
    watched: Folder, watch: HotReload, name: str, old: str, new: str, words: str
) -> None:
    """The renderer of the last good picture stays; after mending the picture is right again."""
    good = watch.renderer
    text = (watched.path / name).read_text()
    change(watched, name, old, new)
    with pytest.raises(nau_py.NauError) as caught:
        watch.render(watch.watch.take_changes())
    assert words in str(caught.value)
    assert watch.renderer is good
    (watched.path / name).write_text(text)
    assert after(watch) == [200, 200, 200]


def test_a_project_that_is_gone_and_comes_back(watched: Folder, watch: HotReload) -> None:
    file = watched.path / "project.xml"
    text = file.read_text()
    file.unlink()
    with pytest.raises(nau_py.NauError, match=r"project\.xml"):
        watch.render(watch.watch.take_changes())
    file.write_text(text)
    assert after(watch) == [200, 200, 200]


def test_a_project_that_is_wrong_from_the_start(watched: Folder) -> None:
    """Its libraries' and its own files are followed all the same."""
    change(watched, "lib.mlib", 'name="show" vs', 'name="shown" vs')
    made = HotReload(watched.path / "project.xml", nau_py.load, Renderer)
    with pytest.raises(nau_py.ProjectError):
        made.start()
    change(watched, "lib.mlib", 'name="shown" vs', 'name="show" vs')
    assert after(made) == [200, 200, 200]


def test_files_that_a_change_brings_are_followed(watched: Folder, watch: HotReload) -> None:
    watched.write("b.frag", FRAGMENT.replace("vec4(1.0,", "vec4(0.5,"))
    change(watched, "lib.mlib", 'ps="a.frag"', 'ps="b.frag"')
    assert after(watch) == [100, 200, 200]
    change(watched, "b.frag", "vec4(0.5,", "vec4(0.0,")
    assert after(watch) == [0, 200, 200]


def test_the_files_of_the_demo() -> None:
    """Project, library, shaders, programs, model with its textures; each with its kind."""
    project = nau_py.load(PROJECTS / "selective" / "project.xml")
    found = {p.name: kind for p, kind in used_files(project).items()}
    assert found["project.xml"] == found["hybrid.mlib"] == "project"
    assert found["gbuffer.frag"] == found["sun.frag"] == found["lit.vert"] == "shader"
    assert found["hybrid.py"] == "program"
    assert found["plaza.obj"] == found["plaza.mtl"] == found["grade_varanda.png"] == "model"


def test_the_command(watched: Folder) -> None:
    """It writes the first picture, follows a change, says an error, and ends by Ctrl-C."""
    output, log = watched.path / "out.png", watched.path / "log.txt"

    def wait(condition: Callable[[], bool]) -> None:
        for _ in range(600):
            if condition():
                return
            time.sleep(0.05)
        pytest.fail(f"nothing happened: {log.read_text()}")

    def pixel() -> int:
        return int(np.asarray(Image.open(output))[8, 8, 0]) if output.exists() else -1

    with log.open("w") as stream:
        process = subprocess.Popen(
            [Path(sys.executable).parent / "nau-run", watched.path / "project.xml", "--watch",
             "-o", output, "--quiet"],
            stderr=stream,
            preexec_fn=heed_interrupts,
        )  # fmt: skip
    try:
        wait(lambda: "first picture: " in log.read_text())
        assert pixel() == 200
        change(watched, "a.frag", "vec4(1.0, 1.0", "vec4(0.5, 1.0")
        wait(lambda: "a.frag: " in log.read_text())
        assert pixel() == 100
        change(watched, "a.frag", "void main", "void mian(")
        wait(lambda: "a.frag: wrong; the last picture stays" in log.read_text())
        assert "error[G001]" in log.read_text()
        assert pixel() == 100
    finally:
        process.send_signal(signal.SIGINT)
        assert process.wait(20) == 0
    assert "Traceback" not in log.read_text()

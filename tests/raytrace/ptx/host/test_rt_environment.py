"""Class ``rt`` with compiled programs, from project file to picture."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import nau_py
from tests.conftest import Folder, pixel_rays

DATA = Path(__file__).parent.parent / "data" / "room.ptx"
PROJECT = """\
<project name="Rooms" width="64" height="48">
  <assets>
    <scenes><scene name="S"><file name="scene.obj" /></scene></scenes>
    <cameras>
      <camera name="C">
        <projection TYPE="PERSPECTIVE" FOV="60" NEAR="0.1" FAR="100" />
        <POSITION x="0" y="0" z="3" />
      </camera>
    </cameras>
    <materialLibs><materialLib filename="lib.mlib" /></materialLibs>
  </assets>
  <pipelines>
    <pipeline name="P">
      <pass name="trace" class="rt">
        <camera name="C" />
        <scenes><scene name="S" /></scenes>
        <renderTarget name="rt" fromLibrary="L" />
        <rtRayTypes><rayType name="Radiance" /></rtRayTypes>
        <rtVertexAttributes><attribute name="position" /></rtVertexAttributes>
        <rtEntryPoint><rayGen file="room.ptx" proc="__raygen__camera" /></rtEntryPoint>
        <rtDefaultMaterial>
          <rayType name="Radiance">
            <rtProgram type="CLOSEST_HIT" file="room.ptx" proc="__closesthit__diffuse" />
            <rtProgram type="MISS" file="room.ptx" proc="__miss__blue" />
          </rayType>
        </rtDefaultMaterial>
        <rtMaterialMap>
          <rtMap to="Holed*">
            <rayType name="Radiance">
              <rtProgram type="CLOSEST_HIT" file="room.ptx" proc="__closesthit__diffuse" />
              <rtProgram type="ANY_HIT" file="room.ptx" proc="__anyhit__first_only" />
              <rtProgram type="MISS" file="room.ptx" proc="__miss__blue" />
            </rayType>
          </rtMap>
        </rtMaterialMap>
      </pass>
    </pipeline>
  </pipelines>
</project>
"""
LIBRARY = """\
<materialLib name="L"><renderTargets><renderTarget name="rt"><SIZE width="64" height="48" />
<colors><color name="out" internalFormat="RGBA" /></colors></renderTarget></renderTargets>
</materialLib>
"""
SQUARE = [(-1.0, -1.0, 0.0), (1.0, -1.0, 0.0), (1.0, 1.0, 0.0), (-1.0, 1.0, 0.0)]


@pytest.fixture
def room(folder: Folder) -> Folder:
    folder.write("room.ptx", DATA.read_text())
    folder.write("lib.mlib", LIBRARY)
    folder.write("project.xml", PROJECT)
    folder.mtl("scene", {"Red": {"Kd": "0.8 0.4 0.2"}, "Holed": {"Kd": "0.2 0.6 0.4"}})
    folder.obj("scene", [("Red", SQUARE)])
    return folder


def seen() -> tuple[np.ndarray, np.ndarray]:
    """Return the points where the pixels' rays meet the plane z = 0."""
    origin, direction = pixel_rays((64, 48), (0, 0, 3))
    points = origin + 3 * direction
    return points[:, :, 0], points[:, :, 1]


def test_rays_meet_the_room(room: Folder) -> None:
    frame = nau_py.Renderer(room.load()).render()
    image = frame.targets["L::out"]
    x, y = seen()
    inside = (np.abs(x) < 0.999) & (np.abs(y) < 0.999)
    outside = (np.abs(x) > 1.001) | (np.abs(y) > 1.001)
    assert (image[inside][:, :3] == [204, 102, 51]).all()
    assert (image[outside][:, :3] == [0, 0, 255]).all()
    assert (image[:, :, 3] == 255).all()
    (trace,) = frame.report["frames"][0]["passes"]
    assert trace["rays"] == {"Radiance": 64 * 48}
    assert trace["pixels"] == 64 * 48


def test_any_hit_lets_through(room: Folder) -> None:
    """The any-hit program ignores the quad's second triangle, so the geometry behind is visible."""
    far = [(3 * x, 3 * y, -1.0) for x, y, _ in SQUARE]
    room.obj("scene", [("Holed", SQUARE), ("Red", far)])
    image = nau_py.Renderer(room.load()).render().targets["L::out"]
    x, y = seen()
    inside = (np.abs(x) < 0.98) & (np.abs(y) < 0.98)
    lower, upper = inside & (x - y > 0.02), inside & (y - x > 0.02)
    assert (image[lower][:, :3] == [51, 153, 102]).all()
    assert (image[upper][:, :3] == [204, 102, 51]).all()


def test_threads_change_nothing(room: Folder) -> None:
    pictures = [
        nau_py.Renderer(room.load(), options=nau_py.RunOptions(threads=n)).render().image
        for n in (1, 2, 5)
    ]
    assert all((p == pictures[0]).all() for p in pictures)


def test_lint_names_instruction_line_and_procedure(room: Folder) -> None:
    assert nau_py.lint(room.load()) == []
    text = DATA.read_text().replace("mad.wide.u32 	%rd6", "wmma.mma 	%rd6")
    room.write("room.ptx", text)
    (fault,) = nau_py.lint(room.load())
    line = text[: text.index("wmma")].count("\n") + 1
    assert (fault.rule, fault.location.line) == ("T015", 20)
    assert fault.message == (
        f"pass 'trace': room.ptx:{line}: procedure '__raygen__camera': instruction 'wmma.mma' is "
        "not supported"
    )
    room.write("room.ptx", DATA.read_text())
    room.write("project.xml", PROJECT.replace("__miss__blue", "__miss__blu"))
    faults = nau_py.lint(room.load())
    assert {f.rule for f in faults} == {"T004"}
    assert "'room.ptx' exports no '__miss__blu'" in faults[0].message
    assert "did you mean '__miss__blue'" in faults[0].message


def test_programs_are_trusted_as_python_ones_are(room: Folder) -> None:
    options = nau_py.RunOptions(no_programs=True)
    with pytest.raises(nau_py.ProgramError, match="because --no-programs was given"):
        nau_py.Renderer(room.load(), options=options).render()


def test_python_programs_run_on_request(room: Folder) -> None:
    """A Python file of the same name runs instead, with the option ``--programs py``."""
    room.write(
        "room.py",
        "import numpy as np\n\n"
        "def camera(launch):\n    origin, direction = launch.camera_rays(launch.x + 0.5, launch.y + 0.5)\n"
        '    return launch.trace("Radiance", origin, direction)\n\n'
        'def diffuse(hits):\n    return hits.color("DIFFUSE")[:3] * 0.5\n\n'
        "def first_only(hits):\n    return np.ones(len(hits), bool)\n\n"
        "def blue(rays):\n    return np.array([0.0, 0.0, 0.5])\n",
    )
    options = nau_py.RunOptions(programs="py")
    python = nau_py.Renderer(room.load(), options=options).render().targets["L::out"]
    compiled = nau_py.Renderer(room.load()).render()
    assert python[24, 32].tolist()[:3] == [102, 51, 26]
    assert compiled.targets["L::out"][24, 32].tolist()[:3] == [204, 102, 51]


FAULTS = {
    "__closesthit__bad": "\tmov.u64 %rd1, 16;\n\tmov.u32 %r1, 7;\n",
    "__closesthit__loop": "AGAIN:\n\tld.volatile.const.u32 %r1, [optixLaunchParams];\n\tbra AGAIN;\n",
}


@pytest.mark.parametrize(
    "proc, words",
    [
        ("__closesthit__bad", "ended the process by signal SIGSEGV at launch index ("),
        ("__closesthit__loop", "did not end within 1.5 s at launch index ("),
    ],
)
def test_a_program_that_crashes_or_hangs_ends_its_worker_only(
    room: Folder, proc: str, words: str
) -> None:
    text = DATA.read_text()
    for name, body in FAULTS.items():
        text += (
            f".visible .entry {name}()\n{{\n\t.reg .b32 %r<4>;\n\t.reg .b64 %rd<4>;\n{body}"
            "\tst.u32 [%rd1], %r1;\n\tret;\n}\n"
        )
    room.write("room.ptx", text)
    room.write("project.xml", PROJECT.replace("__closesthit__diffuse", proc))
    command = str(Path(sys.executable).parent / "nau-run")
    arguments = ["project.xml", "-o", "x.png", "--program-limit", "1.5", "--threads", "1"]
    done = subprocess.run(
        [command, *arguments], cwd=room.path, capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 1
    assert (
        f"error[T016]: project 'Rooms', pass 'trace', program '__raygen__camera' {words}"
        in done.stderr
    )
    assert "Traceback" not in done.stderr
    x, y = map(int, re.findall(r"\((\d+), (\d+)\)", done.stderr)[0])
    assert abs(x - 32) < 20  # the first pixel, from below, whose ray meets the square
    assert 0 < y < 24
    assert not (room.path / "x.png").exists()


def test_a_supervised_run_gives_the_same_picture(room: Folder) -> None:
    command = str(Path(sys.executable).parent / "nau-run")
    done = subprocess.run(
        [command, "project.xml", "-o", "x.png", "--quiet"],
        cwd=room.path, capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    image = np.asarray(Image.open(room.path / "x.png"))
    assert image[24, 32].tolist() == [204, 102, 51]


def added(proc: str, body: str) -> str:
    """Return the room's module with one more program."""
    head = f".visible .entry {proc}()\n{{\n\t.reg .b32 %r<9>;\n\t.reg .b64 %rd<9>;\n"
    return DATA.read_text() + head + "\t.reg .f32 %f<9>;\n" + body + "\tret;\n}\n"


def only(room: Folder, rule: str) -> list[str]:
    """Return the messages of all findings, which must be of one rule."""
    found = nau_py.lint(room.load())
    assert {d.rule for d in found} == {rule}, found
    assert all(d.severity == "warning" for d in found)
    return [d.message for d in found]


def test_reads_past_a_record_are_reported(room: Folder) -> None:
    """Byte 112 is past the end; offsets from a record's address are followed through moves and sums."""
    body = (
        "\tcall (%rd1), _optix_get_sbt_data_ptr_64, ();\n\tcvta.to.global.u64 %rd2, %rd1;\n"
        "\tadd.s64 %rd3, %rd2, 96;\n\tld.global.v2.u32 {%r1, %r2}, [%rd3+12];\n"
    )
    room.write("room.ptx", added("__closesthit__far", body))
    room.write("project.xml", PROJECT.replace("__closesthit__diffuse", "__closesthit__far"))
    assert only(room, "T020") == [
        "pass 'trace': program '__closesthit__far' of 'room.ptx' reads up to byte 116 of its record, "
        "which has 112"
    ]
    room.write("room.ptx", added("__closesthit__far", body.replace("+12", "+8")))
    assert nau_py.lint(room.load()) == []


def test_payloads_longer_than_sent_are_reported(room: Folder) -> None:
    body = "\tmov.u32 %r1, 5;\n\tcall _optix_set_payload_5, (%r1);\n"
    room.write("room.ptx", added("__closesthit__wide", body))
    room.write("project.xml", PROJECT.replace("__closesthit__diffuse", "__closesthit__wide"))
    (said,) = only(room, "T021")
    assert said == (
        "pass 'trace': program '__closesthit__wide' of 'room.ptx' uses word 5 of the payload, but "
        "rays carry 2 words"
    )


def test_incomplete_entries_are_reported(room: Folder) -> None:
    """Entries that would shift Nau's records are reported."""
    miss = '<rtProgram type="MISS" file="room.ptx" proc="__miss__blue" />\n            </rayType>\n'
    end = "          </rtMap>"
    assert f"{miss}{end}" in PROJECT
    room.write("project.xml", PROJECT.replace(f"{miss}{end}", f"</rayType>\n{end}"))
    (said,) = only(room, "T022")
    assert said.startswith(
        "pass 'trace': material 'Holed*' has no miss program of ray type 'Radiance': if its"
    )
    two = '<rayType name="Radiance" /><rayType name="Shadow" /></rtRayTypes>'
    room.write("project.xml", PROJECT.replace('<rayType name="Radiance" /></rtRayTypes>', two))
    assert only(room, "T022")[0].startswith(
        "pass 'trace': material 'Holed*' has no entry for ray type 'Shadow': such rays run no"
    )
    image = nau_py.Renderer(room.load()).render().targets["L::out"]
    assert image[24, 32].tolist()[:3] == [204, 102, 51]


def test_unaligned_parameters_are_reported(room: Folder) -> None:
    block = (
        '<rtGlobalParams><param name="a" type="RENDERER" context="CURRENT" component="TIMER" />'
        '<param name="b" type="TEXTURE" context="L::out" component="ID" /></rtGlobalParams>'
    )
    room.write("project.xml", PROJECT.replace("<rtEntryPoint>", f"{block}<rtEntryPoint>"))
    (said,) = [d.message for d in nau_py.lint(room.load()) if d.rule == "T023"]
    assert "parameter 'b' has 8 bytes and is at byte 4 of the block" in said

"""Class ``optix``: programs of OptiX 3 to 6 (``data/old.cu``), from project file to picture."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import nau_py
from tests.conftest import PROJECTS, Folder, pixel_rays

DATA = Path(__file__).parent.parent / "data" / "old.ptx"
SIZE = (32, 24)
PROJECT = """\
<project name="Old" width="32" height="24">
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
    <pipeline name="P" defaultCamera="C">
      <pass name="draw" class="default">
        <camera name="C" />
        <scenes><scene name="S" /></scenes>
        <renderTarget name="drawn" fromLibrary="L" />
        <materialMaps>
          <map fromMaterial="*" toLibrary="L" toMaterial="flat" />
        </materialMaps>
      </pass>
      <pass name="trace" class="optix">
        <camera name="C" />
        <scenes><scene name="S" /></scenes>
        <renderTarget name="rt" fromLibrary="L" />
        <optixEntryPoint>
          <optixProgram type="RayGen" file="old.ptx" proc="camera" />
          <optixProgram type="Exception" file="old.ptx" proc="exception" />
        </optixEntryPoint>
        <optixDefaultMaterial>
          <optixProgram type="Closest_Hit" ray="First" file="old.ptx" proc="distance" />
          <optixProgram type="Miss" ray="First" file="old.ptx" proc="nothing" />
          <optixProgram type="Any_Hit" ray="Second" file="old.ptx" proc="count" />
        </optixDefaultMaterial>
        <optixMaterialMap>
          <optixMap to="nau_material_lib:Green">
            <optixProgram type="Closest_Hit" ray="First" file="old.ptx" proc="colour" />
          </optixMap>
        </optixMaterialMap>
        <optixGeometryProgram>
          <optixProgram type="Geometry_Intersection" file="old.ptx" proc="sphere" />
          <optixProgram type="Bounding_Box" file="old.ptx" proc="box" />
        </optixGeometryProgram>
        <optixVertexAttributes><attribute name="position" /></optixVertexAttributes>
        <optixMaterialAttributes>
          <valueof optixVar="diffuse" type="COLOR" context="CURRENT" component="DIFFUSE" />
        </optixMaterialAttributes>
        <optixInput>
          <buffer var="pixels" texture="L::seen" />
          <buffer var="numbers" texture="L::seen" />
        </optixInput>
        <optixOutput><buffer var="extra" texture="L::more" /></optixOutput>
      </pass>
    </pipeline>
  </pipelines>
</project>
"""
LIBRARY = """\
<materialLib name="L">
  <renderTargets>
    <renderTarget name="rt"><SIZE width="32" height="24" />
      <colors><color name="out" internalFormat="RGBA32F" /></colors></renderTarget>
    <renderTarget name="side"><SIZE width="32" height="24" />
      <colors><color name="more" internalFormat="RGBA32F" /></colors></renderTarget>
    <renderTarget name="drawn"><SIZE width="32" height="24" />
      <CLEAR_VALUES r="0.5" g="0.125" b="0" a="0" />
      <colors><color name="seen" internalFormat="RGBA32F" /></colors></renderTarget>
  </renderTargets>
  <shaders><shader name="flat" vs="flat.vert" ps="flat.frag" /></shaders>
  <materials><material name="flat"><shader name="flat"><values>
    <valueof uniform="PVM" type="RENDERER" context="CURRENT" component="PROJECTION_VIEW_MODEL" />
  </values></shader></material></materials>
</materialLib>
"""
TRIANGLES = [
    ("Red", [(-1.0, 0.0, 0.0), (-0.9, 0.0, 0.0), (-0.9, 0.1, 0.0), (-1.0, 0.1, 0.0)]),
    ("Green", [(0.8, 0.3, -1.0), (0.9, 0.3, -1.0), (0.9, 0.4, -1.0), (0.8, 0.4, -1.0)]),
]
"""Quads: both triangles begin at the same corner, so each sphere exists twice."""
Picture = np.ndarray[Any, Any]


@pytest.fixture
def old(folder: Folder) -> Folder:
    folder.write("old.ptx", DATA.read_text())
    folder.write("lib.mlib", LIBRARY)
    folder.write("project.xml", PROJECT)
    vertex = "in vec4 position; uniform mat4 PVM; void main() { gl_Position = PVM * position; }"
    folder.write("flat.vert", f"#version 330\n{vertex}\n")
    folder.write(
        "flat.frag", "#version 330\nout vec4 o; void main() { o = vec4(1, 0.25, 0, 1); }\n"
    )
    folder.mtl("scene", {"Red": {"Kd": "0.8 0.4 0.2"}, "Green": {"Kd": "0.2 0.6 0.4"}})
    folder.obj("scene", TRIANGLES)
    return folder


def render(old: Folder, generate: str = "camera", **options: Any) -> nau_py.Frame:
    old.write("project.xml", PROJECT.replace('proc="camera"', f'proc="{generate}"'))
    renderer = nau_py.Renderer(old.load(), options=nau_py.RunOptions(**options))
    frame = renderer.render()
    renderer.close()
    return frame


def spheres(centre: tuple[float, ...], radius: float = 0.5) -> tuple[Picture, Picture]:
    """Return near and far distances of the pixels' rays in lengths of W, float64; NaN for none."""
    origin, direction = pixel_rays(SIZE, (0, 0, 3))
    direction = direction / -direction[:, :, 2:]  # programs leave it as long as W is deep
    o = origin - np.array(centre)
    a, b = (direction**2).sum(axis=2), (o * direction).sum(axis=2)
    rest = b * b - a * ((o**2).sum(axis=-1) - radius**2)
    root = np.sqrt(np.where(rest > 0, rest, np.nan))
    return (-b - root) / a, (-b + root) / a


def test_user_geometry_of_programs(old: Folder) -> None:
    """Spheres as user geometry: distances, attributes, materials and misses match analytic ones."""
    frame = render(old)
    out = frame.targets["L::out"]
    (note,) = frame.report["frames"][0]["passes"][1]["notes"]
    assert note.startswith("2 of 2 geometries are user geometry of their programs")
    red, _ = spheres((-1.0, 0.0, 0.0))
    green, _ = spheres((0.8, 0.3, -1.0))
    of_red = red < np.where(np.isnan(green), np.inf, green)
    of_green = ~of_red & ~np.isnan(green)
    none = np.isnan(red) & np.isnan(green)
    assert min(of_red.sum(), of_green.sum(), none.sum()) > 20
    np.testing.assert_allclose(out[of_red][:, 0], red[of_red], rtol=2e-5)
    assert (out[of_red][:, 2] == -1).all()  # the near side: what it told of the far one is gone
    assert (out[of_red][:, 3] == 0).all()  # the ray ends at the hit
    np.testing.assert_allclose(out[of_green], np.tile([0.2, 0.6, 0.4, 1], (of_green.sum(), 1)))
    assert (out[none] == [0, 0, 0, -1]).all()


def test_any_hit_programs_see_every_candidate(old: Folder) -> None:
    """Both sides of both spheres of a quad are candidates, and none is accepted. A miss without a
    program keeps the payload."""
    out = render(old, "counter").targets["L::out"]
    near, far = spheres((-1.0, 0.0, 0.0))
    hit = ~np.isnan(near)
    np.testing.assert_array_equal(out[:, :, 0][hit], 4)
    np.testing.assert_allclose(out[:, :, 1][hit], 2 * (near + far)[hit], rtol=1e-4)
    assert (out[12, 16] == 0).all()


def test_threads_change_nothing(old: Folder) -> None:
    pictures = [render(old, threads=n).targets["L::out"] for n in (1, 3)]
    np.testing.assert_array_equal(*pictures)


def test_exceptions_run_their_program_and_are_reported(old: Folder) -> None:
    frame = render(old, "throws")
    out = frame.targets["L::out"]
    x, y = np.meshgrid(np.arange(32), np.arange(24)[::-1])  # programs count rows from below
    odd = x % 2 == 1
    np.testing.assert_array_equal(out[~odd][:, :2], np.stack([x, y], -1)[~odd])
    np.testing.assert_array_equal(out[~odd][:, 2:], np.tile([32, 24], ((~odd).sum(), 1)))
    np.testing.assert_array_equal(out[odd][:, 0], -1)
    np.testing.assert_array_equal(out[odd][:, 1], 1024 + y[odd])
    (said,) = [w for w in frame.report["warnings"] if "T019" in w]
    assert "program 'throws' threw at 384 launch indices, first at (1, 0): code 1024" in said
    assert "'exception' took over" in said


def test_rays_without_end_end_at_the_greatest_depth(old: Folder) -> None:
    old.write("old.ptx", DATA.read_text())
    text = PROJECT.replace('proc="distance"', 'proc="again"')
    old.write("project.xml", text)
    frame = nau_py.Renderer(old.load()).render()
    out = frame.targets["L::out"]
    near, _ = spheres((-1.0, 0.0, 0.0))
    hit = ~np.isnan(near)
    np.testing.assert_array_equal(out[hit][:, :2], np.tile([-1, 0x3FC], (hit.sum(), 1)))
    rays = frame.report["frames"][0]["passes"][1]["rays"]["First"]
    assert rays == 20 * hit.sum() + (~hit).sum()
    assert any("trace depth exceeded" in w for w in frame.report["warnings"])


@pytest.mark.parametrize(
    "body, words",
    [
        (
            "AGAIN:\n\tld.volatile.global.u32 %r1, [index_buffer];\n\tbra AGAIN;\n",
            "did not end within",
        ),
        ("\tmov.u64 %rd1, 16;\n\tst.global.u32 [%rd1], %r1;\n", "ended the process by signal SIG"),
    ],
)
def test_geometry_programs_that_crash_end_their_worker_only(
    old: Folder, body: str, words: str
) -> None:
    head = ".visible .entry bad(.param .u32 p, .param .u64 q)\n{\n\t.reg .b32 %r<3>;\n\t.reg .b64 %rd<3>;\n"
    old.write("old.ptx", DATA.read_text() + head + body + "\tret;\n}\n")
    old.write("project.xml", PROJECT.replace('proc="box"', 'proc="bad"'))
    command = str(Path(sys.executable).parent / "nau-run")
    done = subprocess.run(
        [command, "project.xml", "-o", "x.png", "--program-limit", "1.5"],
        cwd=old.path, capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert done.returncode == 1
    assert f"error[T016]: project 'Old', pass 'trace', its geometry programs {words}" in done.stderr
    assert "launch index" not in done.stderr
    assert "Traceback" not in done.stderr


def test_access_beyond_a_buffer_is_an_exception(old: Folder) -> None:
    out = render(old, "beyond").targets["L::out"]
    assert (out[:, :-1] > 0).all()
    np.testing.assert_array_equal(out[:, -1, :2], np.tile([-1, 0x3FD], (24, 1)))


def test_inputs_and_outputs(old: Folder) -> None:
    """A texture read by texels, the same texture as a buffer, sizes, and a second output."""
    frame = render(old, "copies")
    drawn, out, more = (frame.targets[f"L::{n}"] for n in ("seen", "out", "more"))
    assert {0.5, 1.0} == set(np.unique(drawn[:, :, 0]))
    np.testing.assert_array_equal(out[:, :, 0], drawn[:, :, 0])
    np.testing.assert_array_equal(out[:, :, 1], drawn[:, :, 0])
    np.testing.assert_array_equal(out[:, :, 2:], np.tile([32.0, 24.0], (24, 32, 1)))
    np.testing.assert_array_equal(more[:, :, 0], drawn[:, :, 1])
    np.testing.assert_array_equal(more[:, :, 1:], np.tile([0.25, 0.5, 1], (24, 32, 1)))


def test_printed_texts_are_in_the_report(old: Folder) -> None:
    notes = render(old, "prints").report["frames"][0]["passes"][1]["notes"]
    assert notes[1:] == [
        f"printed at (3, {y}): at 3 {y}:  1.50 text 100% -1099511627776" for y in (0, 1)
    ]


def test_printed_texts_of_optix_6(old: Folder) -> None:
    """``rtPrintf``: a format, then words with their types: an integer, a float, a double."""
    text = "i %d f %.2f d %g"
    codes = ", ".join(str(byte) for byte in [*text.encode(), 0])
    writes = [0, 7, 2, 0x3FC00000, 3, 0, 0xC0040000]  # 7, 1.5, -2.5
    body = "\t.reg .b32 %r<9>;\n\t.reg .b64 %rd<9>;\n\t.reg .pred %p<2>;\n"
    body += "\tld.global.v2.u32 {%r1, %r2}, [launch_index];\n\tor.b32 %r3, %r1, %r2;\n"
    body += "\tsetp.ne.u32 %p1, %r3, 0;\n\t@%p1 bra END;\n\tmov.u64 %rd1, form;\n"
    body += "\tcall (%r4), _rt_print_active, ();\n"
    body += "\tcall (%r5), _rt_print_start_64, (%rd1, 32);\n"
    for place, word in enumerate(writes):
        body += f"\tadd.u32 %r6, %r5, {4 * place};\n\tmov.u32 %r7, {word};\n"
        body += "\tcall (), _rt_print_write32, (%r7, %r6);\n"
    module = f".global .align 1 .b8 form[{len(text) + 1}] = {{{codes}}};\n"
    module += f".visible .entry old_prints()\n{{\n{body}END:\n\tret;\n}}\n"
    old.write("old.ptx", DATA.read_text() + module)
    notes = render(old, "old_prints").report["frames"][0]["passes"][1]["notes"]
    assert notes[1:] == ["printed at (0, 0): i 7 f 1.50 d -2.5"]


def test_payloads_longer_than_sent_are_reported(old: Folder) -> None:
    name = "_ZN21rti_internal_typeinfo7payloadE[8] = {82, 97, 121, 0, "
    old.write("other.ptx", DATA.read_text().replace(f"{name}16", f"{name}32"))
    text = PROJECT.replace('file="old.ptx" proc="distance"', 'file="other.ptx" proc="distance"')
    old.write("project.xml", text)
    (found,) = nau_py.lint(old.load())
    assert (found.rule, found.severity) == ("T021", "warning")
    assert found.message == (
        "pass 'trace': program 'distance' of 'other.ptx' has a payload 'payload' of 32 bytes, but "
        "rays carry 16"
    )


def test_lint_knows_the_variables(old: Folder) -> None:
    assert nau_py.lint(old.load()) == []
    old.write("project.xml", PROJECT.replace('optixVar="diffuse"', 'optixVar="difuse"'))
    (found,) = nau_py.lint(old.load())
    assert found.rule == "T017"
    assert found.message.startswith(
        "pass 'trace': program 'colour' of 'old.ptx' reads the variable 'diffuse', which "
        "nothing sets; there is "
    )
    assert found.message.endswith("(did you mean 'difuse'?)")
    with pytest.raises(nau_py.NauError, match="T017"):
        nau_py.Renderer(old.load())
    old.write("project.xml", PROJECT.replace('component="DIFFUSE"', 'component="SHININESS"'))
    (found,) = nau_py.lint(old.load())
    assert found.rule == "T018"
    assert (
        "its variable 'diffuse' has 16 bytes, the value of the pass has 4; the rest is 0"
        in found.message
    )
    old.write("project.xml", PROJECT.replace('proc="box"', 'proc="boxes"'))
    (found,) = nau_py.lint(old.load())
    assert found.rule == "T004"
    assert "'old.ptx' exports no 'boxes'" in found.message


def test_python_programs_cannot_be_launched_by_compiled_ones(old: Folder) -> None:
    old.write("other.py", "def shade(hits): ...\n")
    text = PROJECT.replace('file="old.ptx" proc="distance"', 'file="other.py" proc="shade"')
    old.write("project.xml", text)
    (found,) = nau_py.lint(old.load())
    assert found.rule == "T015"
    assert found.message == "pass 'trace': 'other.py' is no compiled program, as its others are"


def test_a_missing_geometry_program_is_reported(old: Folder) -> None:
    line = '          <optixProgram type="Bounding_Box" file="old.ptx" proc="box" />\n'
    assert line in PROJECT
    old.write("project.xml", PROJECT.replace(line, ""))
    (found,) = nau_py.lint(old.load())
    assert (found.rule, found.severity) == ("T008", "error")
    assert "pass 'trace' has no Bounding_Box program" in found.message


def test_files_of_a_pass_fit_together(old: Folder) -> None:
    """One interface, and one size for a variable of one name."""
    room = (DATA.parent / "room.ptx").read_text()
    old.write("room.ptx", room)
    text = PROJECT.replace('file="old.ptx" proc="distance"', 'file="room.ptx" proc="__miss__blue"')
    old.write("project.xml", text)
    assert any(
        d.rule == "T015"
        and d.message
        == "pass 'trace': 'room.ptx' is of OptiX 7, 'old.ptx' of OptiX 3 to 6: a pass has one of them"
        for d in nau_py.lint(old.load())
    )
    other = DATA.read_text().replace(
        "_ZN21rti_internal_typeinfo7diffuseE[8] = {82, 97, 121, 0, 16,",
        "_ZN21rti_internal_typeinfo7diffuseE[8] = {82, 97, 121, 0, 12,",
    )
    old.write("other.ptx", other)
    old.write(
        "project.xml", PROJECT.replace('"old.ptx" proc="distance"', '"other.ptx" proc="distance"')
    )
    (found,) = [d for d in nau_py.lint(old.load()) if d.rule == "T015"]
    assert "'diffuse' is a variable of 12 bytes, in another file of the pass" in found.message


def test_the_selective_demo_matches_its_python_twin() -> None:
    """Same mask, same materials, another generator of random numbers: differences are noise. The
    twin's noise is known from two of its renders; pixels are independent."""

    def radiance(name: str, seed: int) -> tuple[Picture, Picture]:
        project = nau_py.load(PROJECTS / "selective" / name)
        renderer = nau_py.Renderer(project, options=nau_py.RunOptions(seed=seed))
        frame = renderer.render()
        renderer.close()
        trace = next(p for p in frame.report["frames"][0]["passes"] if p["name"] == "trace")
        assert not any(
            "no triangles" in note for note in trace.get("notes", [])
        )  # Embree's find them
        mask = frame.targets["Hybrid::position"][:, :, 3] > 0
        return frame.targets["Hybrid::radiance"][:, :, :3].mean(axis=2).astype(np.float64), mask

    compiled, mask = radiance("optix.xml", 0)
    (first, same), (second, _) = radiance("project.xml", 1), radiance("project.xml", 2)
    np.testing.assert_array_equal(mask, same)
    np.testing.assert_allclose(compiled[~mask], first[~mask])  # the clear value
    count = int(mask.sum())
    noise = (first - second)[mask] / np.sqrt(2)
    apart = (compiled - (first + second) / 2)[mask]
    wanted = noise.std() * np.sqrt(1.5)
    assert abs(apart.mean()) < 4 * wanted / np.sqrt(count)
    assert 0.9 < apart.std() / wanted < 1.1
    # nor is any part of the picture brighter or darker: 16 x 16 blocks, each a sum of many pixels
    cells = np.where(mask, compiled - (first + second) / 2, 0).reshape(64, 16, 64, 16)
    spread = np.where(mask, 1.5 * ((first - second) ** 2) / 2, 0).reshape(64, 16, 64, 16)
    sums, variances = cells.sum(axis=(1, 3)), spread.sum(axis=(1, 3))
    full = mask.reshape(64, 16, 64, 16).sum(axis=(1, 3)) > 64
    z = sums[full] / np.sqrt(variances[full] + 1e-9)
    assert full.sum() > 200
    assert np.mean(np.abs(z) > 3) < 0.03


def test_ignored_attributes_are_reported(old: Folder) -> None:
    old.write(
        "project.xml",
        PROJECT.replace("<optixEntryPoint>", '<TARGET_ERROR value="0.1" /><optixEntryPoint>'),
    )
    (found,) = nau_py.lint(old.load())
    assert (found.rule, found.severity) == ("T024", "warning")
    assert "TARGET_ERROR has no effect on compiled programs" in found.message
    record = render(old, effects="none").report["frames"][0]["passes"][1]
    assert any("effects 'none' leave nothing out here" in note for note in record["notes"])


def test_pixels_that_are_not_finite_are_counted(old: Folder) -> None:
    """0 / 0 in one column."""
    body = (
        "\t.reg .f32 %bad<3>;\n\t.reg .b64 %to<9>;\n\t.reg .b32 %at<3>;\n"
        "\tld.global.v2.u32 {%at1, %at2}, [launch_index];\n"
        "\tcvt.u64.u32 %to1, %at1;\n\tcvt.u64.u32 %to2, %at2;\n\tmov.u64 %to3, 0;\n"
        "\tmov.u64 %to4, output0;\n\tmov.f32 %bad1, 0f00000000;\n"
        "\tcall (%to5), _rt_buffer_get_64, (%to4, 2, 16, %to1, %to2, %to3, %to3);\n"
        "\tcvt.rn.f32.u32 %bad2, %at1;\n\tsub.f32 %bad2, %bad2, 0f40A00000;\n"
        "\tdiv.rn.f32 %bad2, %bad1, %bad2;\n"
        "\tst.v4.f32 [%to5], {%bad2, %bad1, %bad1, %bad1};\n\tret;\n}\n"
    )
    old.write("old.ptx", DATA.read_text() + ".visible .entry nan()\n{\n" + body)
    frame = render(old, "nan")
    assert frame.report["nonfinite"] == 24
    assert any("T014" in said and "pixel (5, 0)" in said for said in frame.report["warnings"])
    with pytest.raises(nau_py.NauError, match="T014"):
        render(old, "nan", check_numerics=True)

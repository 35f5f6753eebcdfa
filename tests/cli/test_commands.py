"""The command lines as scripts use them: exit statuses, streams, files whole or absent."""

from __future__ import annotations

import contextlib
import json
import os
import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

import nau_py
from tests.conftest import PROJECTS, ROOT, Folder
from tests.raytrace.studio import colour, program, square, studio

BIN = Path(sys.executable).parent
SMALL = ["--size", "64x48"]
SELECTIVE = str(PROJECTS / "selective" / "project.xml")

PASS = {
    "type": "object",
    "required": ["name", "class", "status", "ms", "pixels", "rays", "rays_avoided"],
    "properties": {
        "status": {"enum": ["run", "left_out"]},
        "ms": {"type": "number", "minimum": 0},
        "rays": {"type": "object", "additionalProperties": {"type": "integer", "minimum": 1}},
    },
}
REPORT = {
    "type": "object",
    "required": [
        "schema",
        "project",
        "pipeline",
        "machine",
        "frames",
        "totals",
        "effects",
        "warnings",
        "nonfinite",
    ],
    "properties": {
        "frames": {
            "type": "array",
            "items": {
                "type": "object",
                "required": ["index", "ms", "passes"],
                "properties": {"passes": {"type": "array", "items": PASS}},
            },
        }
    },
}


def run(*words: str, cwd: Path = ROOT, **env: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [BIN / words[0], *words[1:]],
        cwd=cwd,
        capture_output=True,
        text=True,
        env={**os.environ, **env},
    )


def call(*words: str, cwd: Path = ROOT, **env: str) -> subprocess.CompletedProcess[str]:
    """Run a command in this process, which saves the time of its imports."""
    app = import_module(f"nau_py.cli.{words[0].removeprefix('nau-')}").app
    with contextlib.chdir(cwd):
        done = CliRunner().invoke(app, words[1:], env=env)
    if done.exception and not isinstance(done.exception, SystemExit):
        raise done.exception
    return subprocess.CompletedProcess(words, done.exit_code, done.stdout, done.stderr)


def test_run_writes_picture_report_and_targets(tmp_path: Path) -> None:
    done = run(
        "nau-run",
        SELECTIVE,
        *SMALL,
        "-o",
        str(tmp_path / "p.png"),
        "--spp",
        "4",
        "--report",
        str(tmp_path / "r.json"),
        "--targets",
        str(tmp_path / "t"),
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""  # silent in a pipe: no progress
    for word in ("raster", "trace", "combine", "primary", "rays avoided"):
        assert word in done.stdout
    picture = np.asarray(Image.open(tmp_path / "p.png"))
    assert picture.shape == (48, 64, 3)
    report = json.loads((tmp_path / "r.json").read_text())
    jsonschema.validate(report, REPORT)
    trace = report["frames"][0]["passes"][2]
    assert trace["rays"]["primary"] == trace["pixels"] * 4
    position = np.load(tmp_path / "t" / "Hybrid.position.npy")
    assert int((position[..., 3] > 0).sum()) == trace["pixels"]
    assert (tmp_path / "t" / "Hybrid.color.png").exists()


def test_frames_and_numbers(tmp_path: Path) -> None:
    done = run(
        "nau-run",
        SELECTIVE,
        "--pipeline",
        "Raster",
        *SMALL,
        "--frames",
        "0:2",
        "--quiet",
        "-o",
        str(tmp_path / "f.%03d.png"),
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout == ""
    assert sorted(p.name for p in tmp_path.iterdir()) == ["f.000.png", "f.001.png", "f.002.png"]


def test_npy_keeps_the_values(tmp_path: Path) -> None:
    done = run("nau-run", SELECTIVE, "--pipeline", "Raster", *SMALL, "-o", str(tmp_path / "f.npy"))
    assert done.returncode == 0, done.stderr
    renderer = nau_py.Renderer(nau_py.load(SELECTIVE), "Raster", size=(64, 48))
    np.testing.assert_array_equal(np.load(tmp_path / "f.npy"), renderer.render().image)


@pytest.mark.parametrize(
    "words, status, message",
    [
        (
            ["nau-run", SELECTIVE, "--pipeline", "Selectiv"],
            1,
            "error[R013]: project 'Selective' has no pipeline 'Selectiv'; it has 'Raster', 'Selective'"
            " (did you mean 'Selective'?)",
        ),
        (
            ["nau-run", SELECTIVE, "-o", "/nowhere/at/all.png"],
            1,
            "error[E002]: output '/nowhere/at/all.png' cannot be written: the folder '/nowhere/at' "
            "does not exist",
        ),
        (
            ["nau-run", SELECTIVE, "-o", "picture.gif"],
            1,
            "its ending must be one of .png, .exr, .npy",
        ),
        (
            ["nau-run", "missing.xml"],
            1,
            "missing.xml: error[X001]: 'missing.xml' cannot be read: No such file or directory",
        ),
        (["nau-run", SELECTIVE, "--size", "12"], 2, "'12' is no size"),
        (
            ["nau-run", SELECTIVE, "--pipeline", "Raster", "--size", "99999x8"],
            1,
            "error[P010]: the window is 99999 x 8; this driver allows 1 to ",
        ),
        (["nau-run", SELECTIVE, "--frames", "5:2"], 2, "the last frame comes before the first"),
        (["nau-run", SELECTIVE, "--spp", "0"], 2, "--spp"),
        (["nau-run"], 2, "Missing argument 'PROJECT'"),
        (["nau-lint"], 2, "Missing argument"),
        (["nau-graph", SELECTIVE, "--format", "png"], 2, "png"),
        (["nau-fmt", SELECTIVE, "-o", "/nowhere/x.xml"], 1, "cannot be written"),
    ],
)
def test_wrong_use(words: list[str], status: int, message: str) -> None:
    done = call(*words, COLUMNS="300", TERM="dumb")
    assert done.returncode == status
    assert message in done.stderr
    assert "Traceback" not in done.stderr
    assert done.stdout == ""


BAD = {
    "syntax": ("<project name='P'><assets></project>", "error[X002]"),
    "library": (
        "<project name='P'><assets><materialLibs><materialLib filename='no.mlib'/>"
        "</materialLibs></assets><pipelines><pipeline name='Q'><pass name='a'/></pipeline>"
        "</pipelines></project>",
        "error[F001]",
    ),
    "material": (
        "<project name='P'><pipelines><pipeline name='Q'><pass name='a' class='quad'>"
        "<material name='m' fromLibrary='L'/></pass></pipeline></pipelines></project>",
        "error[R005]",
    ),
    "model": (
        "<project name='P'><assets><scenes><scene name='S'><file name='bad.obj'/></scene>"
        "</scenes></assets><pipelines><pipeline name='Q'><pass name='a'><scenes>"
        "<scene name='S'/></scenes></pass></pipeline></pipelines></project>",
        "error[M001]",
    ),
    "rays": (
        "<project name='P'><pipelines><pipeline name='Q'><pass name='a' class='raytrace'/>"
        "<pass name='b' class='optix'/></pipeline></pipelines></project>",
        "error[T001]",
    ),
}


@pytest.mark.parametrize("kind", BAD)
def test_bad_projects_give_diagnostics_and_no_file(folder: Folder, kind: str) -> None:
    text, expected = BAD[kind]
    folder.write("bad.obj", "v 1 2 three\n")
    folder.write("project.xml", text)
    done = call("nau-run", "project.xml", "-o", "out.png", cwd=folder.path)
    assert done.returncode == 1
    assert expected in done.stderr
    assert done.stderr.startswith("project.xml:1:")
    assert "Traceback" not in done.stderr
    assert sorted(p.name for p in folder.path.iterdir()) == ["bad.obj", "project.xml"]


def test_debug_shows_the_traceback(folder: Folder) -> None:
    folder.write("project.xml", BAD["material"][0])
    assert "Traceback" in run("nau-run", "project.xml", "--debug", cwd=folder.path).stderr


def test_an_existing_picture_survives_a_failed_run(folder: Folder) -> None:
    folder.write("project.xml", BAD["material"][0])
    folder.write("out.png", "old")
    call("nau-run", "project.xml", "-o", "out.png", cwd=folder.path)
    assert (folder.path / "out.png").read_text() == "old"


def test_without_a_driver_the_message_says_what_to_install() -> None:
    done = run(
        "nau-run",
        SELECTIVE,
        *SMALL,
        LIBGL_DRIVERS_PATH="/nowhere",
        __EGL_VENDOR_LIBRARY_DIRS="/nowhere",
        __EGL_VENDOR_LIBRARY_FILENAMES="/nowhere/x.json",
    )
    assert done.returncode == 1
    assert "error[D101]: no OpenGL 4.5 driver" in done.stderr
    assert "apt-get install libegl1 libgl1 libgl1-mesa-dri" in done.stderr


def test_doctor() -> None:
    done = run("nau-run", "--doctor")
    assert done.returncode == 0
    for word in ("OpenGL      4.", "threads", "[exr]"):
        assert word in done.stdout
    assert re.search(r"Embree      4\.\d+\.\d+, embreex 4", done.stdout)


def test_lint_statuses_and_formats(folder: Folder) -> None:
    assert call("nau-lint", "projects", "materials").returncode == 0
    done = call("nau-lint", "missing.xml", cwd=folder.path)
    assert done.returncode == 1
    assert done.stdout.startswith("missing.xml: error[X001]: 'missing.xml' cannot be read")
    folder.write("project.xml", BAD["rays"][0])
    done = call("nau-lint", "project.xml", "--format", "json", cwd=folder.path)
    assert done.returncode == 1
    assert "T001" in {d["rule"] for d in json.loads(done.stdout)}


def test_lint_applies_safe_fixes_only(folder: Folder) -> None:
    before = (
        '<project name="P" widht="8">\n'
        '<assets><cameras><camera name="C"><projection FOV="60.0.0"/></camera></cameras></assets>\n'
        '<pipelines><pipeline name="Q"><pass name="show" class="defualt"/></pipeline></pipelines>\n'
        "</project>\n"
    )
    folder.write("project.xml", before)
    done = call("nau-lint", "project.xml", "--fix", "--format", "json", cwd=folder.path)
    assert done.returncode == 1  # guesses are left to the person
    assert [d["rule"] for d in json.loads(done.stdout)] == ["S002", "P001"]
    assert done.stderr == "project.xml:2:52: fixed: '60.0.0': Write 60\n"
    after = (folder.path / "project.xml").read_text()
    assert after == before.replace("60.0.0", "60")


def test_fmt_round_trip_and_check(folder: Folder) -> None:
    done = call("nau-fmt", SELECTIVE, "--to", "yaml")
    assert done.stdout == (PROJECTS / "selective" / "project.yaml").read_text()
    folder.write("p.xml", "<project name=P ></project>")
    assert call("nau-fmt", "p.xml", "--check", cwd=folder.path).returncode == 1
    assert call("nau-fmt", "p.xml", "-o", "p.xml", cwd=folder.path).returncode == 0
    assert call("nau-fmt", "p.xml", "--check", cwd=folder.path).returncode == 0


def test_explain_says_why_a_pass_is_left_out(folder: Folder) -> None:
    folder.write(
        "l.mlib",
        '<materialLib name="L"><renderTargets><renderTarget name="rt"><SIZE width="4" height="4"/>'
        '<colors><color name="c" internalFormat="RGBA"/></colors></renderTarget></renderTargets>'
        "</materialLib>",
    )
    folder.write(
        "project.xml",
        '<project name="P" width="8" height="8"><assets><materialLibs><materialLib '
        'filename="l.mlib"/></materialLibs></assets><pipelines><pipeline name="Q">'
        '<pass name="spare"><renderTarget name="rt" fromLibrary="L"/></pass><pass name="show"/>'
        "</pipeline></pipelines></project>",
    )
    done = call("nau-run", "project.xml", "--explain", cwd=folder.path)
    assert done.returncode == 0
    assert "left out" in done.stdout
    assert "spare is left out: nothing that the picture needs reads" in done.stdout
    assert "warning[D003]" in done.stderr


def small(folder: Folder) -> None:
    """A project of two triangles, lit by an area light."""
    studio(
        folder,
        square("floor", "White", [9, 1, 9], [0, -1, 0]),
        {"White": colour("DIFFUSE", 1.0, 1.0, 1.0, 1.0)},
        program("White", "direct"),
        lights=(
            '<light name="Lamp"><POSITION x="0" y="3" z="0" /><SHAPE value="SPHERE" />'
            '<RADIUS value="0.5" /></light>'
        ),
    )


def test_cost_writes_its_files(folder: Folder) -> None:
    """Table on stdout, progress on stderr, four files, exit 0; the page names the project."""
    small(folder)
    out = folder.path / "out"
    args = ["--spp", "2,4", "--reference", "32", "--runs", "2", "--out", str(out), "--no-cache"]
    done = run("nau-cost", str(folder.path / "project.xml"), *args)
    assert done.returncode == 0, done.stderr
    assert "spp 1 (as it is)" in done.stdout
    assert "reference, 32 spp" in done.stderr
    assert sorted(p.name for p in out.iterdir()) == [
        "cost.csv",
        "cost.html",
        "cost.json",
        "cost.png",
    ]
    report = json.loads((out / "cost.json").read_text())
    assert report["region"] == "picture"
    assert "<title>Studio" in (out / "cost.html").read_text()


@pytest.mark.parametrize(
    "args, status, words",
    [
        (["--knob", "ssp=1"], 1, "there is no knob 'ssp'"),
        (["--spp", "0"], 1, "0 is out of range: legal is 1 and more"),
        (["--knob", "spp"], 2, "write KNOB=VALUE,VALUE"),
        (["--measure", "ssim"], 2, "does not rank"),
        (["--region", "sky"], 2, "write picture or mask"),
        (["--apply"], 2, "--apply needs --target-error or --budget-time"),
        (["--pipeline", "Rater"], 1, "did you mean 'Raster'"),
        (["--pipeline", "Raster", "--spp", "1"], 1, "knob 'spp' needs a raytrace pass"),
    ],
)
def test_cost_says_what_is_wrong(args: list[str], status: int, words: str) -> None:
    done = call("nau-cost", SELECTIVE, *args, *SMALL, "--no-cache")
    assert done.returncode == status
    assert words in " ".join(done.stderr.replace("│", " ").split())
    assert "Traceback" not in done.stderr


def test_cost_of_an_unmet_target_fails(folder: Folder) -> None:
    small(folder)
    args = ["--spp", "2", "--reference", "20", "--runs", "2", "--target-error", "0", "--quiet"]
    done = call("nau-cost", str(folder.path / "project.xml"), *args, "--no-cache")
    assert done.returncode == 1
    assert "no setting reaches it" in done.stderr


def test_effects_on_the_command_line(tmp_path: Path) -> None:
    """--effects leaves out what it does not list, --explain says so, a wrong name is wrong usage."""
    report = tmp_path / "r.json"
    args = ["--effects", "shadow", "--explain", "--report", str(report)]
    done = run("nau-run", SELECTIVE, *args, *SMALL)
    assert done.returncode == 0, done.stderr
    told = {e["effect"]: e for e in json.loads(report.read_text())["effects"]}
    assert told["shadow"]["status"] == "simulated"
    assert told["reflection"]["reason"] == "--effects leaves it out"
    assert "called for by" in done.stdout
    wrong = run("nau-run", SELECTIVE, "--effects", "shadows", *SMALL)
    assert wrong.returncode == 2
    assert "no effect 'shadows'" in " ".join(wrong.stderr.replace("│", " ").split())

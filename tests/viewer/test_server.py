"""The viewer's server over real sockets: what it tells, what it refuses, what it survives."""

from __future__ import annotations

import io
import json
import socket
import threading
import time
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import nau_py
from tests.conftest import LAMBERT, Folder, RayProject

pytest.importorskip("uvicorn", reason="the extra [view] is not installed")

from websockets.exceptions import ConnectionClosed, InvalidHandshake

import nau_py.cli.view as command
from nau_py.syntax.document import Document
from tests.viewer.served import TOKEN, Served, sharp


@pytest.fixture
def project(ray_project: RayProject, folder: Folder) -> Path:
    """A red square that faces the camera, lit from behind it."""
    folder.obj("scene", [("Red", [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)])])
    folder.mtl("scene", {"Red": {"Kd": "0.5 0 0"}})
    ray_project(light=(0, 0, -1), spp=2)
    return folder.path / "project.xml"


@pytest.fixture
def served(project: Path) -> Iterator[Served]:
    with Served(project) as found:
        yield found


def picture(data: bytes) -> np.ndarray[Any, Any]:
    return np.asarray(Image.open(io.BytesIO(data)))


def test_a_window_sees_steers_and_saves(served: Served, project: Path) -> None:
    before = project.read_text()
    with served.window() as one, served.window() as two:
        one.until(sharp)
        status, data = served.get("picture.png")
        assert status == 200
        want = nau_py.Renderer(nau_py.load(project)).render()
        assert picture(data).shape == (48, 64, 3)
        middle = picture(data)[24, 32]
        assert middle == pytest.approx(np.clip(want.image[24, 32, :3], 0, 1) * 255, abs=12)
        one.until(lambda w: w.glance["steps"] > 2)
        assert one.glance["spp"] == 2 * one.glance["steps"]
        one.do(do="set", key="LIGHT|Sun|COLOR", value=[0, 0, 0, 1])
        for window in (one, two):  # both see the same
            window.until(lambda w: w.content.get("changed") == ["LIGHT|Sun|COLOR"])
        # a step may pass before a window hears of it: the picture counts, not the number of steps.
        # Samples of the lit picture that stayed would keep it brighter than this.
        renderer = nau_py.Renderer(nau_py.load(project))
        renderer.set_attribute("LIGHT", "Sun", "COLOR", (0, 0, 0, 1))
        dark = np.clip(renderer.render().image[24, 32, :3], 0, 1) * 255
        assert dark[0] < middle[0] / 2
        one.until(
            lambda w: (
                sharp(w)
                and picture(served.get("picture.png")[1])[24, 32] == pytest.approx(dark, abs=2)
            )
        )
        one.do(do="undo")
        two.until(lambda w: w.content["changed"] == [])
        two.do(do="move", how="dolly", by=[0.5])
        two.until(lambda w: "CAMERA|C|POSITION" in w.content["changed"])
        two.do(do="save")
        two.until(lambda w: w.content["changed"] == [] and "saved" in w.content["note"])
        lines = project.read_text().splitlines()
        new = [line.strip() for line in lines if line not in before.splitlines()]
        assert new == [f'<POSITION x="0" y="0" z="{two.content["pose"][2]:g}" />']


def test_targets_pixels_exports_and_comparison(served: Served) -> None:
    with served.window() as window:
        window.until(sharp)
        names = [target[0] for target in window.content["targets"]]
        assert "L::out" in names
        assert picture(served.get("target.png?name=L::out&exposure=1")[1]).shape == (48, 64, 3)
        values = json.loads(served.get("pixel?name=L::out&x=0&y=0")[1])["values"]
        assert len(values) == 4
        status, said = served.get("pixel?name=L::out&x=64&y=0")
        assert (status, b"has no pixel (64, 0)" in said) == (409, True)
        status, said = served.get("target.png?name=L::on")
        assert (status, said.startswith(b"there is no target 'L::on'; there is 'L::out'")) == (
            409,
            True,
        )
        thumbs = json.loads(served.get("thumbnails")[1])
        assert picture(bytes.fromhex(thumbs["L::out"])).shape == (120, 160, 3)
        assert served.get("compare")[0] == 409  # nothing is kept yet
        assert served.get("keep?label=a", "POST")[0] == 200
        found = json.loads(served.get("compare")[1])
        assert found["figures"]["rmse"] < 0.05
        assert served.get("keep?effects=none&label=b", "POST")[0] == 200
        assert served.get("keep?pipeline=Nix", "POST")[0] == 404
        with zipfile.ZipFile(
            io.BytesIO(served.get("export/frames.zip?first=0&last=2")[1])
        ) as found:
            assert found.namelist() == [f"frame.{i:04d}.png" for i in range(3)]
        assert served.get("export/frames.zip?first=3&last=2")[0] == 404
        camera = served.get("export/camera.txt")[1].decode()
        assert '<camera name="C">' in camera
        assert 'FOV="60"' in camera
        assert "  POSITION: [0, 0, 3]" in camera


def test_hovering_disturbs_no_export(served: Served) -> None:
    """An export is finished, in spite of other requests and changes meanwhile."""
    with served.window() as window:
        window.until(sharp)
        found: list[tuple[int, bytes]] = []
        export = threading.Thread(
            target=lambda: found.append(served.get("export/frames.zip?first=0&last=30"))
        )
        export.start()
        for x in range(12):
            window.do(do="move", how="orbit", by=[0.01, 0.0])
            assert served.get(f"pixel?name=L::out&x={x}&y=0")[0] == 200
        export.join(60)
        with zipfile.ZipFile(io.BytesIO(found[0][1])) as archive:
            assert len(archive.namelist()) == 31


def test_only_its_own_page_is_let_in(served: Served, project: Path) -> None:
    root, here = served.root, f"http://127.0.0.1:{served.port}"
    assert served.get("")[0] == 200
    for wrong in ("/", "/picture.png", "/wrong/", f"/{TOKEN}x/", f"/{TOKEN[:-1]}/picture.png"):
        served.root = here
        assert served.get(wrong)[0] == 404, wrong
    served.root = root
    for outside in (
        "static/../../../project.xml",
        "static/..%2f..%2f..%2fpyproject.toml",
        "static/%2e%2e/%2e%2e/server.py",
        "../project.xml",
        "export/../../project.xml",
        "static/server.py",
    ):
        status, body = served.get(outside)
        assert status == 404, outside
        assert b"<project" not in body
    assert served.get("", Host="evil.example")[0] == 404
    assert served.get("keep", "POST", Origin="http://evil.example")[0] == 404
    for origin, token in (("http://evil.example", TOKEN), (None, "wrong")):
        with pytest.raises((InvalidHandshake, ConnectionClosed)), served.window(origin, token) as w:
            w.until(sharp)
    with served.window(origin=here) as window:
        window.until(lambda w: bool(w.content))


def test_commands_that_make_no_sense_are_refused_in_words(served: Served) -> None:
    with served.window() as window:
        for command_, words in (
            ({"do": "dance"}, "there is no command 'dance'"),
            (
                {"do": "set", "key": "LIGHT|Son|COLOR", "value": [1]},
                "nothing called 'LIGHT|Son|COLOR'",
            ),
            (
                {"do": "set", "key": "LIGHT|Sun|COLOR", "value": [1, 2]},
                "COLOR takes 4 values, not 2",
            ),
            (
                {"do": "set", "key": "LIGHT|Sun|COLOR", "value": [9, 0, 0, 1]},
                "legal is from 0 to 1",
            ),
            (
                {"do": "set", "key": "LIGHT|Sun|SHAPE", "value": ["STAR"]},
                "SHAPE is one of DIRECTIONAL",
            ),
            ({"do": "move", "how": "dolly", "by": [float("nan")]}, "cannot 'dolly'"),
            ({"do": "pipeline", "name": "Nix"}, "there is no pipeline 'Nix'"),
            ({"do": "effects", "value": "glitter"}, "there is no effect 'glitter'"),
            ({"do": "undo"}, "there is nothing to undo"),
            ({"do": "frame"}, "command 'frame'"),
        ):
            window.do(**command_)
            window.until(lambda w: bool(w.refused))
            assert words in window.refused.pop()
        window.socket.send("{")
        window.until(lambda w: bool(w.refused))


def test_ten_windows_and_one_that_vanishes(served: Served) -> None:
    windows = [served.window() for _ in range(10)]
    windows[3].socket.socket.close()  # gone without a word
    for window in windows[:3] + windows[4:]:
        window.until(lambda w: sharp(w) and w.glance["steps"] >= 2)
        window.close()
    assert served.get("picture.png")[0] == 200


def test_a_project_that_is_wrong_opens_and_mends(project: Path) -> None:
    text = project.read_text()
    project.write_text(text.replace('class="raytrace"', 'class="raytrce"'))
    with Served(project) as served, served.window() as window:
        window.until(lambda w: "P001" in w.rules())
        assert not window.content["sound"]
        finding = next(d for d in window.content["diagnostics"] if d["rule"] == "P001")
        assert "did you mean 'raytrace'?" in finding["message"]
        assert "raytrce" in finding["source"][0]
        project.write_text(text)
        window.until(sharp)
        assert window.rules() == []
        window.do(do="set", key="LIGHT|Sun|AMBIENT", value=[0.5, 0, 0, 1])
        window.until(lambda w: w.content["changed"] == ["LIGHT|Sun|AMBIENT"])
        project.unlink()  # while it is open
        window.until(lambda w: "X001" in w.rules())
        assert served.get("picture.png")[0] == 200
        project.write_text(text)
        window.until(lambda w: w.rules() == [])
        assert window.content["changed"] == ["LIGHT|Sun|AMBIENT"]  # nothing is lost


def test_a_save_that_is_refused_is_said_and_loses_nothing(
    served: Served, project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = project.read_bytes()

    def refuse(self: Document, path: Path, edits: object) -> None:
        raise OSError(30, "Read-only file system", str(path))

    with served.window() as window:
        window.do(do="set", key="LIGHT|Sun|COLOR", value=[0.5, 0, 0, 1])
        window.until(lambda w: w.content.get("changed") == ["LIGHT|Sun|COLOR"])
        monkeypatch.setattr(Document, "write", refuse)
        window.do(do="save")
        window.until(lambda w: bool(w.refused))
        assert "project.xml' cannot be written: Read-only file system" in window.refused[0]
        assert served.state.values == {"LIGHT|Sun|COLOR": (0.5, 0.0, 0.0, 1.0)}
        monkeypatch.undo()
        assert project.read_bytes() == before
        window.do(do="save")
        window.until(lambda w: w.content["changed"] == [])


HANGING = """
import time
from pathlib import Path


def hit(hits):
    time.sleep(1000 if (Path(__file__).parent / "hang").exists() else 0)
    return hits.color("DIFFUSE")[:3]


def crash(hits):
    import os
    os._exit(7)
"""


@pytest.mark.parametrize(
    "proc, words", [("hit", "gave no sign of work for 3 s"), ("crash", "exit status 7")]
)
def test_a_renderer_that_hangs_or_dies_costs_only_itself(
    ray_project: RayProject, folder: Folder, proc: str, words: str
) -> None:
    folder.obj("scene", [("Red", [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)])])
    folder.mtl("scene", {"Red": {"Kd": "1 0 0"}})
    folder.write("programs.py", HANGING)
    ray_project(LAMBERT.replace('"builtin" proc="lambert"', f'"programs.py" proc="{proc}"'))
    project = folder.path / "project.xml"
    if proc == "hit":
        (folder.path / "hang").touch()
    with Served(project, limit=3.0) as served, served.window() as window:
        window.until(lambda w: words in w.content.get("note", ""))
        assert not window.content["rendering"]
        assert served.get("")[0] == 200
        if proc == "hit":
            (folder.path / "hang").unlink()
            window.do(do="retry")
        else:
            text = project.read_text()
            project.write_text(
                text.replace('"programs.py" proc="crash"', '"builtin" proc="lambert"')
            )
        window.until(lambda w: sharp(w) and w.content["note"] == "")


def test_a_broken_program_keeps_the_last_picture(ray_project: RayProject, folder: Folder) -> None:
    folder.obj("scene", [("Red", [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)])])
    folder.mtl("scene", {"Red": {"Kd": "1 0 0"}})
    source = 'def hit(hits):\n    return hits.color("DIFFUSE")[:3]\n'
    folder.write("programs.py", source)
    ray_project(LAMBERT.replace('"builtin" proc="lambert"', '"programs.py" proc="hit"'))
    with Served(folder.path / "project.xml") as served, served.window() as window:
        window.until(sharp)
        before = served.get("picture.png")[1]
        folder.write("programs.py", source.replace("[:3]", "[:2]"))
        window.until(lambda w: bool(w.rules()))
        assert window.rules()[0].startswith("T")
        assert window.content["note"] == "the last good picture is shown"
        assert served.get("picture.png")[1] == before
        folder.write("programs.py", source.replace("[:3]", "[:3] * 0.5"))
        window.until(lambda w: w.rules() == [] and sharp(w))


def test_a_port_that_is_taken_is_said(capsys: pytest.CaptureFixture[str], project: Path) -> None:
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        with pytest.raises(SystemExit) as ended:
            command.app([str(project), "--port", str(port), "--no-browser"])
    assert ended.value.code == 1
    assert f"port {port} is taken" in capsys.readouterr().err


def test_no_browser_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("webbrowser.open", lambda url: False)
    assert not command._opened("http://127.0.0.1:1/")


def test_frames_run_and_stop(served: Served) -> None:
    with served.window() as window:
        window.until(sharp)
        window.do(do="play", on=True)
        window.until(lambda w: w.glance["frame"] > 3)
        window.do(do="play", on=False)
        window.until(lambda w: sharp(w) and not w.content["playing"])
        window.do(do="frame", index=1)
        window.until(lambda w: sharp(w) and w.glance["frame"] == 1)


def test_the_cost_front_is_measured_beside(served: Served) -> None:
    assert json.loads(served.get("cost")[1]) == {"state": "none", "said": []}
    assert served.get("cost.html")[0] == 404
    assert served.get("cost", "POST")[0] == 200
    end = time.monotonic() + 120
    while (state := json.loads(served.get("cost")[1]))["state"] == "running":
        assert time.monotonic() < end, state
        time.sleep(0.2)
    assert state["state"] == "done", state
    assert b"All numbers" in served.get("cost.html")[1]

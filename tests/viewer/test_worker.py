"""Pictures of the worker against nau-run's of the same project, saved."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import nau_py
from nau_py.passes.frame import RunOptions
from nau_py.process.worker import RequestCancelled
from nau_py.viewer.camera import camera_with
from nau_py.viewer.controls import Values
from nau_py.viewer.request import PictureRequest
from nau_py.viewer.save import save_edits
from nau_py.viewer.state import ViewerState
from nau_py.viewer.worker import RenderWorker
from tests.conftest import LAMBERT, Folder, RayProject

Pixels = np.ndarray[Any, Any]


@pytest.fixture
def scene(ray_project: RayProject, folder: Folder) -> Path:
    folder.obj(
        "scene",
        [
            ("Red", [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]),
            ("Blue", [(-3, -1, -3), (3, -1, -3), (3, -1, 3), (-3, -1, 3)]),
        ],
    )
    folder.mtl("scene", {"Red": {"Kd": "0.8 0 0"}, "Blue": {"Kd": "0 0 0.7"}})
    ray_project(
        LAMBERT,
        camera='<POSITION x="0" y="0" z="3" /><LOOK_AT_POINT x="0" y="0" z="0" />',
        light=(0.3, -0.5, -1),
        spp=2,
    )
    return folder.path / "project.xml"


def quiet(name: str, done: int, total: int) -> None:
    """Nobody listens."""


def pixels(data: bytes) -> Pixels:
    return np.asarray(Image.open(io.BytesIO(data)))


def request(values: Values, **more: Any) -> PictureRequest:
    return PictureRequest("P", values=tuple(sorted(values.items())), **more)


CHANGES: list[Values] = [
    {"CAMERA|C|POSITION": (1.5, 1.0, 2.5, 0.0)},  # LOOK_AT_POINT stays: the camera turns
    {"CAMERA|C|FOV": (35.0,), "CAMERA|C|UP": (0.3, 1.0, 0.0, 0.0)},
    {"LIGHT|Sun|COLOR": (0.5, 1.0, 0.25, 1.0), "LIGHT|Sun|DIRECTION": (-0.7, -0.2, -1.0, 0.0)},
    {"PASS|P#trace|RAYS_PER_PIXEL": (5,), "PASS|P#trace|SAMPLER": ("RANDOM",)},
]


@pytest.mark.parametrize("values", CHANGES)
def test_what_is_shown_is_what_saving_gives(scene: Path, values: Values) -> None:
    """The changed picture is that of the saved project to the bit; undone, that of the old."""
    before = nau_py.Renderer(nau_py.load(scene)).render().image
    worker = RenderWorker(scene, RunOptions(), quiet)
    worker.render(request({}), False)
    changed = pixels(worker.render(request(values), False).png)
    back = pixels(worker.render(request({}), False).png)
    worker.close()
    files, left = save_edits(nau_py.load(scene), values)
    assert left == []
    for path, (document, edits) in files.items():
        document.write(path, edits)
    after = nau_py.Renderer(nau_py.load(scene)).render().image

    def bits(image: Pixels) -> Pixels:
        return np.rint(np.clip(image[:, :, :3], 0, 1) * 255).astype(np.uint8)

    assert (changed == bits(after)).all()
    assert (back == bits(before)).all()
    assert (changed != back).any()


def test_a_material_of_a_model_can_be_tried(scene: Path) -> None:
    worker = RenderWorker(scene, RunOptions(), quiet)
    worker.render(request({}), False)
    facts = worker.summarize_scene()
    assert facts.materials["__nau_material_lib::Red"]["DIFFUSE"][:3] == pytest.approx((0.8, 0, 0))
    assert facts.low == pytest.approx((-3, -1, -3))
    assert facts.high == pytest.approx((3, 1, 3))
    key = "COLOR|__nau_material_lib::Red|DIFFUSE"
    green = pixels(worker.render(request({key: (0.0, 0.5, 0.0, 1.0)}), False).png)[24, 32]
    assert green[1] > 50
    assert green[0] == 0
    worker.close()


def test_steps_converge_with_the_error_that_is_said(scene: Path) -> None:
    """Of a picture whose edges are noisy, the mean of sixteen steps is nearer to that of many."""
    worker = RenderWorker(scene, RunOptions(), quiet)
    shown = [worker.render(request({}), False) for _ in range(16)]
    assert [s.spp for s in shown] == [2 * (i + 1) for i in range(16)]
    errors = [s.error for s in shown]
    assert errors[15] is not None
    assert errors[0] is not None
    assert errors[15] == pytest.approx(errors[0] / 4, rel=0.5)
    worker.close()
    many = nau_py.Renderer(nau_py.load(scene), options=RunOptions(samples=1024, seed=99)).render()
    truth = np.clip(many.image[:, :, :3], 0, 1)

    def off(data: bytes) -> float:
        return float(np.sqrt(((pixels(data) / 255 - truth) ** 2).mean()))

    assert off(shown[15].png) < off(shown[0].png) / 2.5


def test_a_coarse_picture_is_small_and_of_one_sample(scene: Path) -> None:
    worker = RenderWorker(scene, RunOptions(), quiet)
    shown = worker.render(request({}, size=(640, 480)), True)
    assert (shown.width, shown.height) == (16, 12)  # the target's 64 x 48, a quarter
    assert shown.spp == 1
    assert not shown.more
    worker.close()


def test_frames_forth_and_back(scene: Path) -> None:
    worker = RenderWorker(scene, RunOptions(), quiet)
    first = pixels(worker.render(request({}), False).png)
    third = pixels(worker.render(request({}, frame=3), False).png)
    again = pixels(worker.render(request({}), False).png)
    assert (first == again).all()
    renderer = nau_py.Renderer(nau_py.load(scene))
    image = np.rint(np.clip(renderer.render(3).image[:, :, :3], 0, 1) * 255)
    assert (third == image).all()
    worker.close()


def test_a_picture_that_is_cancelled_leaves_nothing_behind(scene: Path) -> None:
    stop = False

    def tell(name: str, done: int, total: int) -> None:
        if stop:
            raise RequestCancelled

    worker = RenderWorker(scene, RunOptions(), tell)
    first = worker.render(request({}), False).png
    stop = True
    with pytest.raises(RequestCancelled):
        worker.render(request(CHANGES[0]), False)
    stop = False
    assert (pixels(worker.render(request({}), False).png) == pixels(first)).all()
    worker.close()


def test_look_at_point_before_position(scene: Path) -> None:
    """Nau applies tags in their order: seen from where the camera is at that time."""
    text = scene.read_text()
    place, look = '<POSITION x="0" y="0" z="3" />', '<LOOK_AT_POINT x="0" y="0" z="0" />'
    scene.write_text(text.replace(place + look, look.replace('z="0"', 'z="-3"') + place))
    viewer = ViewerState(scene)
    assert viewer.pose().view == pytest.approx((0, 0, -1))
    assert viewer.pose().distance == pytest.approx(3)
    viewer.do({"do": "move", "how": "orbit", "by": [0.5, 0.2]})
    pose = viewer.pose()
    assert np.linalg.norm(pose.position) == pytest.approx(3, rel=1e-4)  # about the same pivot
    assert pose.view == pytest.approx(-pose.position / 3, abs=1e-4)
    state = camera_with(viewer.project, "C", viewer.values)
    assert state is not None
    assert state.forward == pytest.approx(pose.view)
    viewer.do({"do": "undo"})
    assert viewer.pose().position == pytest.approx((0, 0, 3))

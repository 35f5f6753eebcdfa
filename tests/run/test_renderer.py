"""The frame loop: run modes, history, viewports, pruning, sizes, plug-in pass classes."""

from __future__ import annotations

import numpy as np
import pytest

import nau_py
from tests.conftest import Folder

VERT = "#version 330\nin vec4 position;\nvoid main() { gl_Position = position; }\n"
COUNT = """\
#version 330
uniform sampler2D before;
out vec4 c;
void main() { c = vec4(texelFetch(before, ivec2(0), 0).r + 1.0); }
"""
LIB = """\
<materialLib name="L"><renderTargets>
<renderTarget name="a"><SIZE width="4" height="4"/><colors><color name="ca" internalFormat="R32F"/></colors></renderTarget>
<renderTarget name="b"><SIZE width="4" height="4"/><colors><color name="cb" internalFormat="R32F"/></colors></renderTarget>
</renderTargets>
<shaders><shader name="s" vs="a.vert" ps="a.frag"/></shaders>
<materials>{materials}</materials></materialLib>
"""
MATERIAL = """\
<material name="{name}"><textures><texture name="{texture}" UNIT="0"/></textures>
<shader name="s"><values><valueof uniform="before" type="TEXTURE_BINDING" context="CURRENT"
component="UNIT" id="0"/></values></shader></material>
"""


def project(folder: Folder, passes: str, size: str = 'width="8" height="8"') -> nau_py.Project:
    folder.write("a.vert", VERT)
    folder.write("a.frag", COUNT)
    made = MATERIAL.format(name="readA", texture="ca") + MATERIAL.format(name="readB", texture="cb")
    folder.write("l.mlib", LIB.format(materials=made))
    folder.write(
        "project.xml",
        f'<project name="P" {size}><assets><materialLibs>'
        '<materialLib filename="l.mlib"/></materialLibs></assets><pipelines>'
        f'<pipeline name="Q">{passes}</pipeline></pipelines></project>',
    )
    return folder.load()


PING = (
    '<pass name="ping" class="quad">{mode}<material name="readB" fromLibrary="L"/>'
    '<renderTarget name="a" fromLibrary="L"/></pass>'
)
PONG = (
    '<pass name="pong" class="quad"><material name="readA" fromLibrary="L"/>'
    '<renderTarget name="b" fromLibrary="L"/></pass>'
)
SHOW = '<pass name="show" class="quad"><texture name="cb" fromLibrary="L"/></pass>'


def test_targets_keep_their_content_from_frame_to_frame(folder: Folder) -> None:
    """ping reads what pong wrote in the frame before: two more each frame."""
    renderer = nau_py.Renderer(project(folder, PING.format(mode="") + PONG + SHOW))
    values = [renderer.render(k).targets["L::cb"][0, 0, 0] for k in (0, 1, 4)]
    assert values == [2, 4, 10]
    assert renderer.render(0).targets["L::cb"][0, 0, 0] == 2  # going back starts again


@pytest.mark.parametrize(
    "mode, values",
    [
        ("RUN_ALWAYS", [2, 4, 6]),
        ("RUN_ONCE", [2, 2, 2]),
        ("SKIP_FIRST_FRAME", [1, 3, 5]),
        ("RUN_EVEN", [2, 2, 4]),
        ("RUN_ODD", [1, 3, 3]),
    ],
)
def test_run_modes(folder: Folder, mode: str, values: list[int]) -> None:
    passes = PING.format(mode=f'<mode value="{mode}"/>') + PONG + SHOW
    renderer = nau_py.Renderer(project(folder, passes))
    frames = [renderer.render(k) for k in range(3)]
    assert [f.targets["L::cb"][0, 0, 0] for f in frames] == values
    statuses = [f.report["frames"][0]["passes"][0] for f in frames]
    for status in statuses:
        assert status["status"] == "run" or f"its mode is {mode}" in status["reason"]


def test_a_closed_renderer_starts_again(folder: Folder) -> None:
    renderer = nau_py.Renderer(project(folder, PING.format(mode="") + PONG + SHOW))
    renderer.render(1)
    renderer.close()
    assert renderer.render(0).targets["L::cb"][0, 0, 0] == 2


def test_sameas_draws_into_the_target_of_the_last_earlier_pass(folder: Folder) -> None:
    """The pass of the same name that stands later does not count (docs/format.md, 4.3)."""
    same = (
        '<pass name="same" class="quad"><material name="readB" fromLibrary="L"/>'
        '<renderTarget sameas="ping"/></pass>'
    )
    later = PONG.replace("pong", "ping")
    loaded = project(folder, PING.format(mode="") + same + later + SHOW)
    targets = {p.name: loaded.target_of(p) for p in loaded.pipelines[0].passes[:2]}
    assert targets["same"] == targets["ping"]
    owner = targets["same"]
    assert owner is not None
    assert owner[1].name == "a"


def test_a_pipeline_that_draws_nothing_says_so(folder: Folder) -> None:
    """No black picture without a diagnostic."""
    renderer = nau_py.Renderer(project(folder, ""))
    renderer.render()
    found = [d for d in renderer.diagnostics if d.rule == "E003"]
    assert [d.message.split(":")[0] for d in found] == ["pipeline 'Q' draws no picture"]
    drawn = nau_py.Renderer(project(folder, PING.format(mode="") + PONG + SHOW))
    drawn.render()
    assert not [d for d in drawn.diagnostics if d.rule == "E003"]


def test_a_pass_that_nobody_needs_is_left_out_with_its_reason(folder: Folder) -> None:
    passes = PING.format(mode="") + '<pass name="show" class="quad"/>'
    loaded = project(folder, passes)
    frame = nau_py.Renderer(loaded).render()
    left = frame.report["frames"][0]["passes"][0]
    assert left["status"] == "left_out"
    assert "texture L::ca" in left["reason"]
    assert "L::ca" not in frame.targets
    kept = nau_py.Renderer(loaded, keep_targets=True).render()
    assert kept.report["frames"][0]["passes"][0]["status"] == "run"
    assert "L::ca" in kept.targets


def test_a_pipeline_without_a_window_pass_shows_its_last_target(folder: Folder) -> None:
    frame = nau_py.Renderer(project(folder, PING.format(mode="") + PONG)).render()
    assert frame.image.shape == (4, 4, 1)
    assert frame.image.dtype == np.float32
    assert (frame.image == 2).all()


@pytest.mark.parametrize(
    "size, shape",
    [('width="8" height="6"', (6, 8)), ("", (360, 640)), ('width="0" height="5"', (512, 512))],
)
def test_window_sizes(folder: Folder, size: str, shape: tuple[int, int]) -> None:
    image = nau_py.Renderer(project(folder, '<pass name="a"/>', size)).render().image
    assert image.shape == (*shape, 4)


def test_errors_of_lint_stop_the_renderer(folder: Folder) -> None:
    with pytest.raises(nau_py.ProjectError, match="R010"):
        nau_py.Renderer(project(folder, PONG.replace('name="b"', 'name="z"')))


def test_a_target_follows_an_explicit_viewport(folder: Folder) -> None:
    """docs/format.md 11.5: the render target is resized to the viewport's pixels."""
    passes = PONG.replace("</pass>", '<viewport name="V"/></pass>') + SHOW
    project(folder, passes)
    text = (folder.path / "project.xml").read_text()
    folder.write(
        "project.xml",
        text.replace(
            "<assets>",
            '<assets><viewports><viewport name="V"><SIZE width="0.5" height="0.25"/>'
            "</viewport></viewports>",
        ),
    )
    frame = nau_py.Renderer(folder.load(), size=(32, 32)).render()
    assert frame.targets["L::cb"].shape == (8, 16, 1)


def test_plugin_pass_classes(folder: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    from nau_py.graph.contract import Access
    from nau_py.graph.resource import WINDOW
    from nau_py.model.passes import Pass
    from nau_py.passes.frame import FrameContext
    from nau_py.passes.registry import PassClass, pass_classes
    from nau_py.passes.report import PassReport

    class Painter(PassClass):
        def access(self, *_: object) -> Access:
            return Access(writes=[WINDOW])

        def execute(self, pass_: Pass, frame: FrameContext) -> PassReport:
            view = frame.session.view
            view.target.bind(view.rect)
            view.target.clear_color((1.0, 0.0, 0.0, 1.0))
            return PassReport()

    monkeypatch.setitem(pass_classes(), "painter", Painter())
    image = nau_py.Renderer(project(folder, '<pass name="p" class="painter"/>')).render().image
    assert (image == [255, 0, 0, 255]).all()


def test_an_unsupported_class_stops_its_own_pipeline_only(folder: Folder) -> None:
    loaded = project(folder, '<pass name="m" class="mesh"/>')
    text = (folder.path / "project.xml").read_text()
    other = '<pipeline name="R"><pass name="r"/></pipeline></pipelines>'
    folder.write("project.xml", text.replace("</pipelines>", other))
    loaded = folder.load()
    with pytest.raises(nau_py.ProjectError, match="class 'mesh' is not supported"):
        nau_py.Renderer(loaded, "Q")
    assert nau_py.Renderer(loaded, "R").render().image.shape == (8, 8, 4)
    assert nau_py.plan(loaded, "Q").steps[0].reason == "its class 'mesh' is not supported"

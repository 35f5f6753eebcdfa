"""The viewer driven in a real browser: what a person does with the demo, from opening to saving.

``scripts/drive`` brings Chromium and Playwright, and runs this.
"""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.conftest import PROJECTS, ROOT

pytestmark = pytest.mark.browser
BROWSER = shutil.which("chromium") or shutil.which("chromium-browser")
if BROWSER is None:
    pytest.skip("there is no Chromium", allow_module_level=True)
sync_api = pytest.importorskip("playwright.sync_api")
pytest.importorskip("uvicorn")

from tests.viewer.served import Served  # noqa: E402

SHOTS = os.environ.get("NAU_SHOTS")
"""A folder to keep screenshots in."""
SLOW = 60_000


@pytest.fixture
def demo(tmp_path: Path) -> Path:
    shutil.copytree(PROJECTS / "selective", tmp_path / "projects" / "selective")
    (tmp_path / "projects" / "models").symlink_to(PROJECTS / "models")
    shutil.copytree(ROOT / "materials", tmp_path / "materials")
    return tmp_path / "projects" / "selective" / "project.xml"


@pytest.fixture
def served(demo: Path) -> Iterator[Served]:
    with Served(demo) as found:
        yield found


class Person:
    """A user of a window: actions, and waiting for their effects."""

    def __init__(self, page: sync_api.Page) -> None:
        self.page = page
        self.troubles: list[str] = []
        page.set_default_timeout(SLOW)
        page.on("pageerror", lambda error: self.troubles.append(str(error)))
        page.on("console", self._heard)
        sync_api.expect.set_options(timeout=SLOW)

    def _heard(self, message: sync_api.ConsoleMessage) -> None:
        if message.type == "error":
            self.troubles.append(message.text)

    def sees(self, place: str, words: str | re.Pattern[str]) -> None:
        sync_api.expect(self.page.locator(place)).to_contain_text(words)

    def waits_for_full_size(self) -> None:
        self.sees("#status", re.compile(r"\d+ spp"))

    def number(self) -> int:
        """The number of the picture that is shown."""
        return int(self.page.get_attribute("#picture", "data-n") or 0)

    def keeps(self, name: str) -> None:
        if SHOTS:
            self.page.screenshot(path=str(Path(SHOTS) / f"{name}.png"))


@pytest.fixture
def person(served: Served) -> Iterator[Person]:
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=BROWSER, args=["--no-sandbox"])
        page = browser.new_context(viewport={"width": 1500, "height": 950}).new_page()
        made = Person(page)
        page.goto(served.root)
        yield made
        browser.close()
        assert made.troubles == []


def test_from_opening_to_saving(person: Person, served: Served, demo: Path) -> None:
    page = person.page
    before = demo.read_text()

    person.waits_for_full_size()
    sync_api.expect(page.locator("#graph .pass")).to_have_count(4)
    sync_api.expect(page.locator("#graph image")).to_have_count(6)
    person.keeps("1_open")

    stage = page.locator("#stage").bounding_box()
    assert stage is not None
    shown = person.number()
    page.mouse.move(stage["x"] + 500, stage["y"] + 300)
    page.mouse.down()
    for step in range(1, 9):
        page.mouse.move(stage["x"] + 500 + 6 * step, stage["y"] + 300 + step)
    page.mouse.up()
    person.sees("#status", "coarse")
    person.waits_for_full_size()
    assert person.number() > shown + 1
    sync_api.expect(page.locator("#undo")).to_be_enabled()
    person.keeps("2_orbit")

    page.click('[data-target="Hybrid::position"]')
    sync_api.expect(page.locator("#target")).to_have_attribute("data-name", "Hybrid::position")
    page.hover("#target", position={"x": 160, "y": 300})
    person.sees("#read", re.compile(r"r = -?\d+\.\d+\s+g = -?\d+\.\d+\s+b = -?\d+\.\d+\s+a = [01]"))
    page.select_option("#targets", "Hybrid::radiance")
    page.check("text=mask")
    sync_api.expect(page.locator("#target")).to_have_attribute("data-name", "Hybrid::radiance")
    person.keeps("3_inspect")

    page.click("[data-tab=compare]")
    page.click("#keep")
    sync_api.expect(page.locator("[data-figure=rmse]")).to_have_text(re.compile(r"^0|e-"))
    page.click("[data-tab=parameters]")
    page.click('summary:has-text("Light Sun")')
    green = page.locator('[data-key="LIGHT|Sun|COLOR"] input[type=number]').nth(1)
    green.fill("0.35")
    green.press("Enter")
    changed = page.locator('.control.changed[data-key="LIGHT|Sun|COLOR"]')
    sync_api.expect(changed).to_have_count(1)
    page.click("[data-tab=compare]")
    sync_api.expect(page.locator("[data-figure=rmse]")).to_have_text(re.compile(r"^0\.[01]\d"))
    person.keeps("4_compare")
    page.click("#end-compare")

    shader = demo.parent.parent.parent / "materials" / "shaders" / "combine.frag"
    good = shader.read_text()
    page.click("[data-tab=diagnostics]")
    shader.write_text(good.replace("void main()", "void main(", 1))
    person.sees(".finding b.error", "G001")
    person.sees(".finding pre", "void main(")
    person.sees("#note", "the last good picture is shown")
    person.keeps("5_broken")
    shader.write_text(good)
    sync_api.expect(page.locator(".finding b.error")).to_have_count(0)
    person.waits_for_full_size()
    sync_api.expect(page.locator("#note")).to_be_hidden()

    page.click("#save")
    person.sees("#note", "saved into project.xml")
    sync_api.expect(page.locator("#save")).to_be_disabled()
    lines = [line.strip() for line in demo.read_text().splitlines()]
    new = [line for line in lines if line not in [x.strip() for x in before.splitlines()]]
    assert any('g="0.35"' in line for line in new)
    assert any(line.startswith("<POSITION") for line in new)
    assert len(new) == 2
    page.click("[data-tab=export]")
    person.sees("#camera", '<camera name="Eye">')
    person.keeps("6_saved")
    page.click("#undo")  # of what was saved: the file's value is the changed one now
    sync_api.expect(changed).to_have_count(1)


def test_pipelines_frames_and_a_second_window(person: Person, served: Served) -> None:
    page = person.page
    person.waits_for_full_size()
    other = page.context.new_page()
    other.goto(served.root)
    page.select_option("#pipeline", "Raster")
    sync_api.expect(page.locator("#graph .pass")).to_have_count(1)
    sync_api.expect(other.locator("#pipeline")).to_have_value("Raster")
    page.fill("#frame", "3")
    page.press("#frame", "Enter")
    sync_api.expect(other.locator("#frame")).to_have_value("3")
    other.click("[data-tab=diagnostics]")
    sync_api.expect(other.locator("#diagnostics")).to_contain_text("Nothing to report.")
    page.fill("#effects", "glitter")
    page.press("#effects", "Enter")
    person.sees("#note", "there is no effect 'glitter'")

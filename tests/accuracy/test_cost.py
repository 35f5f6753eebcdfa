"""Whole cost runs on small projects."""

from __future__ import annotations

import csv
import io
import json
import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import jsonschema
import numpy as np
import pytest
from PIL import Image

import nau_py
from nau_py.accuracy.apply import apply_setting
from nau_py.accuracy.candidate import make_base, make_candidates, prepare_candidate, read_ladders
from nau_py.accuracy.cost import CostRequest, CostRun, measure_cost
from nau_py.accuracy.document import write_document
from nau_py.accuracy.front_chart import draw_front
from nau_py.accuracy.measure import sum_stages
from nau_py.accuracy.page import find_worst_square, write_page
from nau_py.accuracy.ranking import Ranking
from nau_py.accuracy.report import SettingCost, make_schema, to_csv, to_json
from nau_py.accuracy.statistics import compute_spread
from nau_py.run.pipeline_choice import choose_pipeline
from tests.conftest import PROJECTS, ROOT, Folder
from tests.raytrace.studio import colour, program, square, studio

PANEL = (
    '<light name="Lamp"><POSITION x="0" y="4" z="0" /><SHAPE value="RECTANGLE" />'
    '<EDGE_U x="1.5" y="0" z="0" /><EDGE_V x="0" y="0" z="1.5" /></light>'
)
DOWN = '<POSITION x="0" y="1.5" z="0" /><VIEW x="0" y="-1" z="0" /><UP x="0" y="0" z="-1" />'


@pytest.fixture(autouse=True)
def own_cache(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    """References of tests are not kept beyond them."""
    monkeypatch.setattr(
        "nau_py.accuracy.reference.make_cache_folder",
        lambda name: tmp_path_factory.mktemp("references"),
    )


def penumbra(folder: Folder, spp: int = 4, settings: str = "") -> nau_py.Project:
    return studio(
        folder,
        square("floor", "White", [9, 1, 9], [0, 0, 0])
        + square("card", "White", [5, 1, 9], [-5, 2, 0]),
        {"White": colour("DIFFUSE", 1.0, 1.0, 1.0, 1.0)},
        program("White", "direct"),
        lights=PANEL,
        camera=DOWN,
        size=(24, 16),
        spp=spp,
        settings=settings,
    )


def run(project: nau_py.Project, **asked: Any) -> CostRun:
    size = asked.pop("size", None)
    return measure_cost(project, nau_py.RunOptions(), CostRequest(**{"runs": 3} | asked), size=size)


def by(found: CostRun, knob: str) -> dict[Any, SettingCost]:
    return {s.values[knob]: s for s in found.report.settings}


def rmse(s: SettingCost, region: str = "picture") -> float:
    value = s.errors[region].rmse.mean
    assert value is not None
    return value


def test_more_samples_less_error(folder: Folder) -> None:
    """The error falls with the samples, all of it is noise, and the report says what it cost."""
    found = run(penumbra(folder), knobs={"spp": "4, 16, 64"}, reference=2048)
    settings = by(found, "spp")
    assert [s.base for s in found.report.settings] == [True, False, False]
    assert rmse(settings[4]) > 2 * rmse(settings[16]) > 4 * rmse(settings[64]) > 0
    for spp, s in settings.items():
        errors = s.errors["picture"]
        assert s.rays["primary"] == spp * 24 * 16
        assert errors.bias2 is not None
        assert errors.variance is not None
        assert errors.bias2 < 0.25 * errors.variance
        low, high = errors.rmse.interval
        assert low is not None
        assert high is not None
        assert low < rmse(s) < high
        assert s.nonfinite == 0
        assert set(s.stages) == {"raster", "trace", "shade", "build", "read_back", "other"}
        assert 0 < sum(s.stages.values()) < 2 * s.time.range[1]  # medians of each stage
        assert s.time.range[0] <= s.time.median <= s.time.range[1]
    own = found.report.reference.own_rmse["picture"]
    assert own is not None
    assert own < rmse(settings[64])
    assert {"gl_renderer", "processor", "numpy", "embreex", "nau_py"} <= set(found.report.machine)


def test_stages_add_up_to_the_time_of_a_frame(folder: Folder) -> None:
    """In each run; the medians of a report are those of different runs."""
    report = nau_py.Renderer(penumbra(folder)).render().report
    whole = report["frames"][0]["ms"]
    assert sum(sum_stages(report, 0.0).values()) == pytest.approx(whole, rel=1e-9)
    captured = sum_stages(report, 2 * whole)
    assert captured["read_back"] == pytest.approx(sum_stages(report, 0.0)["read_back"] + 2 * whole)


def test_the_time_that_halves_the_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """Independent samples: the error falls with the root of the time, so half of it costs four times."""
    ladder = [SimpleNamespace(stages={"trace": [n], "shade": [2.0 * n]}) for n in (4.0, 16.0, 64.0)]
    monkeypatch.setattr(Ranking, "select_ladder", lambda self, knob: ladder)
    monkeypatch.setattr(Ranking, "beats_reference", lambda self, m: False)
    monkeypatch.setattr(Ranking, "locate", lambda self, m: (0.0, m.stages["trace"][0] ** -0.5))
    truth = SimpleNamespace(own_mse=lambda region: 0.0)
    assert Ranking("rmse", "picture", truth, []).halving == pytest.approx(4)  # type: ignore[arg-type]


def test_the_files(folder: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    """JSON by the published schema, CSV with a row a setting, a page without network, a PNG."""
    pytest.importorskip("matplotlib", reason="the extra [plot] is not installed")
    found = run(penumbra(folder), knobs={"spp": "1, 4"}, reference=64, effects=True)
    text = to_json(found.report)
    published = json.loads((ROOT / "docs" / "cost-1.schema.json").read_text())
    assert published == make_schema(), "run scripts/reference"
    jsonschema.validate(json.loads(text), published)
    rows = list(csv.DictReader(io.StringIO(to_csv(found.report))))
    assert [r["spp"] for r in rows] == ["4", "1"]
    assert float(rows[1]["picture_rmse"]) > float(rows[0]["picture_rmse"])
    html = write_page(found)
    assert re.findall(r"(?:src|href)=\"(?!data:)[^\"]*\"|https?://", html) == []
    for s in found.report.settings:
        assert s.label in html
    assert "Rays, time and difference of each effect" in html
    assert "data:image/svg+xml" in html
    with monkeypatch.context() as without:
        without.setattr("nau_py.accuracy.front_chart.can_draw", lambda: False)
        assert draw_front(found.report) is None
        plain = write_page(found)
        assert "pip install &#39;nau_py[plot]&#39;" in plain
        assert "data:image/svg+xml" not in plain
        assert "All numbers" in plain
    front = draw_front(found.report)
    assert front is not None
    drawn = np.asarray(Image.open(io.BytesIO(front)))
    assert drawn.std() > 5
    told = write_document(found.report)
    assert "## Gain of 4 samples over 1" in told
    assert "| shadow | yes |" in told


def test_effects_are_worth_what_they_change(folder: Folder) -> None:
    """Without its shadows the floor under the card is bright; without penumbra only the edge
    differs; nothing calls for the rest."""
    found = {
        e.effect: e
        for e in run(
            penumbra(folder), knobs={"spp": "4"}, reference=64, effects=True
        ).report.effects
    }
    assert found["shadow"].rays == 4 * 24 * 16
    assert found["shadow"].rmse > found["penumbra"].rmse > 0
    assert min(found["shadow"].pixels, found["penumbra"].pixels) > 100
    assert [e.effect for e in found.values() if e.called_for] == ["shadow", "penumbra"]
    assert found["refraction"].rmse == found["refraction"].ms == found["refraction"].rays == 0


def test_references_are_kept_by_content(
    folder: Folder, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same project finds its reference; another colour, size or number does not."""
    kept = tmp_path_factory.mktemp("kept")
    monkeypatch.setattr("nau_py.accuracy.reference.make_cache_folder", lambda name: kept)

    def cached(**asked: Any) -> bool:
        wishes = {"knobs": {"spp": "2"}, "reference": 16} | asked
        return run(folder.load(), **wishes).report.reference.cached

    penumbra(folder)
    assert not cached()
    assert cached()
    assert not cached(size=(12, 8))
    assert not cached(reference=18)
    library = (folder.path / "lib.mlib").read_text()
    folder.write("lib.mlib", library.replace('r="1.0"', 'r="0.9"'))
    assert not cached()
    folder.write("lib.mlib", library)
    assert cached()
    wishes = CostRequest({"spp": "2"}, reference=16, runs=2)
    dark = measure_cost(folder.load(), nau_py.RunOptions(effects="none"), wishes)
    assert not dark.report.reference.cached
    for file in kept.glob("*.npz"):
        file.write_bytes(b"broken")
    assert not cached()


def test_a_better_candidate_is_flagged(folder: Folder) -> None:
    """Sixteen samples of a reference cannot judge fifteen."""
    found = run(penumbra(folder), knobs={"spp": "1, 15"}, reference=16)
    best = by(found, "spp")[15]
    assert best.better_than_reference
    assert not best.on_front
    assert any("more accurate than the reference" in note for note in found.report.notes)
    assert not by(found, "spp")[1].better_than_reference


def test_a_target_is_met_and_verified(folder: Folder) -> None:
    """The cheapest number of samples whose error stays below, by measuring between the rungs."""
    found = run(penumbra(folder), knobs={"spp": "1, 64"}, reference=2048, target_error=0.02, runs=5)
    answer = next(a for a in found.report.answers if "at most 0.02" in a.question)
    promise = found.report.verified[0]
    assert answer.setting == promise.setting
    assert promise.kept
    assert found.chosen is not None
    settings = by(found, "spp")
    passing = {
        n for n, s in settings.items() if (s.errors["picture"].rmse.interval[1] or 1) <= 0.02
    }
    assert found.chosen["spp"] in passing  # which of them is the fastest, is the machine's affair
    least = min(passing)
    assert 1 < least < 64
    assert least <= max(1.3 * max(n for n in settings if n < least), 2)


def test_an_unreachable_target(folder: Folder) -> None:
    found = run(penumbra(folder), knobs={"spp": "1, 2"}, reference=16, target_error=1e-9)
    answer = next(a for a in found.report.answers if "1e-09" in a.question)
    assert answer.setting is None
    assert "no setting reaches it" in answer.text
    assert found.chosen is None


@pytest.mark.slow  # compares measured times: for a machine that does nothing else
def test_a_budget_is_kept_and_verified(folder: Folder) -> None:
    """Between what few and many samples take."""
    project = penumbra(folder)
    first = run(project, knobs={"spp": "1, 1024"}, reference=1025, size=(48, 32))
    times = {k: s.time.median for k, s in by(first, "spp").items()}
    budget = (times[1] + times[1024]) / 2000
    found = run(
        project, knobs={"spp": "1, 1024"}, reference=2048, budget_time=budget, size=(48, 32)
    )
    assert found.chosen is not None
    assert 1 < int(found.chosen["spp"] or 0) < 1024
    promise = found.report.verified[0]
    assert promise.found.mean is not None
    # a verification on a machine that does other things, too
    assert promise.found.mean < 2 * budget


def masks(**more: str) -> CostRun:
    """The plaza by rasterisation, with its mask, and with every pixel traced."""
    project = nau_py.load(PROJECTS / "selective" / "project.xml")
    knobs = {"mask": "none, project, all"} | more
    return run(project, knobs=knobs, reference=24, size=(48, 48), runs=2)


def test_the_mask_against_tracing_everything() -> None:
    """Inside the mask the same samples; outside it rasterisation is all the error."""
    found = masks()
    only = by(found, "mask")
    assert found.report.region == "mask"
    assert rmse(only["project"], "mask") == pytest.approx(rmse(only["all"], "mask"), rel=1e-9)
    assert rmse(only["all"]) < 0.5 * rmse(only["project"]) < 0.5 * rmse(only["none"])
    assert only["none"].rays == {}
    assert sum(only["all"].rays.values()) > 4 * sum(only["project"].rays.values())


@pytest.mark.slow  # compares measured times: for a machine that does nothing else
def test_the_mask_is_faster_at_equal_error() -> None:
    told = {c.setting: c for c in masks(spp="4").report.comparisons}
    everything = next(c for label, c in told.items() if "mask all" in label)
    assert everything.at_equal_error is not None
    assert "mask project" in everything.at_equal_error
    assert everything.time_ratio is not None
    assert everything.time_ratio < 1


def constant(folder: Folder, value: float = 0.3) -> nau_py.Project:
    """A picture of one emitted colour."""
    return studio(
        folder,
        square("wall", "Glow", [9, 1, 9], [0, 0, -1], '<ROTATE x="1" y="0" z="0" w="90" />'),
        {"Glow": colour("EMISSION", value, value, value, 1.0)},
        program("Glow", "emission"),
        size=(8, 8),
    )


def test_formats_round(folder: Folder) -> None:
    """Each format is off by its own rounding of 0.3, to the bit."""
    found = by(run(constant(folder), knobs={"format": "8-bit, half, float"}, reference=4), "format")
    expected = {
        "8-bit": abs(round(0.3 * 255) / 255 - float(np.float32(0.3))),
        "half": abs(float(np.float16(0.3)) - float(np.float32(0.3))),
        "float": 0.0,
    }
    for name, off in expected.items():
        assert rmse(found[name]) == pytest.approx(off, rel=1e-5, abs=1e-9)


def test_scale_renders_fewer_pixels(folder: Folder) -> None:
    found = by(run(penumbra(folder), knobs={"scale": "0.5, 1"}, reference=64), "scale")
    # the pass's target has its own SIZE: the window is what scales, so rays stay
    assert rmse(found[0.5]) >= 0
    project = nau_py.load(PROJECTS / "selective" / "project.xml")
    scaled = run(project, knobs={"scale": "0.5"}, reference=24, size=(32, 32), runs=2)
    half, whole = (by(scaled, "scale")[k] for k in (0.5, 1.0))
    assert half.pixels < 0.4 * whole.pixels
    assert rmse(half) > rmse(whole)


def test_filters_of_textures(folder: Folder) -> None:
    """NEAREST shows texels only, in rays; LINEAR mixes them."""
    folder.obj(
        "scene",
        [("Card", [(-3.0, -3.0, 0.0), (3.0, -3.0, 0.0), (3.0, 3.0, 0.0), (-3.0, 3.0, 0.0)])],
    )
    folder.mtl("scene", {"Card": {"map_Kd": "c.png", "Kd": "1 1 1"}})
    texels = np.zeros((4, 4, 3), np.uint8)
    texels[::2, ::2] = 255
    folder.image("c.png", texels)
    constant(folder)
    text = (folder.path / "project.xml").read_text()
    text = re.sub(r"<geometry .*</geometry>", '<file name="scene.obj" />', text)
    text = text.replace('proc="emission"', 'proc="lambert"').replace(
        '<map fromMaterial="Glow" toLibrary="L" toMaterial="Glow" />', ""
    )
    folder.write("project.xml", re.sub(r'<rtMap to="Glow">.*?</rtMap>', "", text))
    project = folder.load()
    pipeline = choose_pipeline(project, None)
    start = make_base(project, pipeline, read_ladders(project, pipeline, {"filter": "linear"}))
    values = {}
    for name in ("nearest", "linear"):
        made = prepare_candidate(
            project, pipeline, start.with_value("filter", name), nau_py.RunOptions(), project.size
        )
        frame = nau_py.Renderer(made.project, options=made.options).render()
        values[name] = set(np.unique(frame.targets["L::out"][..., 0]).tolist())
    assert len(values["nearest"]) == 2
    assert len(values["linear"]) > 2


def test_knobs_of_passes_and_selectors(folder: Folder) -> None:
    """PASS/ATTRIBUTE and PASS/SELECTOR/ATTRIBUTE reach what they name, in a copy."""
    project = nau_py.load(PROJECTS / "penumbra" / "project.xml")
    pipeline = choose_pipeline(project, None)
    name = next(p.name for p in pipeline.passes if p.pass_class == "mask")
    turned = read_ladders(
        project, pipeline, {"trace/LIGHT_SAMPLES": "1, 8", f"{name}/shadowBorder/radius": "1, 3"}
    )
    start = make_base(project, pipeline, turned)
    every = make_candidates(start, turned, combine=True)
    assert len(every) >= 4
    wanted = start.with_value("trace/LIGHT_SAMPLES", 8).with_value(
        f"{name}/shadowBorder/radius", 3.0
    )
    made = prepare_candidate(project, pipeline, wanted, nau_py.RunOptions(), project.size)
    mine, other = (
        {p.name: p for p in choose_pipeline(x, None).passes} for x in (project, made.project)
    )
    assert other["trace"].get("LIGHT_SAMPLES") == (8,)
    assert other[name].select[0].radius == 3
    assert mine["trace"].get("LIGHT_SAMPLES") != (8,)


def test_without_rays(folder: Folder) -> None:
    """A project that only rasterises has a scale to turn, and no noise."""
    project = nau_py.load(PROJECTS / "selective" / "project.xml")
    found = measure_cost(
        project,
        nau_py.RunOptions(),
        CostRequest({"scale": "0.5"}, runs=2),
        pipeline="Raster",
        size=(64, 64),
    )
    half = by(found, "scale")[0.5]
    assert rmse(half) > 0
    assert rmse(by(found, "scale")[1.0]) == 0
    assert found.report.halving is None


def test_apply_changes_what_it_must(folder: Folder) -> None:
    """One value in one line; comments, quotes and blanks stay."""
    project = penumbra(folder)
    file = folder.path / "project.xml"
    text = file.read_text().replace("<RAYS_PER_PIXEL", "<!-- samples -->\n  <RAYS_PER_PIXEL")
    file.write_text(text)
    project = folder.load()
    pipeline = choose_pipeline(project, None)
    turned = read_ladders(project, pipeline, {"spp": "8", "light-samples": "4"})
    start = make_base(project, pipeline, turned)
    said = apply_setting(project, pipeline, start.with_value("spp", 23), start)
    assert said == ["spp 4 -> 23"]
    after = file.read_text()
    assert after == text.replace('<RAYS_PER_PIXEL value="4" />', '<RAYS_PER_PIXEL value="23" />')
    project = folder.load()
    apply_setting(
        project, choose_pipeline(project, None), start.with_value("light-samples", 4), start
    )
    pass_ = choose_pipeline(folder.load(), None).passes[0]
    assert (pass_.get("RAYS_PER_PIXEL"), pass_.get("LIGHT_SAMPLES")) == ((23,), (4,))
    assert nau_py.lint(folder.load()) == []
    turned = read_ladders(project, pipeline, {"format": "half"})
    start = make_base(project, pipeline, turned)
    with pytest.raises(nau_py.ProjectError, match="no project file says it"):
        apply_setting(project, pipeline, start.with_value("format", "half"), start)


def test_apply_in_yaml(folder: Folder) -> None:
    """An existing value and a new one; every other line stays."""
    text = (PROJECTS / "selective" / "project.yaml").read_text()
    folder.write("project.yaml", text)
    project = folder.load("project.yaml")
    pipeline = choose_pipeline(project, None)
    turned = read_ladders(project, pipeline, {"spp": "8", "light-samples": "4"})
    start = make_base(project, pipeline, turned)
    apply_setting(
        project, pipeline, start.with_value("spp", 23).with_value("light-samples", 4), start
    )
    before, after = text.splitlines(), (folder.path / "project.yaml").read_text().splitlines()
    assert [line.strip("- ") for line in after if line not in before] == [
        "LIGHT_SAMPLES: 4",
        "RAYS_PER_PIXEL: 23",
    ]
    passes = {p.name: p for p in choose_pipeline(folder.load("project.yaml"), None).passes}
    assert passes["trace"].get("RAYS_PER_PIXEL") == (23,)
    assert passes["trace"].get("LIGHT_SAMPLES") == (4,)


def test_a_wrong_project_is_said_first(folder: Folder) -> None:
    project = penumbra(folder)
    file = folder.path / "project.xml"
    file.write_text(file.read_text().replace("<RAYS_PER_PIXEL", "<RAYS_PER_PIXL"))
    project = folder.load()
    with pytest.raises(nau_py.ProjectError, match="RAYS_PER_PIXL"):
        run(project, knobs={"spp": "1"})


def test_wrong_knobs_are_all_said(folder: Folder) -> None:
    with pytest.raises(nau_py.ProjectError) as caught:
        run(penumbra(folder), knobs={"ssp": "1", "depth": "0", "mask": "all"})
    assert [d.rule for d in caught.value.diagnostics] == ["A001", "A002", "A003"]
    with pytest.raises(nau_py.ProjectError, match="cannot judge 64 spp"):
        run(penumbra(folder), knobs={"spp": "64"}, reference=64)


def test_the_project_says_what_to_measure(folder: Folder) -> None:
    project = penumbra(folder)
    file = folder.path / "project.xml"
    said = (
        '<accuracy reference="32" runs="2"><knob name="spp" values="1, 2" /></accuracy></project>'
    )
    file.write_text(file.read_text().replace("</project>", said))
    project = folder.load()
    assert nau_py.lint(project) == []
    found = measure_cost(project, nau_py.RunOptions(), CostRequest())
    assert found.report.runs == 2
    assert found.report.reference.spp == 32
    assert [s.values for s in found.report.settings] == [{"spp": 4}, {"spp": 1}, {"spp": 2}]


def test_the_worst_place() -> None:
    difference = np.zeros((40, 60))
    difference[25:30, 33:41] = 1.0
    row, column = find_worst_square(difference, 8)
    assert row <= 25 <= 30 <= row + 8
    assert column == 33


def test_renderer_again_changes_random_numbers_only(folder: Folder) -> None:
    """The same seed gives the same bits, another one other noise about the same mean."""
    renderer = nau_py.Renderer(penumbra(folder, spp=64))
    with pytest.raises(ValueError, match="no frame has been rendered"):
        renderer.again(1)
    first = renderer.render(2).targets["L::out"].copy()
    other = renderer.again(5)
    same = renderer.again(0)
    np.testing.assert_array_equal(same.targets["L::out"], first)
    assert (other.targets["L::out"] != first).any()
    assert abs(float(other.targets["L::out"].mean() - first.mean())) < 0.01
    assert compute_spread([1.0]).median == 1.0
    assert Path(folder.path).is_dir()

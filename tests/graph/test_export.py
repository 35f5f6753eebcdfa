"""nau-graph's formats on the selective demo."""

from __future__ import annotations

import json

from lxml import etree

import nau_py
from nau_py.graph.export import export
from tests.conftest import PROJECTS


def make() -> nau_py.Plan:
    return nau_py.plan(nau_py.load(PROJECTS / "selective" / "project.xml"))


def test_json_lists_passes_and_edges() -> None:
    data = json.loads(export(make(), "json"))
    assert [p["name"] for p in data["passes"]] == ["shadow", "raster", "trace", "combine"]
    assert {(e["from"], e["to"], e["resource"]) for e in data["edges"]} == {
        ("shadow", "raster", "texture Hybrid::sunDepth"),
        ("raster", "trace", "texture Hybrid::position"),
        ("raster", "combine", "texture Hybrid::color"),
        ("raster", "combine", "texture Hybrid::position"),
        ("trace", "combine", "texture Hybrid::radiance"),
    }


def test_programs_of_a_raytrace_pass_are_told() -> None:
    data = json.loads(export(make(), "json"))
    trace = next(p for p in data["passes"] if p["name"] == "trace")
    file = "programs/hybrid.py"
    assert trace["programs"][0] == {
        "kind": "ray generation",
        "file": file,
        "proc": "pinhole_camera",
    }
    glass = [p for p in trace["programs"] if p.get("material") == "Vidro"]
    assert {
        "kind": "closest hit",
        "ray": "Radiance",
        "material": "Vidro",
        "file": file,
        "proc": "glass",
    } in glass
    assert [p["name"] for p in data["passes"] if "programs" in p] == ["trace"]
    titles = [
        t.text or "" for t in etree.fromstring(export(make(), "svg").encode()).iter("{*}title")
    ]
    assert any("closest hit (Vidro, Radiance): glass of programs/hybrid.py" in t for t in titles)


def test_svg_is_well_formed_and_shows_every_pass() -> None:
    root = etree.fromstring(export(make(), "svg").encode())
    texts = [t.text for t in root.iter("{*}text")]
    for name in ("2  raster", "3  trace", "4  combine", "Hybrid::position", "window"):
        assert name in texts


def test_dot_and_mermaid_quote_names() -> None:
    assert '"Hybrid::position"' in export(make(), "dot")
    assert 'p2["trace (raytrace)"]' in export(make(), "mermaid")

"""The tutorial notebook runs, and its results show themselves."""

from __future__ import annotations

import ast
import io
import json
from typing import Any

import numpy as np
import pytest
from lxml import html
from PIL import Image

import nau_py
from tests.conftest import PROJECTS, ROOT, Folder, RayProject


def run_cells(path: Any) -> list[Any]:
    """The values of the last expressions of a notebook's code cells, run in order."""
    names: dict[str, Any] = {}
    found = []
    for cell in json.loads(path.read_text())["cells"]:
        if cell["cell_type"] != "code":
            continue
        tree = ast.parse("".join(cell["source"]))
        last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
        exec(compile(tree, str(path), "exec"), names)
        if isinstance(last, ast.Expr):
            found.append(eval(compile(ast.Expression(last.value), str(path), "eval"), names))
    return found


def test_the_tutorial_runs(
    monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory
) -> None:
    pytest.importorskip("matplotlib", reason="the extra [plot] is not installed")
    monkeypatch.chdir(ROOT)
    kept = tmp_path_factory.mktemp("references")
    monkeypatch.setattr("nau_py.accuracy.reference.make_cache_folder", lambda name: kept)
    shown = run_cells(ROOT / "docs" / "tutorial.ipynb")
    kinds = [type(value).__name__ for value in shown]
    assert kinds == ["Project", "Plan", "Frame", "float", "tuple", "list", "Frame", "CostRun"]
    for value in shown:
        if hasattr(value, "_repr_html_"):
            text = value._repr_html_()
            assert "http" not in text.replace("http://www.w3.org/2000/svg", "")
            assert html.fromstring(text) is not None
    assert 0.05 < shown[3] < 0.2
    assert ("refraction", "left_out", "nothing calls for it") in shown[5]
    front = Image.open(io.BytesIO(shown[-1]._repr_png_()))
    assert np.asarray(front).std() > 5


def test_a_frame_shows_its_picture(folder: Folder, ray_project: RayProject) -> None:
    """The PNG is the picture, to the bit."""
    folder.obj("scene", [("M", [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)])])
    folder.mtl("scene", {"M": {"Kd": "1 1 1"}})
    frame = nau_py.Renderer(ray_project()).render()
    frame.image = np.random.default_rng(1).integers(0, 256, (8, 9, 4), np.uint8)
    decoded = np.asarray(Image.open(io.BytesIO(frame._repr_png_())))
    np.testing.assert_array_equal(decoded, frame.image[..., :3])


def test_names_are_escaped(folder: Folder) -> None:
    text = (PROJECTS / "selective" / "project.xml").read_text()
    folder.write("project.xml", text.replace('name="combine" class', 'name="&lt;b&gt;" class'))
    project = folder.load()
    assert "<b>" not in project._repr_html_()
    assert "&lt;b&gt;" in project._repr_html_()
    assert "<b>" not in nau_py.plan(project)._repr_html_()

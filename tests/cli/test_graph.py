"""``nau-graph`` on the command line: formats, times, wrong use."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.cli.test_commands import SELECTIVE, call


def write_report(path: Path, pipeline: str = "Selective") -> Path:
    passes = [
        {"name": n, "status": "run", "ms": ms}
        for n, ms in (("shadow", 1.5), ("raster", 4), ("trace", 20), ("combine", 0.5))
    ]
    path.write_text(json.dumps({"frames": [{"pipeline": pipeline, "passes": passes}]}))
    return path


def test_times_give_the_critical_path(tmp_path: Path) -> None:
    report = write_report(tmp_path / "report.json")
    out = tmp_path / "graph.svg"
    done = call("nau-graph", SELECTIVE, "--times", str(report), "-o", str(out))
    assert done.returncode == 0, done.stderr
    assert done.stderr == (
        "critical path: shadow 1.5 ms → raster 4.0 ms → trace 20.0 ms → combine 0.5 ms = 26.0 ms "
        "of 26.0 ms\n"
    )
    assert "raytrace · 20.0 ms" in out.read_text()


def test_node_link_is_json_for_networkx() -> None:
    done = call("nau-graph", SELECTIVE, "--format", "node-link")
    data = json.loads(done.stdout)
    assert data["directed"] is True
    assert {n["id"] for n in data["nodes"]} >= {"pass trace", "texture Hybrid::radiance", "window"}


@pytest.mark.parametrize(
    "text, message",
    [
        (None, "cannot be read"),
        ("{", "is not JSON"),
        ("[1]", "is not a report of nau-run"),
        ('{"frames": []}', "has no frame of pipeline 'Selective'; its pipelines: none"),
    ],
)
def test_a_wrong_report_is_wrong_use(tmp_path: Path, text: str | None, message: str) -> None:
    path = tmp_path / "report.json"
    if text is not None:
        path.write_text(text)
    done = call("nau-graph", SELECTIVE, "--times", str(path), COLUMNS="300", TERM="dumb")
    assert done.returncode == 2
    assert message in done.stderr
    assert done.stdout == ""
    assert "Traceback" not in done.stderr

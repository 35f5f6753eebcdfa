"""State of the viewer as JSON data for the page."""

from __future__ import annotations

from typing import Any

from nau_py.api import plan
from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.diagnostics.errors import NauError
from nau_py.diagnostics.reporters import format_lines
from nau_py.model.effects import EFFECTS
from nau_py.run.renderer import DEFAULT_TIME_STEP
from nau_py.viewer.graph import graph_data
from nau_py.viewer.state import ViewerState


def picture_data(state: ViewerState) -> dict[str, Any]:
    """Return the figures of the picture, which change with every step."""
    with state.lock:
        step = state.picture
        if step is None:
            return {"pictures": 0}
        return {
            "pictures": state.pictures,
            "width": step.width,
            "height": step.height,
            "coarse": step.coarse,
            "steps": step.steps,
            "spp": step.spp,
            "error": step.error,
            "ms": step.ms,
            "frame": state.frame,
        }


def content_data(state: ViewerState) -> dict[str, Any]:
    """Return everything else that a window shows."""
    with state.lock:
        project, report = state.project, state.picture.report if state.picture else None
        effects = {
            "chosen": state.effects or "",
            "known": ["auto", "all", "none", *EFFECTS],
            "decisions": (report or {}).get("effects", []),
        }
        try:
            pose = [*map(float, state.pose().position), *map(float, state.pose().view)]
        except ValueError:
            pose = []
        found = dict.fromkeys([*state.render_diagnostics, *state.findings])
        return {
            "version": state.version,
            "full": state.full,
            "project": project.name,
            "file": str(state.path),
            "pipelines": [p.name for p in project.pipelines],
            "pipeline": state.pipeline,
            "sound": state.sound,
            "frame": state.frame,
            "step": DEFAULT_TIME_STEP,
            "playing": state.playing,
            "effects": effects,
            "controls": [
                c.data() | {"value": state.values.get(c.key, c.value), "file": c.value}
                for c in state.controls()
            ],
            "changed": sorted(state.values),
            "undo": len(state.undo),
            "diagnostics": [_diagnostic_data(state, d) for d in found],
            "note": state.note,
            "graph": _graph_data(state, report),
            "targets": state.picture.targets if state.picture else [],
            "pose": pose,
            "rendering": state.sound and not state.failed,
        }


def _diagnostic_data(state: ViewerState, diagnostic: Diagnostic) -> dict[str, Any]:
    lines = format_lines(diagnostic, state.sources)
    return {
        "rule": diagnostic.rule,
        "severity": str(diagnostic.severity),
        "place": str(diagnostic.location) if diagnostic.location.file else "",
        "message": diagnostic.message,
        "source": lines[1:],
    }


def _graph_data(state: ViewerState, report: dict[str, Any] | None) -> dict[str, Any]:
    try:
        return graph_data(plan(state.project, state.pipeline), report)
    except NauError:
        return {"passes": [], "targets": []}

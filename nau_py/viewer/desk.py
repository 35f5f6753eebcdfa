"""What every window of the viewer sees, and the commands that change it."""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np

from nau_py.api import lint, load, plan
from nau_py.diagnostics.diagnostic import Diagnostic, Severity
from nau_py.diagnostics.errors import NauError
from nau_py.diagnostics.reporters import format_lines
from nau_py.model.effects import EFFECTS
from nau_py.model.effects import wanted as effects_wanted
from nau_py.model.linked import Project
from nau_py.model.pipeline import Pipeline
from nau_py.model.project import ProjectFile
from nau_py.model.values import Scalar
from nau_py.process.paths import forget_folders
from nau_py.run.reload import Stamp, stamp
from nau_py.run.renderer import DEFAULT_TIME_STEP
from nau_py.run.used_files import used_files
from nau_py.viewer import orbit
from nau_py.viewer.camera import aims_from_position, camera_node, camera_with
from nau_py.viewer.controls import Control, Values, controls, key_of, model_material
from nau_py.viewer.graph import EMPTY_GRAPH, graph_data
from nau_py.viewer.save import save_edits
from nau_py.viewer.studio import Facts, Shown, Wanted

MOST_UNDO = 200


class Desk:
    """The state of a viewer. ``changed`` is called, by any thread, when there is something new.
    ``size``: the window's (width, height), in the place of the project's."""

    def __init__(self, path: Path, size: tuple[int, int] | None = None) -> None:
        self.path = path.resolve()
        self.size = size
        self.changed: Callable[[], None] = lambda: None
        self.lock = threading.RLock()
        self.project = Project(self.path, ProjectFile())
        self.sources: dict[str, str] = {}
        """Texts of the files as they were read last, for the excerpts of findings."""
        self.pipeline = ""
        self.frame = 0
        self.playing = False
        self.effects: str | None = None
        self.values: Values = {}
        """What was changed and is not saved."""
        self.undo: list[Values] = []
        """What each change has replaced, the last one last. Saving leaves it as it is."""
        self.findings: list[Diagnostic] = []
        self.wrong: list[Diagnostic] = []
        """What the renderer found wrong, beside lint."""
        self.note = ""
        self.picture: Shown | None = None
        self.facts: Facts | None = None
        self.version, self.pictures, self.full, self.attempt = 0, 0, 0, 0
        """Counts: changes of what windows see, pictures, first ones of full size, and states of
        the files."""
        self.failed = self.saved = False
        """Whether the last picture failed; whether a save has changed the renderer's files."""
        self.moved = 0.0
        """When something was changed last (monotonic clock)."""
        self._distance: float | None = None
        self._stamps: dict[Path, Stamp] = {}
        self._kinds: dict[Path, str] = {}
        self.reload()

    def reload(self) -> None:
        """Read the project again. A wrong one is told, the last sound one stays. What was changed
        stays changed, where it still exists."""
        forget_folders()
        project = load(self.path)
        found = lint(project)
        with self.lock:
            self.findings, self.sources = found, project.sources
            if self.sound or not self.project.file.tag:
                self.project = project
                if project.pipeline(self.pipeline) is None:
                    default = project.default_pipeline
                    self.pipeline = (default.name if default else None) or ""
                known = {c.key for c in self.controls()}
                self.values = {k: v for k, v in self.values.items() if k in known}
            kinds = used_files(project)
            self._kinds = self._kinds | kinds if not self.sound else kinds
            self._stamps = {p: self._stamps.get(p, stamp(p)) for p in self._kinds}
        self.news()

    @property
    def sound(self) -> bool:
        """Whether the project can be run."""
        return not any(d.severity is Severity.ERROR for d in self.findings)

    def look(self) -> dict[str, str]:
        """The files that have changed since the last look: path to kind."""
        found = {p: k for p, k in self._kinds.items() if stamp(p) != self._stamps[p]}
        for path in found:
            self._stamps[path] = stamp(path)
        return {str(p): k for p, k in found.items()}

    def stale(self) -> bool:
        """Whether :meth:`look` would find something."""
        return any(stamp(p) != known for p, known in list(self._stamps.items()))

    def wanted(self) -> Wanted:
        values = tuple(sorted(self.values.items()))
        return Wanted(self.pipeline, self.frame, values, self.effects, self.size)

    def controls(self) -> list[Control]:
        pipeline = self.project.pipeline(self.pipeline) or Pipeline()
        found = controls(self.project, pipeline)
        for name, colours in (self.facts.materials if self.facts else {}).items():
            found += model_material(self.project, name, colours)
        return found

    def _value(self, key: str) -> tuple[Scalar, ...] | None:
        if key in self.values:
            return self.values[key]
        return next((c.value for c in self.controls() if c.key == key), None)

    def do(self, command: dict[str, Any]) -> None:
        """Carry out what a window asks. Raises :class:`ValueError` that says what is wrong."""
        name = command.get("do")
        method = getattr(self, f"_do_{name}", None)
        if not isinstance(name, str) or method is None:
            raise ValueError(f"there is no command '{name}'")
        try:
            with self.lock:
                method(command)
        except (KeyError, TypeError, OverflowError) as problem:
            raise ValueError(f"command '{name}': {problem}") from None
        self.news()

    def _do_set(self, command: dict[str, Any]) -> None:
        key, parts = str(command["key"]), command["value"]
        control = next((c for c in self.controls() if c.key == key), None)
        if control is None:
            raise ValueError(f"there is nothing called '{key}' to set")
        self._change({key: checked(control, parts)}, bool(command.get("more")))

    def _change(self, values: Values, more: bool = False) -> None:
        """Change values; ``more``: they belong to the change before, one step of undo."""
        plain = {c.key: c.value for c in self.controls()}
        before = {key: self.values.get(key, plain[key]) for key in values}
        if more and self.undo:
            self.undo[-1] = before | self.undo[-1]
        else:
            self.undo.append(before)
            del self.undo[:-MOST_UNDO]
        self._put_values(values, plain)

    def _put_values(self, values: Values, plain: Values) -> None:
        """Set values; those that the files have are no changes."""
        self.values = {k: v for k, v in (self.values | values).items() if plain.get(k) != v}
        self.moved = monotonic()

    def _do_undo(self, _: dict[str, Any]) -> None:
        if not self.undo:
            raise ValueError("there is nothing to undo")
        plain = {c.key: c.value for c in self.controls()}
        before = {k: v for k, v in self.undo.pop().items() if k in plain}
        self._put_values(before, plain)

    def _do_move(self, command: dict[str, Any]) -> None:
        """Move the camera: ``how`` is orbit, look, pan, dolly or fly, ``by`` its numbers."""
        moves: dict[str, Callable[..., orbit.Pose]] = {
            "orbit": orbit.orbit,
            "look": orbit.look,
            "pan": orbit.pan,
            "dolly": orbit.dolly,
            "fly": orbit.fly,
        }
        how, by = command["how"], [float(v) for v in command["by"]]
        if how not in moves or not all(np.isfinite(by)):
            raise ValueError(f"a camera cannot '{how}' by {by}")
        pose = self.pose()
        if how == "fly":
            by = [v * self.extent() for v in by]
        self._put(moves[how](pose, *by), bool(command.get("more")))

    def camera(self) -> str:
        """The name of the camera that moves: the pipeline's, or that of its first pass."""
        pipeline = self.project.pipeline(self.pipeline)
        if pipeline is None:
            raise ValueError("there is no pipeline")
        known = [c.name for c in self.project.assets.cameras]
        named = [pipeline.defaultCamera, *(p.camera_name for p in reversed(pipeline.passes))]
        found = next((n for n in named if n and n in known), None)
        if found is None:
            raise ValueError(f"pipeline '{self.pipeline}' names no camera of the project")
        return found

    def pose(self) -> orbit.Pose:
        """Where the camera is. Raises :class:`ValueError` where the pipeline names none."""
        name = self.camera()
        state = camera_with(self.project, name, self.values)
        node = camera_node(self.project, name)
        assert state is not None  # camera() has found it
        assert node is not None
        distance = self._distance
        if "LOOK_AT_POINT" in node.settings:
            distance = float(np.linalg.norm(state.view))
        return orbit.pose(state.position, state.view, state.up, distance or self.extent() / 2)

    def extent(self) -> float:
        """The length of the scene's diagonal, world units."""
        if self.facts is None:
            return 10.0
        return float(np.linalg.norm(np.subtract(self.facts.high, self.facts.low))) or 1.0

    def _put(self, pose: orbit.Pose, more: bool) -> None:
        name = self.camera()
        self._distance = pose.distance
        node = camera_node(self.project, name)
        aim, target = "VIEW", pose.view
        if node is not None and "LOOK_AT_POINT" in node.settings:
            aim = "LOOK_AT_POINT"
            target = pose.pivot if aims_from_position(node) else pose.view * pose.distance
        changed: Values = {}
        for component, vector in (("POSITION", pose.position), (aim, target)):
            key = key_of("CAMERA", name, component)
            before = self._value(key) or ()
            changed[key] = (*_rounded(vector), *before[3:])
        self._change(changed, more)

    def _do_pipeline(self, command: dict[str, Any]) -> None:
        if self.project.pipeline(command["name"]) is None:
            raise ValueError(f"there is no pipeline '{command['name']}'")
        self.pipeline, self.frame = command["name"], 0

    def _do_frame(self, command: dict[str, Any]) -> None:
        self.frame = max(int(command["index"]), 0)

    def _do_play(self, command: dict[str, Any]) -> None:
        self.playing = bool(command["on"])

    def _do_effects(self, command: dict[str, Any]) -> None:
        text = str(command.get("value") or "").strip()
        if text:
            effects_wanted(text)
        self.effects = text or None

    def _do_retry(self, _: dict[str, Any]) -> None:
        self.attempt += 1
        self.wrong, self.note = [], ""

    def _do_save(self, _: dict[str, Any]) -> None:
        """Write what was changed into the files of the project."""
        try:
            files, left = save_edits(self.project, self.values)
            for path, (document, _edits) in files.items():
                if document.text != self.project.sources.get(str(path)):
                    raise ValueError(f"not saved: '{path.name}' has changed on disk meanwhile")
            for path, (document, edits) in files.items():
                document.write(path, edits)
        except OSError as problem:
            why = problem.strerror or str(problem)
            raise ValueError(f"not saved: '{problem.filename}' cannot be written: {why}") from None
        names = ", ".join(sorted(p.name for p in files))
        self.reload()
        self.values = {k: v for k, v in self.values.items() if k in left}
        self._stamps = {p: stamp(p) for p in self._kinds}
        self.note = f"saved into {names}" if files else "there is nothing that a file holds"
        if left:
            held = ", ".join(f"'{k}'" for k in left)
            self.note += f"; no file of the project holds {held}"
        self.saved = True

    def news(self, content: bool = True) -> None:
        with self.lock:
            self.version += content
        self.changed()

    def glance(self) -> dict[str, Any]:
        """The picture's figures: what changes with every step."""
        with self.lock:
            shown = self.picture
            if shown is None:
                return {"pictures": 0}
            return {
                "pictures": self.pictures,
                "width": shown.width,
                "height": shown.height,
                "coarse": shown.coarse,
                "steps": shown.steps,
                "spp": shown.spp,
                "error": shown.error,
                "ms": shown.ms,
                "frame": self.frame,
            }

    def content(self) -> dict[str, Any]:
        """Everything else that a window shows."""
        with self.lock:
            project, report = self.project, self.picture.report if self.picture else None
            effects = {
                "chosen": self.effects or "",
                "known": ["auto", "all", "none", *EFFECTS],
                "decisions": (report or {}).get("effects", []),
            }
            try:
                pose = [*map(float, self.pose().position), *map(float, self.pose().view)]
            except ValueError:
                pose = []
            return {
                "version": self.version,
                "full": self.full,
                "project": project.name,
                "file": str(self.path),
                "pipelines": [p.name for p in project.pipelines],
                "pipeline": self.pipeline,
                "sound": self.sound,
                "frame": self.frame,
                "step": DEFAULT_TIME_STEP,
                "playing": self.playing,
                "effects": effects,
                "controls": [
                    c.data() | {"value": self.values.get(c.key, c.value), "file": c.value}
                    for c in self.controls()
                ],
                "changed": sorted(self.values),
                "undo": len(self.undo),
                "diagnostics": [self._told(d) for d in self._all()],
                "note": self.note,
                "graph": self._graph(report),
                "targets": self.picture.targets if self.picture else [],
                "pose": pose,
                "rendering": self.sound and not self.failed,
            }

    def _all(self) -> list[Diagnostic]:
        return list(dict.fromkeys([*self.wrong, *self.findings]))

    def _told(self, diagnostic: Diagnostic) -> dict[str, Any]:
        lines = format_lines(diagnostic, self.sources)
        return {
            "rule": diagnostic.rule,
            "severity": str(diagnostic.severity),
            "place": str(diagnostic.location) if diagnostic.location.file else "",
            "message": diagnostic.message,
            "source": lines[1:],
        }

    def _graph(self, report: dict[str, Any] | None) -> dict[str, Any]:
        try:
            return graph_data(plan(self.project, self.pipeline), report)
        except NauError:
            return EMPTY_GRAPH


def _rounded(vector: orbit.F64) -> tuple[float, ...]:
    return tuple(round(float(v), 5) for v in vector)


def checked(control: Control, parts: Any) -> tuple[Scalar, ...]:
    """A value for a control. Raises :class:`ValueError` that says what is legal."""
    listed = list(parts) if isinstance(parts, list | tuple) else [parts]
    if len(listed) != len(control.value):
        raise ValueError(f"{control.label} takes {len(control.value)} values, not {len(listed)}")
    if control.kind == "choice":
        if listed[0] not in control.choices:
            raise ValueError(f"{control.label} is one of {', '.join(control.choices)}")
        return (str(listed[0]),)
    if control.kind == "flag":
        return (bool(listed[0]),)
    found: list[Scalar] = []
    for part in listed:
        number = float(part)
        if not np.isfinite(number):
            raise ValueError(f"{control.label}: {part} is not finite")
        low, high = control.minimum, control.maximum
        if (low is not None and number < low) or (high is not None and number > high):
            least = "" if low is None else f" from {low:g}"
            most = "" if high is None else f" to {high:g}"
            raise ValueError(f"{control.label} is {number:g}; legal is{least}{most}")
        found.append(int(number) if control.kind == "whole" else number)
    return tuple(found)

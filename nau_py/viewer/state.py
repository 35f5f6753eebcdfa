"""State of the viewer that every window shares, and the commands that change it."""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np

from nau_py.api import lint, load
from nau_py.diagnostics.diagnostic import Diagnostic, Severity
from nau_py.model.effects import parse_effects
from nau_py.model.linked import Project
from nau_py.model.pipeline import Pipeline
from nau_py.model.project import ProjectFile
from nau_py.model.values import Scalar
from nau_py.process.file_watch import FileWatch
from nau_py.process.paths import forget_folders
from nau_py.run.used_files import used_files
from nau_py.viewer import orbit
from nau_py.viewer.camera import aims_from_position, camera_node, camera_with
from nau_py.viewer.controls import Control, Values, check_value, controls, key_of, model_material
from nau_py.viewer.request import PictureRequest, PictureStep, SceneSummary
from nau_py.viewer.save import save_edits

MOST_UNDO = 200
"""Steps of undo that are kept."""


class ViewerState:
    """Project, changed values and last picture of a viewer.

    ``changed`` is called, by any thread, after every change. ``size``: the window's (width,
    height) instead of the project's.
    """

    def __init__(self, path: Path, size: tuple[int, int] | None = None) -> None:
        self.path = path.resolve()
        self.size = size
        self.changed: Callable[[], None] = lambda: None
        self.lock = threading.RLock()
        self.project = Project(self.path, ProjectFile())
        self.sources: dict[str, str] = {}
        """Texts of the files as last read, for the excerpts of diagnostics."""
        self.pipeline = ""
        self.frame = 0
        self.playing = False
        self.effects: str | None = None
        self.values: Values = {}
        """Changed values that are not saved."""
        self.undo: list[Values] = []
        """Values before each change, the last one last. Saving keeps them."""
        self.findings: list[Diagnostic] = []
        self.render_diagnostics: list[Diagnostic] = []
        """Diagnostics of the renderer; lint's are in ``findings``."""
        self.note = ""
        self.picture: PictureStep | None = None
        self.scene: SceneSummary | None = None
        self.version, self.pictures, self.full, self.attempt = 0, 0, 0, 0
        """Counts: changes that windows show, pictures, first ones of full size, states of the
        files."""
        self.failed = self.saved = False
        """True if the last picture failed; True after a save changed the worker's files."""
        self.moved = 0.0
        """Time of the last change (monotonic clock)."""
        self._distance: float | None = None
        self.watch = FileWatch()
        self.reload()

    def reload(self) -> None:
        """Read the project again; keep the last sound one if it has errors. Changed values of
        controls that still exist stay changed."""
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
            self.watch.follow(kinds if self.sound else self.watch.kinds | kinds)
        self.announce()

    @property
    def sound(self) -> bool:
        """True if the project can be run."""
        return not any(d.severity is Severity.ERROR for d in self.findings)

    def picture_request(self) -> PictureRequest:
        """Return the request of the present picture."""
        values = tuple(sorted(self.values.items()))
        return PictureRequest(self.pipeline, self.frame, values, self.effects, self.size)

    def controls(self) -> list[Control]:
        pipeline = self.project.pipeline(self.pipeline) or Pipeline()
        found = controls(self.project, pipeline)
        for name, colours in (self.scene.materials if self.scene else {}).items():
            found += model_material(self.project, name, colours)
        return found

    def _value(self, key: str) -> tuple[Scalar, ...] | None:
        if key in self.values:
            return self.values[key]
        return next((c.value for c in self.controls() if c.key == key), None)

    def do(self, command: dict[str, Any]) -> None:
        """Carry out a command of a window. Raises :class:`ValueError` with the reason."""
        name = command.get("do")
        method = getattr(self, f"_do_{name}", None)
        if not isinstance(name, str) or method is None:
            raise ValueError(f"there is no command '{name}'")
        try:
            with self.lock:
                method(command)
        except (KeyError, TypeError, OverflowError) as problem:
            raise ValueError(f"command '{name}': {problem}") from None
        self.announce()

    def _do_set(self, command: dict[str, Any]) -> None:
        key, parts = str(command["key"]), command["value"]
        control = next((c for c in self.controls() if c.key == key), None)
        if control is None:
            raise ValueError(f"there is nothing called '{key}' to set")
        self._change({key: check_value(control, parts)}, bool(command.get("more")))

    def _change(self, values: Values, more: bool = False) -> None:
        """Change values; ``more``: undo them together with the change before."""
        plain = {c.key: c.value for c in self.controls()}
        before = {key: self.values.get(key, plain[key]) for key in values}
        if more and self.undo:
            self.undo[-1] = before | self.undo[-1]
        else:
            self.undo.append(before)
            del self.undo[:-MOST_UNDO]
        self._put_values(values, plain)

    def _put_values(self, values: Values, plain: Values) -> None:
        """Set values; a value that equals the file's is no change."""
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
        """Return the name of the camera that moves: the pipeline's, or that of its first pass."""
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
        """Return the pose of the camera. Raises :class:`ValueError` if the pipeline names none."""
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
        """Return the length of the scene's diagonal, world units."""
        if self.scene is None:
            return 10.0
        return float(np.linalg.norm(np.subtract(self.scene.high, self.scene.low))) or 1.0

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
            parse_effects(text)
        self.effects = text or None

    def _do_retry(self, _: dict[str, Any]) -> None:
        self.attempt += 1
        self.render_diagnostics, self.note = [], ""

    def _do_save(self, _: dict[str, Any]) -> None:
        """Write the changed values into the files of the project."""
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
        self.watch.accept()
        self.note = f"saved into {names}" if files else "there is nothing that a file holds"
        if left:
            held = ", ".join(f"'{k}'" for k in left)
            self.note += f"; no file of the project holds {held}"
        self.saved = True

    def announce(self, content: bool = True) -> None:
        """Call ``changed``. ``content``: more than the picture has changed."""
        with self.lock:
            self.version += content
        self.changed()


def _rounded(vector: orbit.F64) -> tuple[float, ...]:
    return tuple(round(float(v), 5) for v in vector)

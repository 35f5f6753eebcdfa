"""The renderer: session, active pipeline, and frames as arrays."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.diagnostics.diagnostic import Diagnostic, Severity, error, warning
from nau_py.diagnostics.errors import ProjectError
from nau_py.graph.plan import Plan, make_plan
from nau_py.graph.resource import WINDOW
from nau_py.model.linked import Project
from nau_py.model.pipeline import Pipeline
from nau_py.model.values import Scalar
from nau_py.passes import pass_classes
from nau_py.passes.frame import (
    FrameContext,
    Progress,
    RunOptions,
    Session,
    no_progress,
)
from nau_py.passes.report import PassRecord
from nau_py.rules.engine import lint
from nau_py.run.active_pipeline import ActivePipeline
from nau_py.run.capture import read_image, read_targets, read_window
from nau_py.run.findings import add_new
from nau_py.run.frame import Frame
from nau_py.run.frame_loop import FrameLoop, leave_out
from nau_py.run.parameters import parse
from nau_py.run.report import machine_facts, make_report
from nau_py.run.scripts import Scripts, hooks
from nau_py.scene.names import list_default_materials
from nau_py.scene.world import World

DEFAULT_TIME_STEP = 0.02
"""Seconds of simulated time from one frame to the next."""


class Renderer:
    """Renders frames of a pipeline, or of several one after another, as in Nau's mode ``RUN_ALL``.

    ``pipeline``: the one to draw; by default the project's and, once that ends, those
    after it. ``size`` overrides the window (width, height), pixels. ``keep_targets`` runs every
    pass that writes something, so that all targets can be read. ``parameters``: values, as text,
    of what the project's interface offers, by name. Raises
    :class:`~nau_py.ProjectError` for a project with lint errors,
    :class:`~nau_py.DeviceError` without OpenGL.
    """

    def __init__(
        self,
        project: Project,
        pipeline: str | None = None,
        *,
        size: tuple[int, int] | None = None,
        options: RunOptions | None = None,
        time_step: float = DEFAULT_TIME_STEP,
        keep_targets: bool = False,
        progress: Progress = no_progress,
        parameters: Mapping[str, str] | None = None,
    ) -> None:
        if hooks(project) or parameters:  # both write into the project: not into the caller's
            project = copy.deepcopy(project)
        self._parameters = [parse(project, k, v) for k, v in (parameters or {}).items()]
        self.project = project
        self.diagnostics: list[Diagnostic] = lint(
            project, pass_classes(), list_default_materials(project)
        )
        errors = [d for d in self.diagnostics if d.severity is Severity.ERROR]
        if errors:
            raise ProjectError(errors)
        self._active = ActivePipeline(project, pipeline)
        self._everything = keep_targets
        self._make_plan()
        self.time_step = time_step
        self._size = size or project.size
        self._options = options or RunOptions()
        self._progress = progress
        self._session: Session | None = None
        self._scripts: Scripts | None = None
        self._next = 0
        self._overrides: dict[tuple[str, str, str, int], Sequence[Scalar]] = {}
        self._setup_ms = 0.0
        self.capture_ms = 0.0
        """Milliseconds that reading the last frame's targets took."""

    @property
    def pipeline(self) -> Pipeline:
        """The active pipeline."""
        return self._active.pipeline

    @property
    def ended(self) -> bool:
        """True once the last pipeline has ended: further frames draw nothing."""
        return self._active.ended

    def _make_plan(self) -> None:
        self.plan: Plan = make_plan(
            self.project, self.pipeline, pass_classes(), everything=self._everything
        )
        self._refuse_unsupported()

    def _refuse_unsupported(self) -> None:
        known = pass_classes()
        errors = [
            error(
                "P002",
                pass_.where("class"),
                f"pass '{pass_.name}': class '{pass_.pass_class}' {_lacking(pass_.pass_class)}, so "
                f"pipeline '{self.pipeline.name}' does not run",
            )
            for pass_ in self.pipeline.passes
            if pass_.pass_class not in known
        ]
        if errors:
            raise ProjectError(errors)

    @property
    def scripts(self) -> Scripts:
        """The Lua scripts of the project, loaded at the first frame."""
        if self._scripts is None:
            self._scripts = Scripts(self.project)
            add_new(self.diagnostics, self._scripts.diagnostics)
        return self._scripts

    @property
    def session(self) -> Session:
        """World, GPU resources and state of the passes, made at the first frame."""
        if self._session is None:
            start = perf_counter()
            self._session = self._open()
            self._set_parameters(self._session)
            self._setup_ms = (perf_counter() - start) * 1000
        return self._session

    def _open(self) -> Session:
        from nau_py.raster.device import get_device
        from nau_py.raster.resources import Resources

        world = World(self.project, self._size)
        errors = [d for d in world.diagnostics if d.severity is Severity.ERROR]
        if errors:
            raise ProjectError(errors)
        add_new(self.diagnostics, world.diagnostics)
        resources = Resources(get_device(), self.project, self._size, self._options.window_format)
        name = self.pipeline.name or ""
        return Session(self.project, name, world, resources, self._options, progress=self._progress)

    def _set_parameters(self, session: Session) -> None:
        """Set the parameters, and the attributes of :meth:`set_attribute`, in a new session."""
        for parameter, values in self._parameters if self.plan.steps else []:
            node = parameter.node
            where = (node.type or "", node.context or "CURRENT", node.component or "", node.id or 0)
            try:
                self._set(session, where, values)
            except ValueError as problem:
                message = f"parameter '{parameter.name}' cannot be set: {problem}"
                raise ProjectError(error("R020", node.location, message)) from None
        for where, override in self._overrides.items():
            self._set(session, where, override)

    def _set(
        self, session: Session, where: tuple[str, str, str, int], values: Sequence[Scalar]
    ) -> None:
        session.reset_view()
        frame = FrameContext(session, session.first_frame, 0.0)
        self.scripts.attributes.set(frame, self.plan.steps[0].pass_, *where, values)
        if where[0] == "COLOR":
            session.materials.clear()  # those of the passes are copies

    def set_attribute(
        self, type: str, context: str, component: str, values: Sequence[Scalar], index: int = 0
    ) -> None:
        """Set an attribute of the running project from the next frame on, and in every session that
        follows: ``set_attribute("LIGHT", "Sun", "COLOR", (1, 0.9, 0.8, 1))``.

        ``type``, ``component``: docs/reference.md, attribute sets; ``context``: the object's name,
        ``lib::name`` of a material, ``pipeline#pass`` of a pass. ``index``: of a light or unit.
        Raises ValueError where there is no such attribute or object. :meth:`close` restores the
        project.
        """
        where = (type, context, component, index)
        if self.plan.steps:
            self._set(self.session, where, values)
        self._overrides[where] = tuple(values)

    def render(self, frame: int = 0) -> Frame:
        """Render up to and including ``frame`` (from 0) and return it.

        Frames build on each other: going back starts again from frame 0.
        Raises :class:`~nau_py.NauError` for failures while running.
        """
        if frame < 0:
            raise ValueError(f"frame {frame}: frames are counted from 0")
        if frame < self._next:
            self.close()
        records: list[PassRecord] = []
        start = perf_counter()
        _ = self.session  # loading is not part of a frame's time
        while self._next <= frame:
            start = perf_counter()
            records = self._draw(self._next)
            self._next += 1
        return self._finish(frame, start, records)

    def again(self, seed: int | None = None) -> Frame:
        """Render the frame of the last :meth:`render` once more, with random numbers of ``seed``.

        Nothing else changes, except that a pass which reads the frame before now reads this one.
        """
        if self._next == 0:
            raise ValueError("no frame has been rendered yet")
        if seed is not None:
            self.session.options = replace(self._options, seed=seed)
        start = perf_counter()
        records = self._draw(self._next - 1)
        return self._finish(self._next - 1, start, records)

    def _finish(self, frame: int, start: float, records: list[PassRecord]) -> Frame:
        before = perf_counter()
        image, targets = self._capture()
        self.capture_ms = (perf_counter() - before) * 1000
        ms = (perf_counter() - start) * 1000
        report = make_report(
            self.project,
            self.pipeline.name or "",
            machine_facts(self.session),
            self.diagnostics,
            [(frame, ms, records)],
            self._setup_ms,
        )
        if self.ended:
            report["ended"] = self._active.reason
        traced = [r.report for r in records if r.report.samples is not None]
        if not traced:
            return Frame(frame, image, targets, report)
        samples, wrong = traced[-1].samples, traced[-1].error
        assert samples is not None
        assert wrong is not None
        return Frame(frame, image, targets, report, samples[::-1], wrong[::-1])

    def move(self, name: str, matrix: NDArray[Any]) -> None:
        """Move the objects called ``name`` from the next frame on.

        ``matrix``: object to world, (4, 4), column vectors. :meth:`close`, and going back to an
        earlier frame, undo it. Raises ValueError for an unknown name.
        """
        self.session.world.move(name, matrix)

    def reload_shaders(self, files: set[Path]) -> None:
        """Compile the GLSL programs of ``files`` (resolved paths) again, for the next frame.
        Raises :class:`~nau_py.ShaderError`; all programs then stay in use."""
        self.session.resources.reload_programs(files)
        for state in self.session.states:
            state.reload_shaders(files)

    def reload_ray_programs(self) -> None:
        """Load the ray programs again, for the next frame. Raises
        :class:`~nau_py.ProgramError`; the programs of that pass then stay in use."""
        for state in self.session.states:
            state.reload_programs()

    def close(self) -> None:
        """Free the GPU objects. Rendering again starts from frame 0."""
        if self._session is not None:
            self._session.states.close()
            self._session.resources.release()
        if self._scripts is not None:
            self._scripts.attributes.restore()
        self._session, self._scripts, self._next = None, None, 0
        self._active.restart()
        self._make_plan()

    def _draw(self, index: int) -> list[PassRecord]:
        """Run the active pipeline for frame ``index`` of the session."""
        session, active = self.session, self._active
        if active.ended:
            return leave_out(self.plan, active.reason)
        if active.advance():
            self._make_plan()
            session.start_pipeline(self.pipeline.name or "", index)
        session.resources.clear_buffers_by_frame()
        session.world.events.frame(index * self.time_step)
        session.reset_view()
        frame = FrameContext(session, index, index * self.time_step * 1000.0)
        loop = FrameLoop(self.plan, self.pipeline, self.scripts, self.diagnostics)
        records, reason = loop.run_frame(frame)
        if reason:
            active.end(reason)
        if active.is_last_frame(frame.index):
            active.end(f"it has drawn its {self.pipeline.frameCount} frames")
        if active.over and self.plan.steps:
            self.scripts.call(self.pipeline.postScript, frame, self.plan.steps[0].pass_)
        add_new(self.diagnostics, self.scripts.diagnostics)
        return records

    def _capture(self) -> tuple[NDArray[Any], dict[str, NDArray[Any]]]:
        resources = self.session.resources
        targets = read_targets(self.plan, resources)
        image = read_image(self.plan, resources, targets)
        if image is not None:
            return image, targets
        message = (
            f"pipeline '{self.pipeline.name}' draws no picture: no pass of it draws into the "
            "window or into a two-dimensional texture"
        )
        add_new(self.diagnostics, [warning("E003", self.pipeline.location, message)])
        if self.plan.output == WINDOW:
            return read_window(resources), targets
        width, height = self._size
        return np.zeros((height, width, 4), np.uint8), targets


def _lacking(class_: str) -> str:
    """Return why passes of a class do not run."""
    if class_ == "mesh":
        return "is not supported: it needs the OpenGL extension GL_NV_mesh_shader"
    return "is not supported by this version"

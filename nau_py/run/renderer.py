"""Running a pipeline: the session, the frame loop, and frames as arrays."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.diagnostics.diagnostic import Diagnostic, Severity, error, warning
from nau_py.diagnostics.errors import NauError, ProjectError
from nau_py.graph.plan import Plan, Step, make_plan
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
from nau_py.passes.report import PassRecord, PassReport
from nau_py.reporting.notebook import frame_html
from nau_py.reporting.output import png
from nau_py.rules.engine import lint
from nau_py.run.active_pipeline import Turns
from nau_py.run.parameters import parse
from nau_py.run.report import machine_facts, make_report
from nau_py.run.scripts import MAX_REPEATS, Scripts, hooks
from nau_py.scene.names import default_material_names
from nau_py.scene.world import World

DEFAULT_TIME_STEP = 0.02
"""Seconds of simulated time from one frame to the next."""


@dataclass(slots=True)
class Frame:
    """One finished frame.

    ``image``: the picture, uint8 (height, width, 4), row 0 at the top; float32 where a pipeline
    without a window pass ends in a float target. ``targets``: every texture that a pass writes,
    by qualified name, (height, width, channels), row 0 at the top, native dtype.
    ``report``: what the frame cost; the schema is in docs/report.md. ``samples`` and ``error``: of
    each pixel of the raytrace pass's target, the samples taken, int32, and the estimated standard
    error of its colour, root mean square over RGB, float32, (height, width), row 0 at the top;
    None where nothing was traced.
    """

    index: int
    image: NDArray[Any]
    targets: dict[str, NDArray[Any]]
    report: dict[str, Any]
    samples: NDArray[np.int32] | None = None
    error: NDArray[np.float32] | None = None

    def _repr_png_(self) -> bytes:
        """The picture, for notebooks."""
        return png(self.image)

    def _repr_html_(self) -> str:
        """The picture and what each pass cost, for notebooks."""
        return frame_html(self.image, self.report)


class Renderer:
    """Renders frames of a pipeline, or of those that take turns in Nau's mode ``RUN_ALL``.

    ``pipeline``: the one to draw; without it the project's default and, once that ends, those
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
            project, pass_classes(), default_material_names(project)
        )
        errors = [d for d in self.diagnostics if d.severity is Severity.ERROR]
        if errors:
            raise ProjectError(errors)
        self._turns = Turns(project, pipeline)
        self._everything = keep_targets
        self._plan_turn()
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
        """The pipeline that draws."""
        return self._turns.pipeline

    @property
    def ended(self) -> bool:
        """Whether the last pipeline has ended: further frames draw nothing."""
        return self._turns.ended

    def _plan_turn(self) -> None:
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
        """The project's Lua scripts, loaded at the first frame."""
        if self._scripts is None:
            self._scripts = Scripts(self.project)
            self._note(self._scripts.diagnostics)
        return self._scripts

    @property
    def session(self) -> Session:
        """World and GPU resources, made at the first frame."""
        if self._session is None:
            start = perf_counter()
            self._session = self._open()
            self._set_parameters(self._session)
            self._setup_ms = (perf_counter() - start) * 1000
        return self._session

    def _open(self) -> Session:
        from nau_py.raster.device import device
        from nau_py.raster.resources import Resources

        world = World(self.project, self._size)
        errors = [d for d in world.diagnostics if d.severity is Severity.ERROR]
        if errors:
            raise ProjectError(errors)
        self._note(world.diagnostics)
        resources = Resources(device(), self.project, self._size, self._options.window_format)
        return Session(
            self.project,
            self.pipeline.name or "",
            world,
            resources,
            self._options,
            progress=self._progress,
        )

    def _set_parameters(self, session: Session) -> None:
        """What a session starts with: the parameters, and what :meth:`set_attribute` said."""
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
        Raises ValueError where there is no such attribute or object. :meth:`close` puts back what
        stands in the project itself.
        """
        where = (type, context, component, index)
        if self.plan.steps:
            self._set(self.session, where, values)
        self._overrides[where] = tuple(values)

    def render(self, frame: int = 0) -> Frame:
        """Render up to and including ``frame`` (from 0) and return it.

        Frames build on each other: going back starts again from frame 0.
        Raises :class:`~nau_py.NauError` for what fails while running.
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
            records = self._step(self._next)
            self._next += 1
        return self._finished(frame, start, records)

    def again(self, seed: int | None = None) -> Frame:
        """Render the frame of the last :meth:`render` once more, with random numbers of ``seed``.

        Nothing else changes, but what a pass reads of the frame before is now this frame's.
        """
        if self._next == 0:
            raise ValueError("no frame has been rendered yet")
        if seed is not None:
            self.session.options = replace(self._options, seed=seed)
        start = perf_counter()
        records = self._step(self._next - 1)
        return self._finished(self._next - 1, start, records)

    def _finished(self, frame: int, start: float, records: list[PassRecord]) -> Frame:
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
            report["ended"] = self._turns.why
        traced = [r.report for r in records if r.report.samples is not None]
        if not traced:
            return Frame(frame, image, targets, report)
        samples, wrong = traced[-1].samples, traced[-1].error
        assert samples is not None
        assert wrong is not None
        return Frame(frame, image, targets, report, samples[::-1], wrong[::-1])

    def move(self, name: str, matrix: NDArray[Any]) -> None:
        """Put the objects called ``name`` elsewhere from the next frame on.

        ``matrix``: object to world, (4, 4), column vectors. :meth:`close`, and going back to an
        earlier frame, put everything back. Raises ValueError for an unknown name.
        """
        self.session.world.move(name, matrix)

    def reload_shaders(self, files: set[Path]) -> None:
        """Compile anew the GLSL programs that stand in ``files`` (resolved paths), for the next
        frame. Raises :class:`~nau_py.ShaderError`; all are then as they were."""
        self.session.resources.reload_programs(files)
        for state in self.session.states:
            state.reload_shaders(files)

    def reload_ray_programs(self) -> None:
        """Load the ray programs anew, for the next frame. Raises
        :class:`~nau_py.ProgramError`; those of the pass then stay."""
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
        self._turns.restart()
        self._plan_turn()

    def _step(self, index: int) -> list[PassRecord]:
        session = self.session
        if self._turns.ended:
            return self._left_out(self._turns.why)
        if self._turns.advance():
            self._plan_turn()
            session.start_pipeline(self.pipeline.name or "", index)
        session.resources.clear_buffers_by_frame()
        timer = index * self.time_step * 1000.0
        session.world.events.frame(index * self.time_step)
        session.reset_view()
        context = FrameContext(session, index, timer)
        records = self._draw(context)
        if self._turns.is_last_frame(context.index):
            self._turns.end(f"it has drawn its {self.pipeline.frameCount} frames")
        if self._turns.over and self.plan.steps:
            self.scripts.call(self.pipeline.postScript, context, self.plan.steps[0].pass_)
        self._note(self.scripts.diagnostics)
        return records

    def _draw(self, context: FrameContext) -> list[PassRecord]:
        scripts, pipeline = self.scripts, self.pipeline
        first = self.plan.steps[0].pass_ if self.plan.steps else None
        if first is not None and context.index == 0:
            scripts.call(pipeline.preScript, context, first)
        if first is not None and not scripts.test(pipeline.testScript, context, first):
            said = f"test '{pipeline.testScript.script}' says no"  # type: ignore[union-attr]
            self._turns.end(f"its {said}")
            return self._left_out(f"the pipeline's {said}")
        for step in self.plan.steps:
            context = replace(context, records=(*context.records, self._run(step, context)))
        return list(context.records)

    def _left_out(self, reason: str) -> list[PassRecord]:
        return [PassRecord(s.name, s.pass_.pass_class, "left_out", reason) for s in self.plan.steps]

    def _run(self, step: Step, context: FrameContext) -> PassRecord:
        """Run a pass with its scripts; return the outcome."""
        record = PassRecord(step.name, step.pass_.pass_class)
        reason = step.reason or _skipped_by_mode(step.pass_.run_mode, context.index)
        if reason:
            return replace(record, status="left_out", reason=reason)
        start = perf_counter()
        pass_, scripts = step.pass_, self.scripts
        scripts.call(pass_.preScript, context, pass_)
        report, times = PassReport(), 0
        while times < MAX_REPEATS and scripts.test(pass_.testScript, context, pass_):
            report = report.then(self._execute(step, context))
            times += 1
            again = pass_.testScript is not None and pass_.testScript.TEST_MODE == "RUN_WHILE"
            if not (again and scripts.running):
                break
        scripts.call(pass_.postScript, context, pass_)
        reason = report.left_out
        if times == 0 and pass_.testScript is not None:
            reason = f"its test '{pass_.testScript.script}' says no"
        elif times > 1:
            report = replace(report, notes=(*report.notes, f"it ran {times} times"))
        ms = (perf_counter() - start) * 1000
        if report.nonfinite:
            self._note_nonfinite(step, report, context.session.options.check_numerics)
        self._note(context.session.resources.diagnostics)
        status = "left_out" if reason else "run"
        return replace(record, status=status, reason=reason, ms=ms, report=report)

    def _note_nonfinite(self, step: Step, report: PassReport, refuse: bool) -> None:
        message = f"pass '{step.name}': {report.nonfinite} samples or rays were not finite"
        message += report.blame
        if refuse:
            raise NauError(error("T014", step.pass_.location, message))
        self._note([warning("T014", step.pass_.location, message)])

    def _execute(self, step: Step, context: FrameContext) -> PassReport:
        try:
            report = pass_classes()[step.pass_.pass_class].execute(step.pass_, context)
            context.session.resources.device.ctx.finish()
            context.session.resources.check()
        except NauError:
            raise
        except Exception as bug:
            message = (
                f"pass '{step.name}' of pipeline '{self.pipeline.name}' failed: "
                f"{type(bug).__name__}: {bug}"
            )
            raise NauError(error("E001", step.pass_.location, message)) from bug
        return report

    def _note(self, found: list[Diagnostic]) -> None:
        """Add findings that are new; those of one pass and rule are kept once a run."""
        known = {(d.rule, d.location, d.message) for d in self.diagnostics}
        self.diagnostics += [d for d in found if (d.rule, d.location, d.message) not in known]

    def _capture(self) -> tuple[NDArray[Any], dict[str, NDArray[Any]]]:
        resources = self.session.resources
        targets: dict[str, NDArray[Any]] = {}
        for step in self.plan.running:
            for resource in step.access.writes:
                if resource.kind != "texture" or resource.name in targets:
                    continue
                texture = resources.texture(resource.name)
                if texture is not None and texture.layers == 1:
                    targets[resource.name] = np.ascontiguousarray(texture.read()[::-1])
        image = targets.get(self.plan.output.name)
        if not self.plan.running or (self.plan.output != WINDOW and image is None):
            message = (
                f"pipeline '{self.pipeline.name}' draws no picture: no pass of it draws into the "
                "window or into a two-dimensional texture"
            )
            self._note([warning("E003", self.pipeline.location, message)])
        if self.plan.output == WINDOW:
            window = next(iter(resources.window.textures.values()))
            return np.ascontiguousarray(window.read()[::-1]), targets
        if image is None:
            width, height = self._size
            image = np.zeros((height, width, 4), np.uint8)
        return image, targets


def _skipped_by_mode(mode: str, index: int) -> str:
    """Why run mode ``mode`` leaves the pass out of frame ``index``; empty where it runs."""
    skipped = {
        "SKIP_FIRST_FRAME": index == 0,
        "RUN_ONCE": index > 0,
        "RUN_EVEN": index % 2 == 1,
        "RUN_ODD": index % 2 == 0,
    }
    return f"its mode is {mode} and this is frame {index}" if skipped.get(mode) else ""


def _lacking(class_: str) -> str:
    """Why a pass class does not run."""
    if class_ == "mesh":
        return "is not supported: it needs the OpenGL extension GL_NV_mesh_shader"
    return "is not supported by this version"

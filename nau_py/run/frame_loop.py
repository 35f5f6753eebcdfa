"""The passes of one frame, with the scripts of pipeline and passes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from time import perf_counter

from nau_py.diagnostics.diagnostic import Diagnostic, error, warning
from nau_py.diagnostics.errors import NauError
from nau_py.graph.plan import Plan
from nau_py.graph.step import Step
from nau_py.model.pipeline import Pipeline
from nau_py.passes import pass_classes
from nau_py.passes.frame import FrameContext
from nau_py.passes.report import PassRecord, PassReport
from nau_py.run.findings import add_new
from nau_py.run.scripts import MAX_REPEATS, Scripts


@dataclass(frozen=True, slots=True)
class FrameLoop:
    """Runs the passes of a plan. New findings are appended to ``diagnostics``."""

    plan: Plan
    pipeline: Pipeline
    scripts: Scripts
    diagnostics: list[Diagnostic]

    def run_frame(self, frame: FrameContext) -> tuple[list[PassRecord], str]:
        """Run the passes in order.

        Returns their outcomes, and the reason why the pipeline ends with this frame; empty where
        its test passes. Raises :class:`~nau_py.NauError`.
        """
        scripts, pipeline = self.scripts, self.pipeline
        first = self.plan.steps[0].pass_ if self.plan.steps else None
        if first is not None and frame.index == 0:
            scripts.call(pipeline.preScript, frame, first)
        if first is not None and not scripts.test(pipeline.testScript, frame, first):
            said = f"test '{pipeline.testScript.script}' says no"  # type: ignore[union-attr]
            return leave_out(self.plan, f"the pipeline's {said}"), f"its {said}"
        for step in self.plan.steps:
            frame = replace(frame, records=(*frame.records, self._run(step, frame)))
        return list(frame.records), ""

    def _run(self, step: Step, frame: FrameContext) -> PassRecord:
        """Run a pass with its scripts; return the outcome."""
        pass_, scripts = step.pass_, self.scripts
        reason = step.reason or _mode_reason(pass_.run_mode, frame.index)
        if reason:
            return PassRecord(step.name, pass_.pass_class, "left_out", reason)
        start = perf_counter()
        scripts.call(pass_.preScript, frame, pass_)
        report, times = self._repeat(step, frame)
        scripts.call(pass_.postScript, frame, pass_)
        reason = report.left_out
        if times == 0 and pass_.testScript is not None:
            reason = f"its test '{pass_.testScript.script}' says no"
        elif times > 1:
            report = replace(report, notes=(*report.notes, f"it ran {times} times"))
        ms = (perf_counter() - start) * 1000
        if report.nonfinite:
            self._report_nonfinite(step, report, frame.session.options.check_numerics)
        add_new(self.diagnostics, frame.session.resources.diagnostics)
        status = "left_out" if reason else "run"
        return PassRecord(step.name, pass_.pass_class, status, reason, ms, report)

    def _repeat(self, step: Step, frame: FrameContext) -> tuple[PassReport, int]:
        """Run a pass as often as its test script asks; return the report, and how often it ran."""
        test, report, times = step.pass_.testScript, None, 0
        while times < MAX_REPEATS and self.scripts.test(test, frame, step.pass_):
            done = self._execute(step, frame)
            report = done if report is None else report.then(done)
            times += 1
            again = test is not None and test.TEST_MODE == "RUN_WHILE"
            if not (again and self.scripts.running):
                break
        return report or PassReport(), times

    def _execute(self, step: Step, frame: FrameContext) -> PassReport:
        resources = frame.session.resources
        try:
            report = pass_classes()[step.pass_.pass_class].execute(step.pass_, frame)
            resources.device.ctx.finish()
            resources.check()
        except NauError:
            raise
        except Exception as bug:
            message = (
                f"pass '{step.name}' of pipeline '{self.pipeline.name}' failed: "
                f"{type(bug).__name__}: {bug}"
            )
            raise NauError(error("E001", step.pass_.location, message)) from bug
        return report

    def _report_nonfinite(self, step: Step, report: PassReport, refuse: bool) -> None:
        message = f"pass '{step.name}': {report.nonfinite} samples or rays were not finite"
        message += report.blame
        if refuse:
            raise NauError(error("T014", step.pass_.location, message))
        add_new(self.diagnostics, [warning("T014", step.pass_.location, message)])


def leave_out(plan: Plan, reason: str) -> list[PassRecord]:
    """Return the outcomes of a frame in which no pass runs."""
    return [PassRecord(s.name, s.pass_.pass_class, "left_out", reason) for s in plan.steps]


def _mode_reason(mode: str, index: int) -> str:
    """Return why run mode ``mode`` leaves a pass out of frame ``index``; empty where it runs."""
    skipped = {
        "SKIP_FIRST_FRAME": index == 0,
        "RUN_ONCE": index > 0,
        "RUN_EVEN": index % 2 == 1,
        "RUN_ODD": index % 2 == 0,
    }
    return f"its mode is {mode} and this is frame {index}" if skipped.get(mode) else ""

"""Launch the compiled programs of a raytrace pass for a frame."""

from __future__ import annotations

from dataclasses import dataclass

from nau_py.diagnostics.diagnostic import warning
from nau_py.model.effects import ALL, AUTO
from nau_py.model.raytrace import RaytracePass
from nau_py.raytrace.ptx.host.environment import LaunchEnvironment
from nau_py.raytrace.ptx.host.inputs import OutputTexels, PassSetup, PtxFrame
from nau_py.raytrace.ptx.host.optix_environment import OptixEnvironment
from nau_py.raytrace.ptx.host.programs import CompiledPrograms
from nau_py.raytrace.ptx.host.rt_environment import RtEnvironment
from nau_py.raytrace.ptx.optix.optix6 import STACK_OVERFLOW
from nau_py.raytrace.ptx.runtime.guarded import open_marks
from nau_py.raytrace.ptx.runtime.launch import PtxLaunchResult, run_launch
from nau_py.raytrace.ptx.runtime.layout import BUFFER_INDEX, NO_CALLABLE

_MOST_TEXTS = 20
"""Printed texts in a report."""
_CODES = {
    -1: "stack overflow",
    -2: "trace depth exceeded",
    NO_CALLABLE: "no such callable program",
    0x3FB: "index out of bounds",
    STACK_OVERFLOW: "trace depth exceeded",
    BUFFER_INDEX: "buffer index out of bounds, or elements of another size",
    0x3FE: "invalid ray",
}
"""Exception codes of OptiX (``optix_types.h``, ``optix_declarations.h``) and of the runtime."""


@dataclass(frozen=True, slots=True)
class PtxResult:
    """Outcome of a launch.

    ``rays``: traced rays by ray type; ``nonfinite``: pixels of the first output that are not
    finite, ``blame``: the first of them, as the end of a message; ``notes``: lines for the report.
    """

    outputs: list[OutputTexels]
    pixels: int
    rays: dict[str, int]
    nonfinite: int
    blame: str
    notes: tuple[str, ...]


class PtxPrograms:
    """Compiled programs of a pass with their environment, kept from frame to frame.

    Raises :class:`~nau_py.ProgramError` for programs that cannot be loaded.
    """

    def __init__(self, setup: PassSetup) -> None:
        self.setup = setup
        self.environment: LaunchEnvironment = self._make(CompiledPrograms(setup))

    def reload(self) -> None:
        """Compile the programs again. Raises :class:`~nau_py.ProgramError`; the programs compiled
        before then stay in use."""
        programs = CompiledPrograms(self.setup)
        if programs.old == isinstance(self.environment, OptixEnvironment):
            self.environment.bind(programs)
        else:
            self.environment = self._make(programs)

    def _make(self, programs: CompiledPrograms) -> LaunchEnvironment:
        return (OptixEnvironment if programs.old else RtEnvironment)(self.setup, programs)

    def run(self, frame: PtxFrame) -> PtxResult:
        """Run ray generation for all launch indices of a frame that are selected.

        Reports exceptions of programs as T019.
        """
        environment, pass_ = self.environment, self.setup.pass_
        launch = environment.prepare_launch(frame)
        launch.indices = frame.pixels
        generate = pass_.rtEntryPoint and pass_.rtEntryPoint.rayGen
        launch.marks = open_marks(
            f"project '{self.setup.project.name}', pass '{pass_.name}', program "
            f"'{generate and generate.proc}'",
            frame.width,
        )
        frame.end_stage("build")
        done = run_launch(launch, environment.bound.natives, frame.threads, frame.progress)
        frame.end_stage("trace")
        nonfinite = environment.find_nonfinite()
        blame = ""
        if len(nonfinite):
            blame = f"; the first at pixel {_place(int(nonfinite[0]), frame.width)}"
        types = environment.bound.types
        notes = environment.notes() + _list_texts(done, frame.width)
        if frame.effects not in (AUTO, ALL):
            notes.append(
                f"effects '{frame.effects}' leave nothing out here: compiled programs decide "
                "themselves which rays they trace"
            )
        if done.thrown:
            _report_exceptions(pass_, frame, done)
        return PtxResult(
            environment.collect_outputs(frame),
            frame.width * frame.height if frame.pixels is None else len(frame.pixels),
            {
                (types[i] if i < len(types) else f"type {i}"): int(n)
                for i, n in enumerate(done.rays)
                if n
            },
            len(nonfinite),
            blame,
            tuple(notes),
        )


def _place(index: int, width: int) -> str:
    return f"({index % width}, {index // width})"


def _report_exceptions(pass_: RaytracePass, frame: PtxFrame, done: PtxLaunchResult) -> None:
    code = done.code - (1 << 32) if done.code >= 1 << 31 else done.code
    meaning = f" ({_CODES[code]})" if code in _CODES else ""
    generate = pass_.rtEntryPoint and pass_.rtEntryPoint.rayGen
    handler = pass_.rtEntryPoint and pass_.rtEntryPoint.exception
    then = f"'{handler.proc}' took over" if handler else "their work ended there"
    message = (
        f"pass '{pass_.name}': program '{generate and generate.proc}' threw at {done.thrown:,} "
        f"launch indices, first at {_place(done.first, frame.width)}: code {code}{meaning}; {then}"
    )
    frame.gpu.report(warning("T019", pass_.location, message))


def _list_texts(done: PtxLaunchResult, width: int) -> list[str]:
    """Return the printed texts as notes."""
    notes = [
        f"printed at {_place(i, width)}: {text.rstrip()}" for i, text in done.printed[:_MOST_TEXTS]
    ]
    if len(done.printed) > _MOST_TEXTS:
        notes.append(f"… and {len(done.printed) - _MOST_TEXTS} texts more")
    return notes

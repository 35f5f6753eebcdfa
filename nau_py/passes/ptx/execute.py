"""Runs a raytrace pass whose programs are compiled."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from nau_py.diagnostics.diagnostic import warning
from nau_py.model.effects import ALL, AUTO
from nau_py.model.raytrace import RaytracePass
from nau_py.passes.drawing import begin_view, run_process
from nau_py.passes.frame import FrameContext, Session
from nau_py.passes.ptx.optix import OptixState
from nau_py.passes.ptx.programs import Programs
from nau_py.passes.ptx.rt import RtState
from nau_py.passes.report import PassReport, Stages
from nau_py.passes.tracing.textures import read_inputs
from nau_py.raytrace.ptx.optix.optix6 import STACK_OVERFLOW
from nau_py.raytrace.ptx.runtime.guarded import open_marks
from nau_py.raytrace.ptx.runtime.layout import BUFFER_INDEX, NO_CALLABLE
from nau_py.raytrace.selection.pixels import select_pixels

if TYPE_CHECKING:
    from nau_py.raytrace.ptx.runtime.launch import PtxLaunchResult

_TOLD = 20
"""Printed texts that a report has."""
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


class PtxState:
    """State of a pass of compiled programs: its environment of OptiX 7 or OptiX 3 to 6."""

    def __init__(self, pass_: RaytracePass, session: Session) -> None:
        self.session = session
        self._pass = pass_
        programs = Programs(pass_, session)
        self.environment: RtState | OptixState = (OptixState if programs.old else RtState)(
            pass_, session, programs
        )

    def reload_shaders(self, files: set[Path]) -> None:
        """Do nothing: compiled programs call no GLSL."""

    def reload_programs(self) -> None:
        """Compile the programs again. Raises :class:`~nau_py.ProgramError`; the programs compiled
        before then stay in use."""
        pass_ = self._pass
        programs = Programs(pass_, self.session)
        if programs.old == isinstance(self.environment, OptixState):
            self.environment.bind(pass_, programs)
        else:
            self.environment = (OptixState if programs.old else RtState)(
                pass_, self.session, programs
            )

    def close(self) -> None:
        """Do nothing: memory is freed with the state."""


def execute_ptx(pass_: RaytracePass, frame: FrameContext) -> PassReport:
    """Launch the pass's programs over its target, or over the pixels that its mask selects."""
    from nau_py.raytrace.ptx.runtime.launch import run_launch

    session = frame.session
    options = session.options
    view = begin_view(pass_, frame, frame.world.camera(pass_.camera_name))
    target = view.target
    run_process(pass_.preProcess, frame)
    stages = Stages()
    pixels = None
    if pass_.mask is not None:
        pixels = select_pixels(read_inputs(pass_, frame).mask, target.width, target.height)
        stages.end("read_back")
    environment = session.state(pass_, PtxState).environment
    launch = environment.begin(pass_, frame, view)
    launch.indices = pixels
    generate = pass_.rtEntryPoint and pass_.rtEntryPoint.rayGen
    launch.marks = open_marks(
        f"project '{frame.project.name}', pass '{pass_.name}', program "
        f"'{generate and generate.proc}'",
        target.width,
    )
    stages.end("build")
    name, progress = pass_.name or "", session.progress
    done = run_launch(
        launch,
        list(environment.programs.natives.values()),
        options.threads,
        lambda done, total: progress(name, done, total),
    )
    stages.end("trace")
    odd = environment.odd()
    blame = ""
    if len(odd):
        first = int(odd[0])
        blame = f"; the first at pixel ({first % target.width}, {first // target.width})"
    environment.end(pass_, frame, target, pixels)
    stages.end("read_back")
    run_process(pass_.postProcess, frame)
    types = environment.types
    notes = environment.notes() + _report(pass_, frame, done, target.width)
    node = frame.project.file.effects
    effects = options.effects or (node.simulate if node else None) or AUTO
    if effects not in (AUTO, ALL):
        notes.append(
            f"compiled programs say themselves which rays they send: effects '{effects}' leave "
            "nothing out here"
        )
    return PassReport(
        pixels=target.width * target.height if pixels is None else len(pixels),
        rays={
            (types[i] if i < len(types) else f"type {i}"): int(n)
            for i, n in enumerate(done.rays)
            if n
        },
        nonfinite=len(odd),
        blame=blame,
        notes=tuple(notes),
        stages=stages.ms,
    )


def _report(
    pass_: RaytracePass, frame: FrameContext, done: PtxLaunchResult, width: int
) -> list[str]:
    """Report exceptions as diagnostics; return the printed texts as notes."""

    def place(index: int) -> str:
        return f"({index % width}, {index // width})"

    if done.thrown:
        code = done.code - (1 << 32) if done.code >= 1 << 31 else done.code
        what = f" ({_CODES[code]})" if code in _CODES else ""
        generate = pass_.rtEntryPoint and pass_.rtEntryPoint.rayGen
        handler = pass_.rtEntryPoint and pass_.rtEntryPoint.exception
        then = f"'{handler.proc}' took over" if handler else "their work ended there"
        said = (
            f"pass '{pass_.name}': program '{generate and generate.proc}' threw at {done.thrown:,} "
            f"launch indices, first at {place(done.first)}: code {code}{what}; {then}"
        )
        frame.session.resources.diagnostics.append(warning("T019", pass_.location, said))
    notes = [f"printed at {place(i)}: {text.rstrip()}" for i, text in done.printed[:_TOLD]]
    if len(done.printed) > _TOLD:
        notes.append(f"… and {len(done.printed) - _TOLD} texts more")
    return notes

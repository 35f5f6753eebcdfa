"""Passes of compiled programs: the GPU's side of a launch (``raytrace/ptx/host`` has the other)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.diagnostics.diagnostic import Diagnostic
from nau_py.model.effects import AUTO
from nau_py.model.raytrace import RaytracePass, RayVariable
from nau_py.passes.drawing import begin_view, camera_context, run_process, viewport_names
from nau_py.passes.frame import FrameContext, Session, View
from nau_py.passes.report import PassReport, Stages
from nau_py.passes.tracing.programs import make_trust_rule
from nau_py.passes.tracing.textures import read_inputs, store_selected
from nau_py.raster import gl
from nau_py.raster.semantics import resolve_source
from nau_py.raster.textures import GpuTexture
from nau_py.raytrace.ptx.host.inputs import (
    FIRST_OUTPUT,
    OutputFormat,
    OutputTexels,
    PassSetup,
    PtxFrame,
)
from nau_py.raytrace.ptx.host.run import PtxPrograms
from nau_py.raytrace.selection.pixels import select_pixels
from nau_py.scene.material import RenderMaterial


class PtxPassState:
    """State of a pass of compiled programs."""

    def __init__(self, pass_: RaytracePass, session: Session) -> None:
        self.programs = PtxPrograms(
            PassSetup(
                session.project,
                pass_,
                session.world,
                session.pass_materials(pass_),
                make_trust_rule(session),
            )
        )

    def reload_shaders(self, files: set[Path]) -> None:
        """Do nothing: compiled programs call no GLSL."""

    def reload_programs(self) -> None:
        """Compile the programs again. Raises :class:`~nau_py.ProgramError`; the programs compiled
        before then stay in use."""
        self.programs.reload()

    def close(self) -> None:
        """Do nothing: memory is freed with the state."""


class _FrameAccess:
    """The ``GpuAccess`` of a pass in one frame."""

    def __init__(self, pass_: RaytracePass, frame: FrameContext, view: View) -> None:
        self._resources = frame.session.resources
        self._context = camera_context(pass_, frame, view)

    def read_texture(self, name: str) -> NDArray[Any] | None:
        texture = self._resources.texture(name)
        if texture is None:
            return None
        format_ = texture.format
        shape = (max(texture.layers, 1), texture.height, texture.width, format_.channels)
        texels = np.empty(shape, format_.dtype)
        gl.read_texture(texture.glo, 0, format_.layout, format_.kind, texels)
        return texels

    def read_buffer(self, name: str) -> bytes | None:
        buffer = self._resources.buffer(name)
        return bytes(buffer.read()) if buffer is not None else None

    def write_buffer(self, name: str, data: bytes) -> None:
        self._resources.buffer(name).write(data)

    def resolve_value(
        self, node: RayVariable, material: RenderMaterial | None
    ) -> NDArray[Any] | None:
        self._context.material = material
        context, component = node.context or "CURRENT", node.component or ""
        return resolve_source(self._context, node.type or "", context, component, node.id or 0)

    def report(self, finding: Diagnostic) -> None:
        self._resources.diagnostics.append(finding)


def execute_ptx(pass_: RaytracePass, frame: FrameContext) -> PassReport:
    """Launch the pass's programs over its target, or over the pixels that its mask selects."""
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
    programs = session.state(pass_, PtxPassState).programs
    textures = _output_textures(pass_, session, view)
    node = frame.project.file.effects
    name = pass_.name or ""
    result = programs.run(
        PtxFrame(
            frame.index,
            view.camera,
            target.width,
            target.height,
            view.rect.aspect if viewport_names(pass_) else target.width / target.height,
            _FrameAccess(pass_, frame, view),
            tuple(
                OutputFormat(v, t.height, t.width, t.format.channels, t.format.dtype)
                for v, t in textures
            ),
            pixels,
            options.samples,
            options.threads,
            options.effects or (node.simulate if node else None) or AUTO,
            lambda done, total: session.progress(name, done, total),
            stages.end,
        )
    )
    for (_, texture), output in zip(textures, result.outputs):
        _store(view, texture, output, pixels if output.name == FIRST_OUTPUT else None)
    stages.end("read_back")
    run_process(pass_.postProcess, frame)
    return PassReport(
        pixels=result.pixels,
        rays=result.rays,
        nonfinite=result.nonfinite,
        blame=result.blame,
        notes=result.notes,
        stages=stages.ms,
    )


def _output_textures(
    pass_: RaytracePass, session: Session, view: View
) -> list[tuple[str, GpuTexture]]:
    """Return the textures that programs write, with the names of their variables."""
    target = view.target
    found = [(f"output{i}", target.textures[c.name]) for i, c in enumerate(target.colors)]
    for output in pass_.rtOutput:
        texture = session.resources.texture(output.texture or "")
        if output.var and texture is not None:
            found.append((output.var, texture))
    return found


def _store(
    view: View, texture: GpuTexture, output: OutputTexels, pixels: NDArray[np.int64] | None
) -> None:
    """Write an output to its texture. ``pixels``: those that the mask selects, the others get the
    clear value; None for all."""
    target = view.target
    if pixels is None and output.as_colours:
        pixels = np.arange(target.width * target.height)
    if pixels is not None:
        store_selected(target, pixels, output.texels)
    elif texture.format.dtype == np.float16:
        texture.write_values(output.texels)
    else:
        texture.write(output.texels)

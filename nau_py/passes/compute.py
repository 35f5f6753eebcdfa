"""Class ``compute``: runs a compute shader (docs/format.md, 4.4)."""

from __future__ import annotations

from nau_py.graph.contract import Access
from nau_py.model.library import DEFAULT_LIBRARY
from nau_py.model.linked import Project
from nau_py.model.pass_classes import ComputePass
from nau_py.model.passes import Pass
from nau_py.passes.access import add_material, add_process, buffer
from nau_py.passes.drawing import (
    dispatch_compute,
    draw_context,
    pass_value,
    run_process,
    window_view,
)
from nau_py.passes.frame import FrameContext
from nau_py.passes.report import PassReport


class ComputeClass:
    """Dispatches the work groups that the pass names."""

    def access(self, project: Project, pass_: Pass) -> Access:
        access = Access()
        if isinstance(pass_, ComputePass) and pass_.material is not None:
            library = pass_.material.fromLibrary or DEFAULT_LIBRARY
            add_material(access, project, library, pass_.material.name or "")
            for source in (pass_.material.bufferX, pass_.material.bufferY, pass_.material.bufferZ):
                if source:
                    access.add_read(buffer(source, None))
        add_process(access, pass_)
        return access

    def groups(self, pass_: ComputePass, frame: FrameContext) -> tuple[int, int, int]:
        """Work groups along x, y, z; DIM_* child tags override the material's numbers."""
        counts = []
        for axis in "XYZ":
            if f"DIM_{axis}" in pass_.settings:
                counts.append(int(pass_value(frame.project, pass_, f"DIM_{axis}")))
                continue
            source = getattr(pass_.material, f"buffer{axis}")
            storage = frame.session.resources.buffer(source) if source else None
            if storage is not None:
                offset = getattr(pass_.material, f"offset{axis}") or 0
                raw = storage.read(4, offset=offset)
                counts.append(int.from_bytes(raw, "little"))
            else:
                written = getattr(pass_.material, f"dim{axis}")
                counts.append(int(frame.project.number(written, 1.0)))
        return counts[0], counts[1], counts[2]

    def execute(self, pass_: Pass, frame: FrameContext) -> PassReport:
        if not isinstance(pass_, ComputePass) or pass_.material is None:
            return PassReport()
        resources = frame.session.resources
        run_process(pass_.preProcess, frame)
        library = pass_.material.fromLibrary or DEFAULT_LIBRARY
        material = frame.world.materials.get(library, pass_.material.name or "")
        program = resources.program(*material.program) if material else None
        if material is None or program is None or not program.is_compute:
            return PassReport()
        context = draw_context(pass_, frame, window_view(frame))
        dispatch_compute(program, material, self.groups(pass_, frame), context)
        run_process(pass_.postProcess, frame)
        return PassReport()

"""Class ``compute``: run a compute shader (docs/format.md, 4.4)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated

from nau_py.diagnostics.diagnostic import Diagnostic, error
from nau_py.graph.contract import Access
from nau_py.model.attribute import number
from nau_py.model.library import DEFAULT_LIBRARY
from nau_py.model.linked import Project
from nau_py.model.node import Attr, Child
from nau_py.model.pass_classes import MaterialReference
from nau_py.model.passes import Pass
from nau_py.model.values import DataType
from nau_py.passes.access import add_material, add_process, buffer
from nau_py.passes.drawing import (
    dispatch_compute,
    draw_context,
    pass_value,
    run_process,
    window_view,
)
from nau_py.passes.frame import FrameContext
from nau_py.passes.registry import PassClass, register_pass
from nau_py.passes.report import PassReport


def _dimension(axis: str) -> Attr:
    return Attr(DataType.UINT, f"Work groups along {axis}.", constant=True)


def _source(axis: str) -> Attr:
    return Attr(doc=f"Buffer with the work groups along {axis}, `lib::buffer`.", ref="buffer")


def _offset(axis: str) -> Attr:
    return Attr(DataType.UINT, f"Byte offset of the number along {axis}.")


class ComputeMaterial(MaterialReference):
    """A compute material and the number of work groups, given or read from a buffer."""

    dimX: Annotated[int | str | None, _dimension("x")] = None
    dimY: Annotated[int | str | None, _dimension("y")] = None
    dimZ: Annotated[int | str | None, _dimension("z")] = None
    bufferX: Annotated[str | None, _source("x")] = None
    bufferY: Annotated[str | None, _source("y")] = None
    bufferZ: Annotated[str | None, _source("z")] = None
    offsetX: Annotated[int | None, _offset("x")] = None
    offsetY: Annotated[int | None, _offset("y")] = None
    offsetZ: Annotated[int | None, _offset("z")] = None


class ComputePass(Pass):
    """Runs a compute shader."""

    material: Annotated[ComputeMaterial | None, Child(ComputeMaterial)] = None


@register_pass("compute")
class ComputeClass(PassClass):
    """Runs a compute shader over the work groups of the pass."""

    model = ComputePass
    parameters = tuple(
        number(f"DIM_{axis}", DataType.UINT, 1, f"Work groups along {axis.lower()}.", unit="groups")
        for axis in "XYZ"
    )

    def faults(self, project: Project, pass_: Pass) -> Iterator[Diagnostic]:
        """Yield what is missing of material and work groups, or given twice."""
        assert isinstance(pass_, ComputePass)
        material, label = pass_.material, f"compute pass '{pass_.name}'"
        if material is None:
            yield error("P003", pass_.location, f"{label} needs a <material>")
            return
        for axis in "XYZ":
            given, source = getattr(material, f"dim{axis}"), getattr(material, f"buffer{axis}")
            offset = getattr(material, f"offset{axis}")
            if given is not None and source is not None:
                message = f"{label}: 'dim{axis}' and 'buffer{axis}' exclude each other"
                yield error("P003", material.where(f"buffer{axis}"), message)
            if source is not None and offset is None:
                message = f"{label}: 'buffer{axis}' needs 'offset{axis}'"
                yield error("P003", material.where(f"buffer{axis}"), message)
            written = f"dim{axis}" in material.unknown_attributes
            unset = given is None and source is None and not written
            if axis == "X" and unset and f"DIM_{axis}" not in pass_.settings:
                message = f"{label}: <material> needs 'dimX' or 'bufferX'"
                yield error("P003", material.location, message)

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
        """Return the work groups along x, y, z; DIM_* child tags override those of the material."""
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

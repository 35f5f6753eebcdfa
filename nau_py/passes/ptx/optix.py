"""The environment of class ``optix``: programs of OptiX 3 to 6 and their variables (7.2)."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from math import radians, tan
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from nau_py.model.raytrace import GEOMETRY_KINDS, GeometryProgram, RaytracePass
from nau_py.passes.drawing import camera_context
from nau_py.passes.frame import FrameContext, Session, View
from nau_py.passes.ptx.programs import Programs
from nau_py.passes.ptx.resources import Resources
from nau_py.passes.ptx.variables import UNITS
from nau_py.raytrace.programs.description import ANY_HIT, CLOSEST_HIT, MISS
from nau_py.raytrace.ptx.optix.optix6 import STACK_OVERFLOW
from nau_py.raytrace.ptx.optix.variables import BUFFER, BUFFER_BYTES, PLAIN, TEXTURE
from nau_py.raytrace.ptx.runtime.guarded import open_marks

if TYPE_CHECKING:
    from nau_py.raster.targets import Target
    from nau_py.raytrace.ptx.runtime.launch import PtxLaunch
    from nau_py.scene.material import RenderMaterial

Values = dict[str, "bytes | NDArray[Any] | int"]
"""Of variables by name: bytes, an array (a buffer, its last axis one element), or the handle of a
texture."""


@dataclass(slots=True)
class Instance:
    """One material of one object: its name, and the buffers of its geometry."""

    material: str
    buffers: Values


class OptixState:
    """What such a pass keeps from frame to frame.

    As in Nau, geometry is taken as it is at the first frame, and object transforms are not applied
    but where the scene type has baked them in; materials go through the pass's material maps.
    """

    def __init__(self, pass_: RaytracePass, session: Session, programs: Programs) -> None:
        self.session = session
        self.resources = Resources(session, pass_)
        self.instances = _instances(pass_, session)
        self.mapped = session.pass_materials(pass_)
        self.outputs: dict[str, NDArray[Any]] = {}
        self.kinds: list[str] = []
        self.handle = 0
        self.bind(pass_, programs)

    def bind(self, pass_: RaytracePass, programs: Programs) -> None:
        """Compile the programs, and build what rays meet with them. Raises
        :class:`~nau_py.ProgramError`; what was bound then stays."""
        from nau_py.raytrace.ptx.runtime.geometry import build_scene
        from nau_py.raytrace.ptx.runtime.launch import record_table, set_program

        layout, types = programs.layout, pass_.ray_types
        intersect, bounds = (_geometry(pass_, kind) for kind in GEOMETRY_KINDS)
        asked, boxes = programs.address(intersect), programs.address(bounds)
        hits = record_table(len(self.instances) * len(types), layout.record_bytes)
        for at, instance in enumerate(self.instances):
            entry = pass_.entry(self._names(instance.material))
            for index, name in enumerate(types):
                record = hits[at * len(types) + index]
                set_program(record, "intersect", asked)
                for kind, place in ((CLOSEST_HIT, "closest"), (ANY_HIT, "any")):
                    program = entry.program(name, kind) if entry else None
                    set_program(record, place, programs.address(program))
        misses = record_table(len(types), layout.record_bytes)
        default = pass_.rtDefaultMaterial
        for index, name in enumerate(types):
            program = default.program(name, MISS) if default else None
            set_program(misses[index], "closest", programs.address(program))
        entry_point = pass_.rtEntryPoint
        assert entry_point is not None
        assert entry_point.rayGen is not None
        begin = programs.address(entry_point.rayGen)
        exception = programs.address(entry_point.exception)
        generate = (programs.native(entry_point.rayGen), begin)
        self.hits, self.misses, self.types, self.programs = hits, misses, types, programs
        self.generate, self.exception = generate, exception
        self.context = record_table(1, layout.record_bytes)
        for at, instance in enumerate(self.instances):
            for record in self._records(at):
                self._write(record, instance.buffers)
        launch = self._launch((1, 1))
        native = programs.native(intersect) if intersect else generate[0]
        shapes = [(i.buffers["vertex_buffer"], i.buffers["index_buffer"]) for i in self.instances]
        records = [self._records(at)[0] for at in range(len(self.instances))]
        about = f"project '{self.session.project.name}', pass '{pass_.name}', its geometry programs"
        launch.marks = open_marks(about, 0)
        self.handle, self.kinds, self._kept = build_scene(
            native, launch, shapes, records, asked, boxes
        )

    def _records(self, instance: int) -> NDArray[np.uint8]:
        count = len(self.types)
        return self.hits[instance * count : (instance + 1) * count]

    def _names(self, name: str) -> set[str]:
        mapped = self._material(name)
        return {name} | (mapped.names if mapped is not None else set())

    def _material(self, name: str) -> RenderMaterial | None:
        from nau_py.model.library import DEFAULT_LIBRARY

        return self.mapped[name] or self.session.world.materials.get(DEFAULT_LIBRARY, name)

    def _write(self, record: NDArray[np.uint8], values: Values) -> None:
        """Put the variables of ``values`` that programs have into a record."""
        from nau_py.raytrace.ptx.runtime.layout import RECORD_HEADER

        layout = self.programs.layout
        for name, value in values.items():
            variable = layout.variables.get(name)
            if variable is None:
                continue
            if variable.kind == BUFFER and isinstance(value, np.ndarray):
                data = _buffer(value)
            elif variable.kind == TEXTURE and isinstance(value, int):
                data = struct.pack("<Q", value)
            elif variable.kind == PLAIN and isinstance(value, bytes):
                data = value[: variable.size].ljust(variable.size, b"\0")
            else:
                continue
            at = RECORD_HEADER + layout.offsets[name]
            record[at : at + len(data)] = np.frombuffer(data, np.uint8)

    def begin(self, pass_: RaytracePass, frame: FrameContext, view: View) -> PtxLaunch:
        """The launch of a frame; the variables of the programs are written."""
        from nau_py.raytrace.ptx.runtime.layout import RECORD_HEADER

        context, target = camera_context(pass_, frame, view), view.target
        self.resources.begin_frame()
        values = self._of_context(pass_, view)
        for node in pass_.rtGlobalParams:
            values[node.name or ""] = self.resources.packed(node, context)
        for record in [*self.context, *self.misses]:
            self._write(record, values)
        for at, instance in enumerate(self.instances):
            context.material = material = self._material(instance.material)
            own = values | self._textures(material) | instance.buffers
            for node in pass_.rtMaterialParams:
                own[node.name or ""] = self.resources.packed(node, context)
            first, *others = self._records(at)
            self._write(first, own)
            for record in others:
                record[RECORD_HEADER:] = first[RECORD_HEADER:]
        context.material = None
        return self._launch((target.width, target.height))

    def _launch(self, size: tuple[int, int]) -> PtxLaunch:
        from nau_py.raytrace.ptx.runtime.launch import PtxLaunch

        return PtxLaunch(
            self.generate,
            self.handle,
            self.hits,
            self.misses,
            self.context,
            size,
            len(self.types),
            self.exception,
            STACK_OVERFLOW,
            self.programs.layout.attribute_bytes,
            flush=self.programs.flushes,
        )

    def _of_context(self, pass_: RaytracePass, view: View) -> Values:
        camera = view.camera
        vectors = {
            "eye": camera.position,
            "U": camera.right,
            "V": camera.true_up,
            "W": camera.forward,
            "fov": np.array([tan(radians(camera.values["FOV"]) / 2)]),
        }
        values: Values = {n: np.asarray(v, np.float32).tobytes() for n, v in vectors.items()}
        values["top_object"] = struct.pack("<I", 1 if self.instances else 0)
        values |= {name: struct.pack("<i", at) for at, name in enumerate(self.types)}
        for source in pass_.rtInput:
            image = self.resources.drawn(source.texture or "", by_texel=True)
            variable = self.programs.layout.variables.get(source.var or "")
            if image is not None and variable is not None:
                texels = image.texels
                values[source.var or ""] = image.handle if variable.kind == TEXTURE else texels
        for name, texture in self._targets(pass_, view.target):
            values[name] = self._output(name, texture)
        return values

    def _targets(self, pass_: RaytracePass, target: Target) -> list[tuple[str, Any]]:
        """The textures that programs write, by the names of their buffers."""
        found = [(f"output{i}", target.textures[c.name]) for i, c in enumerate(target.colors)]
        for output in pass_.rtOutput:
            texture = self.session.resources.texture(output.texture or "")
            if output.var and texture is not None:
                found.append((output.var, texture))
        return found

    def _output(self, name: str, texture: Any) -> NDArray[Any]:
        """The buffer of a texture, which keeps what it has from frame to frame."""
        format_ = texture.format
        dtype = np.float32 if format_.dtype == np.float16 else format_.dtype
        shape = (texture.height, texture.width, format_.channels)
        held = self.outputs.get(name)
        if held is None or held.shape != shape:
            held = self.outputs[name] = np.zeros(shape, dtype)
        return held

    def _textures(self, material: RenderMaterial | None) -> Values:
        found: Values = {}
        for unit, binding in (material.textures if material else {}).items():
            image = self.resources.image(binding.texture, binding.path, binding)
            if image is None and binding.path is None:
                image = self.resources.drawn(binding.texture)
            if image is not None and unit < UNITS:
                found[f"tex{unit}"] = image.handle
        return found

    def notes(self) -> list[str]:
        """What the report should tell."""
        from nau_py.raytrace.ptx.runtime.geometry import CUSTOM

        count = self.kinds.count(CUSTOM)
        if not count:
            return []
        return [
            f"{count} of {len(self.kinds)} geometries are what their own programs say, no "
            "triangles: rays ask them at each box"
        ]

    def odd(self) -> NDArray[np.int64]:
        """The pixels of the first output that are not finite."""
        values = self.outputs.get("output0")
        if values is None or values.dtype.kind != "f":
            return np.zeros(0, np.int64)
        return np.flatnonzero(~np.isfinite(values).all(axis=2))

    def end(
        self,
        pass_: RaytracePass,
        frame: FrameContext,
        target: Target,
        pixels: NDArray[np.int64] | None,
    ) -> None:
        """Give what programs wrote to the textures. ``pixels``: those that the mask selects, of
        the first one; the others get the clear value."""
        from nau_py.passes.tracing.textures import store_selected

        self.resources.give_back()
        for name, texture in self._targets(pass_, target):
            values = self.outputs[name]
            if pixels is not None and name == "output0":
                store_selected(target, pixels, values)
            elif texture.format.dtype == np.float16:
                texture.write_values(values)
            else:
                texture.write(values)


def _geometry(pass_: RaytracePass, kind: str) -> GeometryProgram | None:
    return next((p for p in pass_.rtGeometryProgram if p.type == kind), None)


def _instances(pass_: RaytracePass, session: Session) -> list[Instance]:
    """Every object of the pass's scenes, by material group; what a mesh has not, is 0."""
    found = []
    for thing in session.world.objects(pass_.scene_names):
        mesh = thing.mesh
        if mesh.primitive != "TRIANGLES" or mesh.buffers:
            continue
        names = {a.name or "" for a in pass_.rtVertexAttributes} - {"position"}
        zeros = np.zeros((len(mesh.positions), 4), np.float32)
        shared: Values = {
            name: np.ascontiguousarray(mesh.attributes.get(name, zeros), np.float32)
            for name in sorted(names)
        }
        shared["vertex_buffer"] = np.ascontiguousarray(mesh.positions, np.float32)
        for group in mesh.groups:
            if len(group.indices):
                indices = np.ascontiguousarray(group.indices, np.uint32).reshape(-1, 1)
                found.append(Instance(group.material, shared | {"index_buffer": indices}))
    return found


def _buffer(values: NDArray[Any]) -> bytes:
    """What programs see of a buffer: address, sizes, bytes of an element (``optix6``)."""
    *sizes, channels = values.shape
    width, height, depth = [*reversed(sizes), 1, 1, 1][:3]
    element = channels * values.itemsize
    data = struct.pack("<QQQQIi", values.ctypes.data, width, height, depth, element, 0)
    assert len(data) == BUFFER_BYTES
    return data

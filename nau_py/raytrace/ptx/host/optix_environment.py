"""Environment of Nau's class ``optix``: programs of OptiX 3 to 6 and their variables (7.2)."""

from __future__ import annotations

import struct
from math import radians, tan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.model.library import DEFAULT_LIBRARY
from nau_py.model.raytrace import GEOMETRY_KINDS, GeometryProgram, RaytracePass
from nau_py.raytrace.programs.description import ANY_HIT, CLOSEST_HIT, MISS
from nau_py.raytrace.ptx.host.environment import LaunchEnvironment, Records, bind_programs
from nau_py.raytrace.ptx.host.geometry import Values, collect_instances
from nau_py.raytrace.ptx.host.inputs import (
    FIRST_OUTPUT,
    GpuAccess,
    OutputFormat,
    OutputTexels,
    PassSetup,
    PtxFrame,
)
from nau_py.raytrace.ptx.host.programs import CompiledPrograms
from nau_py.raytrace.ptx.host.variable_faults import TEXTURE_UNITS
from nau_py.raytrace.ptx.optix.optix6 import STACK_OVERFLOW
from nau_py.raytrace.ptx.optix.variables import BUFFER, BUFFER_BYTES, PLAIN, TEXTURE
from nau_py.raytrace.ptx.runtime.geometry import CUSTOM, build_scene
from nau_py.raytrace.ptx.runtime.guarded import open_marks
from nau_py.raytrace.ptx.runtime.launch import PtxLaunch, record_table, set_program
from nau_py.raytrace.ptx.runtime.layout import RECORD_HEADER
from nau_py.scene.material import RenderMaterial


class OptixEnvironment(LaunchEnvironment):
    """Embree structure, records, machine code and output buffers of a pass of class ``optix``.

    Materials go through the material maps of the pass, as in Nau.
    """

    def __init__(self, setup: PassSetup, programs: CompiledPrograms) -> None:
        super().__init__(setup)
        self.instances = collect_instances(setup.world, setup.pass_)
        self.outputs: dict[str, NDArray[Any]] = {}
        self.kinds: list[str] = []
        self.handle = 0
        self.hits = record_table(0, 0)
        self.bind(programs)

    def bind(self, programs: CompiledPrograms) -> None:
        """Compile the programs, and build the structure of the geometry that they describe."""
        pass_, layout = self.setup.pass_, programs.layout
        types = pass_.ray_types
        intersect, bounds = (_find_geometry(pass_, kind) for kind in GEOMETRY_KINDS)
        addresses = programs.address(intersect), programs.address(bounds)
        hits = record_table(len(self.instances) * len(types), layout.record_bytes)
        for at, instance in enumerate(self.instances):
            entry = pass_.entry(self._material_names(instance.material))
            for index, name in enumerate(types):
                record = hits[at * len(types) + index]
                set_program(record, "intersect", addresses[0])
                for kind, place in ((CLOSEST_HIT, "closest"), (ANY_HIT, "any")):
                    program = entry.program(name, kind) if entry else None
                    set_program(record, place, programs.address(program))
        default = pass_.rtDefaultMaterial
        self.bound = bind_programs(
            self.setup,
            programs,
            types,
            lambda index: default.program(types[index], MISS) if default else None,
            layout.record_bytes,
            layout.record_bytes,
        )
        self.hits = hits
        for at, instance in enumerate(self.instances):
            for record in self._records(at):
                self._write_values(record, instance.buffers)
        self._build_scene(intersect, *addresses)

    def _build_scene(self, intersect: GeometryProgram | None, *addresses: int) -> None:
        launch = self.make_launch(self.handle, self.hits, (1, 1))
        native = self.bound.generate[0]
        if intersect is not None:
            native = self.bound.programs.native(intersect)
        shapes = [(i.buffers["vertex_buffer"], i.buffers["index_buffer"]) for i in self.instances]
        records = [self._records(at)[0] for at in range(len(self.instances))]
        setup = self.setup
        label = f"project '{setup.project.name}', pass '{setup.pass_.name}', its geometry programs"
        launch.marks = open_marks(label, 0)
        self.handle, self.kinds, self._kept = build_scene(
            native, launch, shapes, records, *addresses
        )

    def make_launch(self, scene: int, hits: Records, size: tuple[int, int]) -> PtxLaunch:
        launch = super().make_launch(scene, hits, size)
        launch.overflow = STACK_OVERFLOW
        launch.attribute_bytes = self.bound.programs.layout.attribute_bytes
        return launch

    def _records(self, instance: int) -> Records:
        count = len(self.bound.types)
        return self.hits[instance * count : (instance + 1) * count]

    def _material_names(self, name: str) -> set[str]:
        mapped = self._material(name)
        return {name} | (mapped.names if mapped is not None else set())

    def _material(self, name: str) -> RenderMaterial | None:
        setup = self.setup
        return setup.materials[name] or setup.world.materials.get(DEFAULT_LIBRARY, name)

    def _write_values(self, record: NDArray[np.uint8], values: Values) -> None:
        """Write those values that are variables of the programs into a record."""
        layout = self.bound.programs.layout
        for name, value in values.items():
            variable = layout.variables.get(name)
            if variable is None:
                continue
            if variable.kind == BUFFER and isinstance(value, np.ndarray):
                data = _pack_buffer(value)
            elif variable.kind == TEXTURE and isinstance(value, int):
                data = struct.pack("<Q", value)
            elif variable.kind == PLAIN and isinstance(value, bytes):
                data = value[: variable.size].ljust(variable.size, b"\0")
            else:
                continue
            at = RECORD_HEADER + layout.offsets[name]
            record[at : at + len(data)] = np.frombuffer(data, np.uint8)

    def prepare_launch(self, frame: PtxFrame) -> PtxLaunch:
        pass_, pack = self.setup.pass_, self.resources.pack_value
        self.resources.begin_frame()
        values = self._context_values(frame)
        for node in pass_.rtGlobalParams:
            values[node.name or ""] = pack(frame.gpu, node, samples=frame.samples)
        for record in [*self.bound.context, *self.bound.misses]:
            self._write_values(record, values)
        for at, instance in enumerate(self.instances):
            material = self._material(instance.material)
            own = values | self._texture_values(frame.gpu, material) | instance.buffers
            for node in pass_.rtMaterialParams:
                own[node.name or ""] = pack(frame.gpu, node, material, frame.samples)
            first, *others = self._records(at)
            self._write_values(first, own)
            for record in others:
                record[RECORD_HEADER:] = first[RECORD_HEADER:]
        return self.make_launch(self.handle, self.hits, (frame.width, frame.height))

    def _context_values(self, frame: PtxFrame) -> Values:
        """Return the values of the context: camera, ray types, inputs and outputs."""
        camera = frame.camera
        vectors = {
            "eye": camera.position,
            "U": camera.right,
            "V": camera.true_up,
            "W": camera.forward,
            "fov": np.array([tan(radians(camera.values["FOV"]) / 2)]),
        }
        values: Values = {n: np.asarray(v, np.float32).tobytes() for n, v in vectors.items()}
        values["top_object"] = struct.pack("<I", 1 if self.instances else 0)
        values |= {name: struct.pack("<i", at) for at, name in enumerate(self.bound.types)}
        for source in self.setup.pass_.rtInput:
            image = self.resources.copy_texture(frame.gpu, source.texture or "", by_texel=True)
            variable = self.bound.programs.layout.variables.get(source.var or "")
            if image is not None and variable is not None:
                texels = image.texels
                values[source.var or ""] = image.handle if variable.kind == TEXTURE else texels
        for output in frame.outputs:
            values[output.name] = self._output_buffer(output)
        return values

    def _output_buffer(self, output: OutputFormat) -> NDArray[Any]:
        """Return the buffer of an output, which keeps its content from frame to frame."""
        dtype = np.float32 if output.dtype == np.float16 else output.dtype
        shape = (output.height, output.width, output.channels)
        held = self.outputs.get(output.name)
        if held is None or held.shape != shape:
            held = self.outputs[output.name] = np.zeros(shape, dtype)
        return held

    def _texture_values(self, gpu: GpuAccess, material: RenderMaterial | None) -> Values:
        found: Values = {}
        for unit, binding in (material.textures if material else {}).items():
            image = self.resources.load_image(gpu, binding.texture, binding.path, binding)
            if image is None and binding.path is None:
                image = self.resources.copy_texture(gpu, binding.texture)
            if image is not None and unit < TEXTURE_UNITS:
                found[f"tex{unit}"] = image.handle
        return found

    def collect_outputs(self, frame: PtxFrame) -> list[OutputTexels]:
        self.resources.write_buffers(frame.gpu)
        return [
            OutputTexels(output.name, self.outputs[output.name], as_colours=False)
            for output in frame.outputs
        ]

    def notes(self) -> list[str]:
        count = self.kinds.count(CUSTOM)
        if not count:
            return []
        return [
            f"{count} of {len(self.kinds)} geometries are user geometry of their "
            "programs, not triangles: an intersection program runs for each box that a ray meets"
        ]

    def find_nonfinite(self) -> NDArray[np.int64]:
        values = self.outputs.get(FIRST_OUTPUT)
        if values is None or values.dtype.kind != "f":
            return np.zeros(0, np.int64)
        return np.flatnonzero(~np.isfinite(values).all(axis=2))


def _find_geometry(pass_: RaytracePass, kind: str) -> GeometryProgram | None:
    return next((p for p in pass_.rtGeometryProgram if p.type == kind), None)


def _pack_buffer(values: NDArray[Any]) -> bytes:
    """Return a buffer's variable: address, sizes, bytes of an element (``optix.variables``)."""
    *sizes, channels = values.shape
    width, height, depth = [*reversed(sizes), 1, 1, 1][:3]
    element = channels * values.itemsize
    data = struct.pack("<QQQQIi", values.ctypes.data, width, height, depth, element, 0)
    assert len(data) == BUFFER_BYTES
    return data

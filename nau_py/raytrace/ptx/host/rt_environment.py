"""Environment of Nau's class ``rt``: OptiX 7 programs, records and parameters (7.1)."""

from __future__ import annotations

import struct

import numpy as np
from numpy.typing import NDArray

from nau_py.model.library import DEFAULT_LIBRARY
from nau_py.model.raytrace import Program, RayMaterial
from nau_py.raytrace.programs.description import ANY_HIT, CLOSEST_HIT, MISS
from nau_py.raytrace.ptx.host.environment import LaunchEnvironment, bind_programs
from nau_py.raytrace.ptx.host.geometry import collect_groups
from nau_py.raytrace.ptx.host.inputs import (
    FIRST_OUTPUT,
    GpuAccess,
    OutputTexels,
    PassSetup,
    PtxFrame,
)
from nau_py.raytrace.ptx.host.programs import CompiledPrograms
from nau_py.raytrace.ptx.optix.compile import PARAMETERS
from nau_py.raytrace.ptx.optix.records import DATA, RecordMaterial, RtScene
from nau_py.raytrace.ptx.runtime.launch import PtxLaunch

_PAD = 2048
"""Words behind the colour buffer: sample 12 writes up to 1,025 words past its end."""
_PARAMETER_BYTES = 96


class RtEnvironment(LaunchEnvironment):
    """Embree structure, records, machine code and colour buffer of a pass of class ``rt``."""

    def __init__(self, setup: PassSetup, programs: CompiledPrograms) -> None:
        super().__init__(setup)
        self.scene = RtScene(list(collect_groups(setup.world, setup.pass_)))
        self.buffer = np.zeros(_PAD, np.uint32)
        self._last: tuple[bytes, int, int] | None = None
        self.sub_frame = 0
        self._globals = np.zeros(0, np.uint8)
        self.bind(programs)

    def bind(self, programs: CompiledPrograms) -> None:
        pass_ = self.setup.pass_
        types = [t.name or "" for t in pass_.rtRayTypes] or pass_.ray_types
        entries = [pass_.entry([group.material]) for group in self.scene.groups]
        addresses = [
            [
                (
                    programs.address(_find_program(e, types, at, CLOSEST_HIT)),
                    programs.address(_find_program(e, types, at, ANY_HIT)),
                )
                for at in range(len(types))
            ]
            for e in entries
        ]
        first = entries[0] if entries else pass_.rtDefaultMaterial
        self.bound = bind_programs(
            self.setup,
            programs,
            types,
            lambda at: _find_program(first, types, at, MISS),
            DATA.itemsize,
            16,
        )
        self.bound.context[0, -16:-12] = np.frombuffer(np.int32(255).tobytes(), np.uint8)
        self._addresses = addresses

    def prepare_launch(self, frame: PtxFrame) -> PtxLaunch:
        data = self._pack_parameters(frame)
        for native in self.bound.natives:
            native.set_variable(PARAMETERS, data)
        surfaces = [self._material(frame.gpu, group.material) for group in self.scene.groups]
        used = [a.name or "" for a in self.setup.pass_.rtVertexAttributes]
        hits = self.scene.make_records(self._addresses, surfaces, used)
        launch = self.make_launch(self.scene.handle, hits, (frame.width, frame.height))
        launch.callables = np.array(self.bound.programs.callables(), np.uint64)
        return launch

    def collect_outputs(self, frame: PtxFrame) -> list[OutputTexels]:
        """Return the colours, uint8 RGBA. Clears the colour buffer where the pass asks for it."""
        self.resources.write_buffers(frame.gpu)
        words = self.buffer[: frame.width * frame.height].copy()
        if self._pass_value("COLOR_CLEAR") or self.sub_frame == 0:
            self.buffer[:] = 0
        colours = words.view(np.uint8).reshape(frame.height, frame.width, 4)
        return [OutputTexels(FIRST_OUTPUT, colours, as_colours=True)]

    def _pass_value(self, name: str) -> bool | int | float | str:
        return self.setup.project.value(self.setup.pass_, "PASS", name)[0]

    def _material(self, gpu: GpuAccess, name: str) -> RecordMaterial:
        found = self.setup.world.materials.get(DEFAULT_LIBRARY, name)
        if found is None:
            return RecordMaterial()
        colours = found.colours
        image = None
        if found.textures:
            binding = found.textures[min(found.textures)]
            image = self.resources.load_image(gpu, binding.texture, binding.path)
        return RecordMaterial(
            colours["DIFFUSE"],
            colours["SPECULAR"],
            colours["EMISSION"],
            float(colours["SHININESS"][0]),
            image,
        )

    def _pack_parameters(self, frame: PtxFrame) -> bytes:
        """Return the launch parameters of a frame, 96 bytes."""
        camera = frame.camera
        across, up = camera.half_extent(frame.aspect)
        samples = frame.samples or int(self._pass_value("RAYS_PER_PIXEL"))
        depth = int(self._pass_value("MAX_DEPTH"))
        vectors = (camera.position, camera.forward, camera.right * across, camera.true_up * up)
        packed = b"".join(np.asarray(v, np.float32).tobytes() for v in vectors)
        now = (packed, samples, depth)
        changed = self._last is None or self._last[0] != packed
        self.sub_frame = 0 if frame.index == 0 or self._last != now else self.sub_frame + 1
        self._last = now
        size = frame.width * frame.height + _PAD
        if len(self.buffer) != size:
            self.buffer = np.zeros(size, np.uint32)
        self.resources.begin_frame()
        self._globals = self._pack_globals(frame)
        handle = 1 if self.scene.groups else 0
        place = self.buffer.ctypes.data
        head = struct.pack("<iiQii", frame.index, self.sub_frame, place, samples, depth)
        tail = struct.pack("<?7xQQ", changed, handle, self._globals.ctypes.data)
        data = head + packed + tail
        assert len(data) == _PARAMETER_BYTES
        return data

    def _pack_globals(self, frame: PtxFrame) -> NDArray[np.uint8]:
        """Pack the global parameters one after the other, without alignment as Nau does."""
        values = [
            self.resources.pack_value(frame.gpu, node, samples=frame.samples)
            for node in self.setup.pass_.rtGlobalParams
        ]
        # a program with a wrong struct may read some bytes past the end
        return np.frombuffer(b"".join(values) + bytes(256), np.uint8).copy()


def _find_program(
    entry: RayMaterial | None, types: list[str], index: int, kind: str
) -> Program | None:
    """Find the program of a kind for a ray type. A name that is not declared means type 0."""
    for group in entry.rayTypes if entry is not None else []:
        own = types.index(group.name) if group.name in types else 0
        if own == index:
            found = next((p for p in group.programs if p.type == kind), None)
            if found is not None:
                return found
    return None

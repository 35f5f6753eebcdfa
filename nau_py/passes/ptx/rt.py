"""The environment of class ``rt``: OptiX 7 programs, Nau's records and parameters (7.1)."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from nau_py.model.library import DEFAULT_LIBRARY
from nau_py.model.raytrace import Program, RayMaterial, RaytracePass
from nau_py.passes.drawing import camera_context, pass_value, viewport_names
from nau_py.passes.frame import FrameContext, Session, View
from nau_py.passes.ptx.programs import Programs
from nau_py.passes.ptx.resources import Resources
from nau_py.raytrace.programs.description import ANY_HIT, CLOSEST_HIT, MISS
from nau_py.raytrace.ptx.optix.compile import PARAMETERS

if TYPE_CHECKING:
    from nau_py.raster.targets import Target
    from nau_py.raytrace.ptx.optix.records import RecordMaterial, TriangleGroup
    from nau_py.raytrace.ptx.runtime.launch import PtxLaunch
    from nau_py.scene.world import World

_PAD = 2048
"""Words behind the colour buffer: sample 12 writes up to 1,025 of them."""
_PARAMETER_BYTES = 96


class RtState:
    """What such a pass keeps from frame to frame: structure, records, machine code, its buffer.

    As in Nau, geometry is taken as it is at the first frame, and object transforms are not applied
    but where the scene type has baked them in.
    """

    def __init__(self, pass_: RaytracePass, session: Session, programs: Programs) -> None:
        from nau_py.raytrace.ptx.optix.records import RtScene

        self.session = session
        self.resources = Resources(session, pass_)
        self.scene = RtScene(list(groups(session.world, pass_)))
        self.buffer = np.zeros(_PAD, np.uint32)
        self._last: tuple[Any, ...] | None = None
        self.sub_frame = 0
        self._globals = np.zeros(0, np.uint8)
        self.bind(pass_, programs)

    def bind(self, pass_: RaytracePass, programs: Programs) -> None:
        """Compile the programs. Raises :class:`~nau_py.ProgramError`; what was bound then
        stays."""
        from nau_py.raytrace.ptx.optix.records import DATA
        from nau_py.raytrace.ptx.runtime.launch import record_table, set_program

        types = [t.name or "" for t in pass_.rtRayTypes] or pass_.ray_types
        entries = [pass_.entry([group.material]) for group in self.scene.groups]
        addresses = [
            [
                (
                    programs.address(_program(e, types, at, CLOSEST_HIT)),
                    programs.address(_program(e, types, at, ANY_HIT)),
                )
                for at in range(len(types))
            ]
            for e in entries
        ]
        first = entries[0] if entries else pass_.rtDefaultMaterial
        misses = record_table(len(types), DATA.itemsize)
        for index in range(len(types)):
            program = _program(first, types, index, MISS)
            set_program(misses[index], "closest", programs.address(program))
        entry = pass_.rtEntryPoint
        assert entry is not None
        assert entry.rayGen is not None
        begin = programs.address(entry.rayGen)
        self._addresses, self._used = addresses, [a.name or "" for a in pass_.rtVertexAttributes]
        self.exception = programs.address(entry.exception)
        self.misses, self.types, self.programs = misses, types, programs
        self.generate = (programs.native(entry.rayGen), begin)
        self.context = record_table(1, 16)
        self.context[0, -16:-12] = np.frombuffer(np.int32(255).tobytes(), np.uint8)

    def begin(self, pass_: RaytracePass, frame: FrameContext, view: View) -> PtxLaunch:
        """The launch of a frame; the parameters of the programs are written."""
        from nau_py.raytrace.ptx.runtime.launch import PtxLaunch

        data = self._parameters(pass_, frame, view)
        for native in self.programs.natives.values():
            native.set_variable(PARAMETERS, data)
        surfaces = [self._surface(group.material) for group in self.scene.groups]
        return PtxLaunch(
            self.generate,
            self.scene.handle,
            self.scene.records(self._addresses, surfaces, self._used),
            self.misses,
            self.context,
            (view.target.width, view.target.height),
            len(self.types),
            self.exception,
            callables=np.array(self.programs.callables(), np.uint64),
            flush=self.programs.flushes,
        )

    def notes(self) -> list[str]:
        """Nothing: all geometry is triangles."""
        return []

    def odd(self) -> NDArray[np.int64]:
        """None: colours are bytes."""
        return np.zeros(0, np.int64)

    def end(
        self,
        pass_: RaytracePass,
        frame: FrameContext,
        target: Target,
        pixels: NDArray[np.int64] | None,
    ) -> None:
        """Give the colours to the target. ``pixels``: those that the mask selects; the others get
        the clear value."""
        from nau_py.passes.tracing.textures import store_selected

        self.resources.give_back()
        count = target.width * target.height
        words = self.buffer[:count].view(np.uint8).reshape(target.height, target.width, 4)
        store_selected(target, np.arange(count) if pixels is None else pixels, words)
        if pass_value(frame.project, pass_, "COLOR_CLEAR") or self.sub_frame == 0:
            self.buffer[:] = 0

    def _surface(self, name: str) -> RecordMaterial:
        from nau_py.raytrace.ptx.optix.records import RecordMaterial

        found = self.session.world.materials.get(DEFAULT_LIBRARY, name)
        if found is None:
            return RecordMaterial()
        colours = found.colours
        image = None
        if found.textures:
            binding = found.textures[min(found.textures)]
            image = self.resources.image(binding.texture, binding.path)
        return RecordMaterial(
            colours["DIFFUSE"],
            colours["SPECULAR"],
            colours["EMISSION"],
            float(colours["SHININESS"][0]),
            image,
        )

    def _parameters(self, pass_: RaytracePass, frame: FrameContext, view: View) -> bytes:
        """The launch parameters of a frame, 96 bytes."""
        camera, target = view.camera, view.target
        aspect = target.width / target.height
        if viewport_names(pass_):
            aspect = view.rect.aspect
        across, up = camera.half_extent(aspect)
        samples = frame.session.options.samples
        rays = samples or int(pass_value(frame.project, pass_, "RAYS_PER_PIXEL"))
        depth = int(pass_value(frame.project, pass_, "MAX_DEPTH"))
        vectors = (camera.position, camera.forward, camera.right * across, camera.true_up * up)
        packed = b"".join(np.asarray(v, np.float32).tobytes() for v in vectors)
        now = (packed, rays, depth)
        changed = self._last is None or self._last[0] != packed
        self.sub_frame = 0 if frame.index == 0 or self._last != now else self.sub_frame + 1
        self._last = now
        size = target.width * target.height + _PAD
        if len(self.buffer) != size:
            self.buffer = np.zeros(size, np.uint32)
        context = camera_context(pass_, frame, view)
        self.resources.begin_frame()
        values = [self.resources.packed(node, context) for node in pass_.rtGlobalParams]
        # back to back, nothing is aligned; a mistaken struct may read some bytes more
        self._globals = np.frombuffer(b"".join(values) + bytes(256), np.uint8).copy()
        handle = 1 if self.scene.groups else 0
        place = self.buffer.ctypes.data
        head = struct.pack("<iiQii", frame.index, self.sub_frame, place, rays, depth)
        tail = struct.pack("<?7xQQ", changed, handle, self._globals.ctypes.data)
        data = head + packed + tail
        assert len(data) == _PARAMETER_BYTES
        return data


def _program(entry: RayMaterial | None, types: list[str], index: int, kind: str) -> Program | None:
    """The program of a kind for a ray type. A name that is not declared means the first one."""
    for group in entry.rayTypes if entry is not None else []:
        own = types.index(group.name) if group.name in types else 0
        if own == index:
            found = next((p for p in group.programs if p.type == kind), None)
            if found is not None:
                return found
    return None


def groups(world: World, pass_: RaytracePass) -> Iterator[TriangleGroup]:
    """The objects by name, each material by name, in byte order; of a name the last counts."""
    from nau_py.raytrace.ptx.optix.records import TriangleGroup

    objects = {o.name: o for o in world.objects(pass_.scene_names)}
    for name in sorted(objects, key=str.encode):
        mesh = objects[name].mesh
        if mesh.primitive != "TRIANGLES" or mesh.buffers:
            continue
        attributes = {k: np.ascontiguousarray(v, np.float32) for k, v in mesh.attributes.items()}
        parts: dict[str, list[NDArray[np.uint32]]] = {}
        for group in mesh.groups:
            parts.setdefault(group.material, []).append(group.indices)
        for material in sorted(parts, key=str.encode):
            indices = np.concatenate(parts[material])
            if len(indices):
                yield TriangleGroup(material, attributes, np.ascontiguousarray(indices, np.uint32))

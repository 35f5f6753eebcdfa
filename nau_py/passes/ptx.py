"""Class ``rt`` with the OptiX programs that a project ships: PTX, run natively (7.1)."""

from __future__ import annotations

import os
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from nau_py.diagnostic import Diagnostic, error, warning
from nau_py.errors import ProgramError
from nau_py.model.builtins import ANY_HIT, CLOSEST_HIT, MISS
from nau_py.model.library import DEFAULT_LIBRARY
from nau_py.model.linked import Project
from nau_py.model.maps import matches
from nau_py.model.raytrace import Program, RayMaterial, RaytracePass, RayVariable
from nau_py.model.texture import Texture
from nau_py.paths import resolve as resolve_path
from nau_py.raytrace.ptx.compile import compile_all
from nau_py.raytrace.ptx.reader import Module, PtxError, read_ptx

if TYPE_CHECKING:
    from nau_py.passes.frame import FrameContext, PassRecord, RunOptions, Session
    from nau_py.raster.targets import Target
    from nau_py.raytrace.ptx.launch import Group, Image, Surface
    from nau_py.raytrace.ptx.native import Native
    from nau_py.scene.world import World

ENDING = ".ptx"
MARKS = "NAU_PTX_MARKS"
"""The variable that names the file of a guarding process."""
SLOTS = 64
"""Of that file: 64-bit words of text, and launch indices in work."""
_PAD = 2048
"""Words behind the colour buffer: sample 12 writes up to 1,025 of them."""
_PARAMETER_BYTES = 96
_GLOBAL_BYTES = 64 * 1024


def runs_ptx(pass_: RaytracePass, folder: Path, programs: str = "") -> bool:
    """Whether a pass runs its compiled programs. ``programs``: ``ptx`` or ``py``, else what the
    project has: those of class ``rt`` that are there, but for Python files that stand in."""
    generate = pass_.rtEntryPoint.rayGen if pass_.rtEntryPoint else None
    file = (generate.file if generate else None) or ""
    if pass_.class_ != "rt" or not file.lower().endswith(ENDING):
        return False
    found = resolve_path(folder, file)
    beside = resolve_path(folder, file.replace("\\", "/")[: -len(ENDING)] + ".py")
    if programs == "py" or (beside.exists and programs != "ptx"):
        return False
    return found.exists


def used_programs(pass_: RaytracePass) -> Iterator[Program]:
    """Every program that a pass can run."""
    entry = pass_.rtEntryPoint
    if entry is not None and entry.rayGen is not None:
        yield entry.rayGen
    for material in pass_.materials:
        for group in material.rayTypes:
            yield from group.programs


def ptx_faults(project: Project, pass_: RaytracePass) -> Iterator[Diagnostic]:
    """What of a pass's compiled programs cannot be run: by reading them only."""
    label = f"pass '{pass_.name}'"
    seen: set[Path] = set()
    for program in used_programs(pass_):
        path = resolve_path(project.folder, program.file or "").best
        if path in seen or path.suffix.lower() != ENDING or not path.exists():
            continue
        seen.add(path)
        for where, said in _errors(path):
            yield error("T015", program.where("file"), f"{label}: {path.name}:{where}: {said}")


def _errors(path: Path) -> list[tuple[int, str]]:
    try:
        _, errors = compile_all(read_ptx(path.read_text("utf-8", "replace")))
    except PtxError as problem:
        return [(problem.line, str(problem))]
    except OSError as problem:
        return [(1, problem.strerror or str(problem))]
    return [(e.line, str(e)) for e in errors]


class PtxState:
    """What such a pass keeps from frame to frame: structure, records, machine code, its buffer.

    As in Nau, geometry is taken as it is at the first frame, and object transforms are not applied
    but where the scene type has baked them in.
    """

    def __init__(self, pass_: RaytracePass, session: Session) -> None:
        from nau_py.raytrace.ptx.launch import Scene

        self.session = session
        self.shading = _NoShading()
        self._images: dict[str, Image | None] = {}
        self._now: list[Image] = []
        """Textures that were read back for this frame: programs have their addresses."""
        self._buffers: dict[str, Any] = {}
        self.scene = Scene(list(_groups(session.world, pass_)))
        self.buffer = np.zeros(_PAD, np.uint32)
        self._last: tuple[Any, ...] | None = None
        self.sub_frame = 0
        self.globals = np.zeros(_GLOBAL_BYTES, np.uint8)
        self.bind(pass_)

    def bind(self, pass_: RaytracePass) -> None:
        """Compile the programs. Raises :class:`~nau_py.errors.ProgramError`; what was bound then
        stays."""
        from nau_py.raytrace.ptx.launch import RECORD

        modules: dict[Path, tuple[Module, Native]] = {}
        types = [t.name or "" for t in pass_.rtRayTypes] or pass_.ray_types
        entries = [self._entry(pass_, group.material) for group in self.scene.groups]
        addresses = [
            [
                (
                    self._address(modules, _program(e, types, at, CLOSEST_HIT)),
                    self._address(modules, _program(e, types, at, ANY_HIT)),
                )
                for at in range(len(types))
            ]
            for e in entries
        ]
        first = entries[0] if entries else pass_.rtDefaultMaterial
        misses = np.zeros(max(len(types), 1), RECORD)
        for index in range(len(types)):
            program = _program(first, types, index, MISS)
            misses[index]["closest"] = self._address(modules, program)
        assert pass_.rtEntryPoint is not None
        generate = pass_.rtEntryPoint.rayGen
        begin = self._address(modules, generate)
        assert generate is not None
        native = modules[resolve_path(self.session.project.folder, generate.file or "").best][1]
        self._addresses, self._used = addresses, [a.name or "" for a in pass_.rtVertexAttributes]
        self.misses, self.types, self.modules = misses, types, modules
        self.generate = (native, begin)

    def hits(self) -> Any:
        """The hit records with the materials as they are in this frame."""
        surfaces = [self._surface(group.material) for group in self.scene.groups]
        return self.scene.records(self._addresses, surfaces, self._used)

    def _entry(self, pass_: RaytracePass, name: str) -> RayMaterial | None:
        """The exact entry, the first prefix in byte order, else the default's."""
        for node in pass_.rtMaterialMap:
            if node.to == name:
                return node
        prefixed = [n for n in pass_.rtMaterialMap if n.to and n.to.endswith("*")]
        for node in sorted(prefixed, key=lambda n: (n.to or "").encode()):
            if matches(node.to or "", name):
                return node
        return pass_.rtDefaultMaterial

    def _address(self, modules: dict[Path, tuple[Module, Native]], program: Program | None) -> int:
        """The address of a procedure; 0 for none."""
        from nau_py.passes.tracing import trust_rule
        from nau_py.raytrace.ptx.native import Native, NotNative

        if program is None:
            return 0
        path = resolve_path(self.session.project.folder, program.file or "").best
        label = f"project '{self.session.project.name}', program '{program.proc}'"
        if path not in modules:
            trust_rule(self.session).check(path, program.where("file"), label)
            try:
                module = read_ptx(path.read_text("utf-8", "replace"))
                text, errors = compile_all(module)
            except (OSError, PtxError) as problem:
                message = f"{label}: '{path.name}' cannot be read: {problem}"
                raise ProgramError(error("T015", program.where("file"), message)) from None
            if errors:
                message = f"{label}: {path.name}:{errors[0].line}: {errors[0]}"
                raise ProgramError(error("T015", program.where("file"), message))
            try:
                modules[path] = (module, Native(text))
            except NotNative as problem:
                message = f"{label}: '{path.name}' gives no machine code: {problem}"
                raise ProgramError(error("T015", program.where("file"), message)) from None
        module, native = modules[path]
        function = module.functions.get(program.proc or "")
        if function is None or function.body is None:
            message = f"{label}: '{path.name}' exports no '{program.proc}'"
            raise ProgramError(error("T004", program.where("proc"), message))
        return native.address(function.name)

    def _surface(self, name: str) -> Surface:
        from nau_py.raytrace.ptx.launch import Surface

        found = self.session.world.materials.get(DEFAULT_LIBRARY, name)
        if found is None:
            return Surface()
        colours = found.colours
        image = None
        if found.textures:
            binding = found.textures[min(found.textures)]
            image = self._image(binding.texture, binding.path)
        return Surface(
            colours["DIFFUSE"],
            colours["SPECULAR"],
            colours["EMISSION"],
            float(colours["SHININESS"][0]),
            image,
        )

    def _image(self, name: str, path: Path | None = None) -> Image | None:
        """A texture of the project or of a model; None, with a finding, where it has no file."""
        from nau_py.raytrace.ptx.launch import Image
        from nau_py.scene.images import ImageError

        key = str(path) if path is not None else name
        if key not in self._images:
            if path is None:
                node = self.session.project.names("texture").get(name)
                if isinstance(node, Texture) and node.filename:
                    path = resolve_path(Path(node.location.file).parent, node.filename).best
            self._images[key] = None
            try:
                if path is not None:
                    self._images[key] = Image(_texels(path))
            except (ImageError, OSError, ValueError) as problem:
                where = self.session.project.file.location
                said = f"texture '{name}': {problem}; rays see none"
                self.session.resources.diagnostics.append(warning("F004", where, said))
        return self._images[key]

    def _memory(self, name: str) -> int:
        """The address of a copy of a GPU buffer, which :meth:`give_back` writes back, or 0."""
        buffer = self.session.resources.buffer(name)
        if buffer is None:
            return 0
        if name not in self._buffers:
            self._buffers[name] = np.frombuffer(bytearray(buffer.read()), np.uint8)
        return int(self._buffers[name].ctypes.data)

    def give_back(self) -> None:
        """Write the buffers that programs may have changed."""
        for name, data in self._buffers.items():
            self.session.resources.buffer(name).write(data.tobytes())

    def _drawn(self, name: str) -> Image | None:
        """A texture that passes write, as it is in this frame."""
        from nau_py.raster import gl
        from nau_py.raytrace.ptx.launch import Image

        texture = self.session.resources.texture(name)
        if texture is None:
            return None
        format_ = texture.format
        shape = (max(texture.layers, 1), texture.height, texture.width, format_.channels)
        out = np.empty(shape, format_.dtype)
        gl.read_texture(texture.glo, 0, format_.layout, format_.kind, out)
        values = out if format_.dtype == np.uint8 else out.astype(np.float32)
        self._now.append(Image(values[0] if len(values) == 1 else values))
        return self._now[-1]

    def parameters(self, pass_: RaytracePass, frame: FrameContext, target: Target) -> bytes:
        """The launch parameters of a frame, 96 bytes."""
        from nau_py.passes.drawing import pass_value, viewport_names

        camera = frame.camera
        aspect = target.width / target.height
        if viewport_names(pass_):
            aspect = frame.rect.aspect
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
        self._globals(pass_, frame, target)
        handle = 1 if self.scene.groups else 0
        place = self.buffer.ctypes.data
        head = struct.pack("<iiQii", frame.index, self.sub_frame, place, rays, depth)
        tail = struct.pack("<?7xQQ", changed, handle, self.globals.ctypes.data)
        data = head + packed + tail
        assert len(data) == _PARAMETER_BYTES
        return data

    def _globals(self, pass_: RaytracePass, frame: FrameContext, target: Target) -> None:
        """The block of ``rtGlobalParams``: back to back, nothing is aligned."""
        from nau_py.passes.drawing import camera_context

        context = camera_context(pass_, frame, target)
        self._now = []
        self._buffers = {}
        data = b"".join(self._packed(node, context) for node in pass_.rtGlobalParams)
        self.globals[: len(data)] = np.frombuffer(data[:_GLOBAL_BYTES], np.uint8)

    def _packed(self, node: RayVariable, context: Any) -> bytes:
        from nau_py.raster.semantics import resolve

        type_, name, component = node.type or "", node.context or "CURRENT", node.component or ""
        if type_ == "TEXTURE" and component == "ID":
            image = self._image(name) or self._drawn(name)
            return struct.pack("<Q", image.handle if image is not None else 0)
        if type_ == "BUFFER" and component == "ID":
            return struct.pack("<Q", self._memory(name))
        set_ = self.session.project.registry.get(type_)
        attribute = set_.get(component) if set_ is not None else None
        value = resolve(context, type_, name, component, node.id or 0)
        if attribute is None or value is None:
            count = attribute.type.components if attribute is not None else 1
            said = f"parameter '{node.name}' of pass: {type_} '{name}' has no {component}; it is 0"
            self.session.resources.diagnostics.append(warning("L007", node.location, said))
            return bytes(4 * count)
        whole = attribute.type.is_integer or attribute.type.is_boolean
        return np.asarray(value).astype(np.int32 if whole else np.float32).tobytes()


def _texels(path: Path) -> Any:
    """Bytes of an image; of a volume floats, read by the nearest point."""
    from nau_py.scene.images import load_image
    from nau_py.scene.volume import is_volume, load_volume

    if not is_volume(path):
        return load_image(path)
    values = load_volume(path)
    scale = 255.0 if values.dtype == np.uint8 else 1.0
    return (values.astype(np.float32) / scale)[..., None]


class _NoShading:
    def forget(self) -> None:
        """Compiled programs call no GLSL."""


def _program(entry: RayMaterial | None, types: list[str], index: int, kind: str) -> Program | None:
    """The program of a kind for a ray type. A name that is not declared means the first one."""
    for group in entry.rayTypes if entry is not None else []:
        own = types.index(group.name) if group.name in types else 0
        if own == index:
            found = next((p for p in group.programs if p.type == kind), None)
            if found is not None:
                return found
    return None


def _groups(world: World, pass_: RaytracePass) -> Iterator[Group]:
    """The objects by name, each material by name, in byte order; of a name the last counts."""
    from nau_py.raytrace.ptx.launch import Group

    objects = {o.name: o for o in world.objects(pass_.scene_names)}
    for name in sorted(objects, key=str.encode):
        mesh = objects[name].mesh
        if mesh.primitive != "TRIANGLES" or mesh.buffers:
            continue
        attributes = {k: np.ascontiguousarray(v, np.float32) for k, v in mesh.attributes.items()}
        parts: dict[str, list[Any]] = {}
        for group in mesh.groups:
            parts.setdefault(group.material, []).append(group.indices)
        for material in sorted(parts, key=str.encode):
            indices = np.concatenate(parts[material])
            if len(indices):
                yield Group(material, attributes, np.ascontiguousarray(indices, np.uint32))


def ptx_state(pass_: RaytracePass, session: Session) -> PtxState:
    key = pass_.name or ""
    if key not in session.tracers:
        session.tracers[key] = PtxState(pass_, session)
    found = session.tracers[key]
    assert isinstance(found, PtxState)
    return found


def marks(pass_: RaytracePass, project: Project, width: int) -> Any:
    """Where a guarding process sees what is being run (``nau_py.cli.guard``); None without one."""
    path = os.environ.get(MARKS)
    if not path:
        return None
    generate = pass_.rtEntryPoint.rayGen if pass_.rtEntryPoint else None
    about = f"project '{project.name}', pass '{pass_.name}', program '{generate and generate.proc}'"
    words = np.memmap(path, np.int64, "r+", shape=(2 * SLOTS,))
    text = f"{width}\n{about}".encode()[: 8 * SLOTS]
    words[:SLOTS] = np.frombuffer(text.ljust(8 * SLOTS, b"\0"), np.int64)
    words[SLOTS:] = -1
    return words[SLOTS:]


def execute_ptx(pass_: RaytracePass, frame: FrameContext, record: PassRecord) -> None:
    """Launch the pass's programs over its target."""
    from nau_py.passes.drawing import pass_value, process, target_and_rect
    from nau_py.passes.stages import Stages
    from nau_py.raytrace.ptx.launch import fill, launch

    frame.camera = frame.world.camera(pass_.camera_name)
    target, frame.rect = target_and_rect(pass_, frame, uses_camera=True)
    process(pass_.preProcess, frame)
    stages = Stages(record)
    options: RunOptions = frame.session.options
    state = ptx_state(pass_, frame.session)
    data = state.parameters(pass_, frame, target)
    for _, native in state.modules.values():
        fill(native, data)
    hits = state.hits()
    stages.end("build")
    width, height = target.width, target.height
    name, progress = pass_.name or "", frame.session.progress
    counts = launch(
        state.generate,
        state.scene,
        hits,
        state.misses,
        (width, height),
        options.threads,
        lambda done, total: progress(name, done, total),
        any(module.flushes for module, _ in state.modules.values()),
        marks(pass_, frame.project, width),
    )
    stages.end("trace")
    state.give_back()
    words = state.buffer[: width * height].reshape(height, width)
    pixels = np.stack([words >> shift & 255 for shift in (0, 8, 16, 24)], axis=-1)
    texture = target.textures[target.colors[0].name]
    texture.write_values(pixels[:, :, : texture.format.channels].astype(np.float32) / 255)
    if pass_value(frame.project, pass_, "COLOR_CLEAR") or state.sub_frame == 0:
        state.buffer[:] = 0
    stages.end("read_back")
    process(pass_.postProcess, frame)
    record.pixels = width * height
    record.rays = {
        (state.types[i] if i < len(state.types) else f"type {i}"): int(n)
        for i, n in enumerate(counts)
        if n
    }

"""What a raytrace pass keeps from frame to frame, and what it reads and writes in one."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from nau_py.diagnostics.diagnostic import warning
from nau_py.model.library import DEFAULT_LIBRARY
from nau_py.model.linked import Project
from nau_py.model.raytrace import Program, RaytracePass, RayVariable, component
from nau_py.model.raytrace import RayMaterial as RayMaterialNode
from nau_py.model.texture import Texture
from nau_py.passes.drawing import camera_context, pass_value
from nau_py.passes.effects import decisions, pass_facts
from nau_py.passes.frame import FrameContext, Session, View
from nau_py.passes.material_shading import MaterialShading
from nau_py.plugins import program_files
from nau_py.process.paths import resolve as resolve_path
from nau_py.raster.semantics import resolve
from nau_py.raytrace.programs.description import (
    ANY_HIT,
    CLOSEST_HIT,
    EXCEPTION,
    MISS,
    RAY_GENERATION,
)
from nau_py.raytrace.tracing.accelerator import Accelerator
from nau_py.raytrace.tracing.batches import RayLight, RayMaterial
from nau_py.raytrace.tracing.dispatch import Estimate, LaunchResult, Work
from nau_py.raytrace.tracing.face_faults import face_faults
from nau_py.raytrace.tracing.geometry import RayGeometry, gather
from nau_py.raytrace.tracing.main_thread import MainThread
from nau_py.raytrace.tracing.program_loader import ProgramLoader, TrustRule
from nau_py.raytrace.tracing.ray_texture import RayTexture
from nau_py.raytrace.tracing.scene_tables import ProgramTable, Scene, TexelStore, TraceSettings
from nau_py.scene.images import ImageError, load_image
from nau_py.scene.material import RenderMaterial, TextureBinding

if TYPE_CHECKING:
    from nau_py.raster.targets import Target


class TracingState:
    """What a raytrace pass keeps from frame to frame: geometry, programs, textures."""

    def __init__(self, pass_: RaytracePass, session: Session) -> None:
        self.session = session
        self._pass = pass_
        objects = session.world.objects(pass_.scene_names)
        self.geometry: RayGeometry = gather(objects, session.world.moved)
        session.resources.diagnostics += face_faults(pass_, objects, self.geometry.dropped)
        self.accelerator: Accelerator = Accelerator(self.geometry)
        self._moves, self._moved = session.world.moves, session.world.moved
        self.texels = TexelStore()
        self.loaded = False
        self._kept: tuple[bytes, Estimate] | None = None
        self._textures: dict[TextureBinding, RayTexture | None] = {}
        self.mapped = session.pass_materials(pass_)
        self.service = MainThread()
        solid = [o for o in objects if o.mesh.primitive == "TRIANGLES"]
        self.shading = MaterialShading(solid, self.mapped, self.service)
        self.label = f"project '{session.project.name}', pass '{pass_.name}'"
        self.reload_programs()

    def reload_shaders(self, files: set[Path]) -> None:
        """Make the GLSL programs that shade hits again at the next hit."""
        self.shading.forget()

    def close(self) -> None:
        """Do nothing: geometry and programs are freed with the state."""

    def reload_programs(self) -> None:
        """Load the programs of the pass, the first time or again. Raises
        :class:`~nau_py.ProgramError`; the programs loaded before then stay in use."""
        pass_ = self._pass
        loader = _loader(self.session, {(CLOSEST_HIT, "material"): self.shading})
        entry, label = pass_.rtEntryPoint, self.label
        assert entry is not None
        generate = entry.rayGen or Program(file="builtin", proc="pinhole")
        generation = loader.load(
            generate, f"{label}, ray generation program '{generate.proc}'", RAY_GENERATION
        )
        exception = None
        if entry.exception is not None:
            what = f"{label}, exception program '{entry.exception.proc}'"
            exception = loader.load(entry.exception, what, EXCEPTION)
        programs = self._bind(pass_, loader)
        self.generate, self.exception, self.programs = generation, exception, programs
        self._kept = None

    def update(self, pass_: RaytracePass) -> None:
        """Follow what was moved since the last frame: only what moves is built anew."""
        world = self.session.world
        if world.moves == self._moves:
            return
        objects, centre = world.objects(pass_.scene_names), self.geometry.centre
        self.geometry = gather(objects, world.moved, centre)
        if world.moved == self._moved:
            self.accelerator.rebuild_moving(self.geometry)
        else:
            self.accelerator = Accelerator(self.geometry)
        self._moves, self._moved = world.moves, world.moved
        self._kept = None

    def kept(self, work: Work, pixels: NDArray[np.int64]) -> LaunchResult:
        """What earlier frames sampled, if camera, mask, lights and materials are as they were."""
        tables = work.scene.tables
        parts = [work.camera, pixels, tables.arrays["lights"], tables.arrays["materials"]]
        key = b"".join(part.tobytes() for part in parts)
        if self._kept is None or self._kept[0] != key:
            self._kept = (key, Estimate.empty(len(pixels)))
        return LaunchResult(self._kept[1])

    def _render_material(self, name: str) -> RenderMaterial | None:
        return self.mapped[name] or self.session.world.materials.get(DEFAULT_LIBRARY, name)

    def entry(self, pass_: RaytracePass, name: str) -> RayMaterialNode | None:
        """The programs of a material: its exact entry, a prefix's, else the default's (7.1)."""
        mapped = self.mapped[name]
        return pass_.entry({name} | (mapped.names if mapped is not None else set()))

    def _bind(self, pass_: RaytracePass, loader: ProgramLoader) -> ProgramTable:
        table: ProgramTable = {}
        count = len(self.geometry.materials)
        entries = [self.entry(pass_, name) for name in self.geometry.materials]
        for ray_type in pass_.ray_types:
            for kind in (CLOSEST_HIT, ANY_HIT):
                table[ray_type, kind] = [None] * count
            for index, (name, entry) in enumerate(zip(self.geometry.materials, entries)):
                for kind in (CLOSEST_HIT, ANY_HIT):
                    node = entry.program(ray_type, kind) if entry else None
                    if node is not None:
                        label = (
                            f"{self.label}, material '{name}', {kind} program '{node.proc}' of "
                            f"ray type '{ray_type}'"
                        )
                        table[ray_type, kind][index] = loader.load(node, label, kind)
            default = pass_.rtDefaultMaterial
            miss = default.program(ray_type, MISS) if default else None
            if miss is not None:
                label = f"{self.label}, MISS program '{miss.proc}' of ray type '{ray_type}'"
                table[ray_type, MISS] = [loader.load(miss, label, MISS)]
        return table

    def _texture(self, binding: TextureBinding) -> RayTexture | None:
        if binding not in self._textures:
            path = binding.path or _library_image(self.session.project, binding.texture)
            made = None
            if path is not None:
                settings = {name: str(parts[0]) for name, parts in binding.sampler if parts}
                border = dict(binding.sampler).get("BORDER_COLOR", (0.0,) * 4)
                r, g, b, a = (*(float(v) for v in border), 0.0)[:4]
                try:
                    made = RayTexture(
                        load_image(path),
                        settings.get("WRAP_S", "REPEAT"),
                        settings.get("WRAP_T", "REPEAT"),
                        settings.get("MAG_FILTER") == "NEAREST",
                        (r, g, b, a),
                    )
                except ImageError as problem:
                    message = f"texture '{binding.texture}': {problem}; rays see it as white"
                    where = self.session.project.file.location
                    self.session.resources.diagnostics.append(warning("F004", where, message))
            self._textures[binding] = made
        return self._textures[binding]

    def scene(
        self,
        pass_: RaytracePass,
        frame: FrameContext,
        view: View,
        inputs: dict[str, NDArray[Any]],
    ) -> Scene:
        """The scene of this frame: materials, lights and parameters resolved."""
        lights = [RayLight(light.name, light.values) for light in frame.lights(pass_)]
        context = camera_context(pass_, frame, view)
        self.shading.context = context
        materials = []
        for name in self.geometry.materials:
            render = self._render_material(name)
            context.material = render
            materials.append(self._material(pass_, name, render, context))
        context.material = None
        depth = int(pass_value(frame.project, pass_, "MAX_DEPTH"))
        entries = [self.entry(pass_, name) for name in self.geometry.materials]
        self.facts = pass_facts(
            pass_, frame.project, entries, materials, frame.lights(pass_), view.camera, depth
        )
        self.decisions, self.simulated = decisions(self.facts, frame)
        return Scene(
            self.geometry,
            self.accelerator,
            materials,
            self.programs,
            lights,
            _variables(pass_.rtGlobalParams, context),
            inputs,
            pass_.ray_types,
            TraceSettings(
                depth,
                frame.session.options.seed,
                int(pass_value(frame.project, pass_, "LIGHT_SAMPLES")),
                float(pass_value(frame.project, pass_, "OCCLUSION_DISTANCE")),
                view.rect.clear if view.target.name == "window" else view.target.clear,
                self.simulated,
            ),
            self.texels,
        )

    def _material(
        self, pass_: RaytracePass, name: str, render: RenderMaterial | None, context: Any
    ) -> RayMaterial:
        if render is None:
            return RayMaterial(name, {}, {})
        textures = {
            unit: made
            for unit, binding in render.textures.items()
            if (made := self._texture(binding)) is not None
        }
        variables = _variables(pass_.rtMaterialParams, context)
        return RayMaterial(name, render.colours, textures, variables)


def trust_rule(session: Session) -> TrustRule:
    """Where programs of a project may be loaded from."""
    project, options = session.project, session.options
    package = Path(__file__).resolve().parent.parent
    folders = [project.folder, package]
    folders += [Path(lib.file).parent for lib in project.libraries if lib.file]
    folders += [Path(folder) for folder in options.allow_programs]
    files = tuple(program_files().values())
    return TrustRule(tuple(folders), options.no_programs, files)


def _loader(session: Session, provided: dict[tuple[str, str], Callable[..., Any]]) -> ProgramLoader:
    return ProgramLoader(session.project.folder, trust_rule(session), provided)


def _library_image(project: Project, name: str) -> Path | None:
    """The image file of a library texture; None for one without a file."""
    node = project.names("texture").get(name)
    if isinstance(node, Texture) and node.filename:
        return resolve_path(Path(node.location.file).parent, node.filename).best
    return None


def _variables(nodes: list[RayVariable], context: Any) -> dict[str, NDArray[Any]]:
    values: dict[str, NDArray[Any]] = {}
    for node in nodes:
        if node.name and node.type and node.component:
            value = resolve(
                context, node.type, node.context or "CURRENT", node.component, node.id or 0
            )
            if value is not None:
                values[node.name] = value
    return values


def read_inputs(pass_: RaytracePass, frame: FrameContext) -> dict[str, NDArray[Any]]:
    """The input textures by variable name, (height, width, channels), row 0 at the bottom."""
    found: dict[str, NDArray[Any]] = {}
    for source in pass_.rtInput:
        texture_ = frame.session.resources.texture(source.texture or "")
        if source.var and texture_ is not None:
            found[source.var] = texture_.read_values()
    return found


def force_mask(pass_: RaytracePass, frame: FrameContext, weight: float) -> None:
    """Write ``weight`` over the mask of the pass, for whoever reads it."""
    source = pass_.mask
    found = frame.session.resources.texture(source.texture or "") if source else None
    if source is None or found is None:
        return
    values = found.read_values().copy()
    values[:, :, component(source.mask, values.shape[2])] = weight
    found.write_values(values)


def read_mask(pass_: RaytracePass, inputs: dict[str, NDArray[Any]]) -> NDArray[Any] | None:
    values = inputs.get(pass_.mask.var or "") if pass_.mask else None
    if values is None:
        return None
    named = pass_.mask.mask if pass_.mask else None
    return values[:, :, component(named, values.shape[2])]


def store_colours(target: Target, pixels: NDArray[np.int64], colours: NDArray[np.float32]) -> None:
    """Scatter colours into the first colour texture; the other pixels get the clear value."""
    texture_ = target.textures[target.colors[0].name]
    count = target.width * target.height
    image = np.empty((count, 4), np.float32)
    image[:] = target.clear
    image[pixels] = colours
    channels = texture_.format.channels
    shaped = image.reshape(target.height, target.width, 4)[:, :, :channels]
    texture_.write_values(shaped)


def store_selected(target: Target, pixels: NDArray[np.int64], values: NDArray[Any]) -> None:
    """As :func:`store_colours`, of a whole image (height, width, channels): floats, or bytes."""
    chosen = values.reshape(-1, values.shape[2])[pixels].astype(np.float32)
    colours = np.zeros((len(pixels), 4), np.float32)
    colours[:, : values.shape[2]] = chosen / 255 if values.dtype == np.uint8 else chosen
    store_colours(target, pixels, colours)

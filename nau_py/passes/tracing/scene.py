"""The scene of a frame: materials, lights and parameters of a raytrace pass as values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from nau_py.model.raytrace import RaytracePass, RayVariable
from nau_py.passes.drawing import camera_context, pass_value
from nau_py.passes.frame import FrameContext, View
from nau_py.passes.tracing.effects import EffectChoice, choose_effects
from nau_py.passes.tracing.state import TracingState
from nau_py.passes.tracing.textures import RayInputs
from nau_py.raster.semantics import resolve_source
from nau_py.raytrace.tracing.materials import TracedLight, TracedMaterial
from nau_py.raytrace.tracing.scene_tables import TracedScene, TraceSettings
from nau_py.scene.material import RenderMaterial

if TYPE_CHECKING:
    from nau_py.raster.draw_context import DrawContext


@dataclass(frozen=True, slots=True)
class RayParameters:
    """Parameters of a raytrace pass, named as in the project."""

    samples: int
    max_depth: int
    sampler: str
    target_error: float
    accumulate: bool
    light_samples: int
    occlusion_distance: float


def read_parameters(pass_: RaytracePass, frame: FrameContext) -> RayParameters:
    """Return the parameters of a pass; the option ``samples`` replaces RAYS_PER_PIXEL."""

    def value(name: str) -> float:
        return float(pass_value(frame.project, pass_, name))

    return RayParameters(
        samples=frame.session.options.samples or int(value("RAYS_PER_PIXEL")),
        max_depth=int(value("MAX_DEPTH")),
        sampler=str(pass_value(frame.project, pass_, "SAMPLER")),
        target_error=value("TARGET_ERROR"),
        accumulate=bool(value("ACCUMULATE")),
        light_samples=int(value("LIGHT_SAMPLES")),
        occlusion_distance=value("OCCLUSION_DISTANCE"),
    )


@dataclass(frozen=True, slots=True)
class RayPassContext:
    """A raytrace pass in a frame: read by every step, changed by none."""

    pass_: RaytracePass
    frame: FrameContext
    view: View
    parameters: RayParameters


def make_context(pass_: RaytracePass, frame: FrameContext, view: View) -> RayPassContext:
    """Return the context of a pass, with its parameters read."""
    return RayPassContext(pass_, frame, view, read_parameters(pass_, frame))


@dataclass(frozen=True, slots=True)
class FrameScene:
    """Scene of a frame with the state that it was made of, and the effects that it simulates."""

    state: TracingState
    scene: TracedScene
    effects: EffectChoice


def build_scene(context: RayPassContext, inputs: RayInputs) -> FrameScene:
    """Resolve the materials, lights and parameters of a frame, and choose its effects.

    Raises :class:`~nau_py.ProgramError` when programs are loaded for the first time.
    """
    pass_, frame, view = context.pass_, context.frame, context.view
    state = frame.session.state(pass_, TracingState)
    state.follow_moves()
    lights = frame.lights(pass_)
    drawing = camera_context(pass_, frame, view)
    state.shading.context = drawing
    materials = []
    for name in state.geometry.materials:
        render = state.find_material(name)
        drawing.material = render
        materials.append(_resolve_material(pass_, state, name, render, drawing))
    drawing.material = None
    nodes = [state.find_programs(name) for name in state.geometry.materials]
    depth = context.parameters.max_depth
    effects = choose_effects(pass_, frame, nodes, materials, lights, view.camera, depth)
    scene = TracedScene(
        state.geometry,
        state.accelerator,
        materials,
        state.programs.table,
        [TracedLight(light.name, light.values) for light in lights],
        _resolve_variables(pass_.rtGlobalParams, drawing),
        inputs.variables,
        pass_.ray_types,
        TraceSettings(
            depth,
            frame.session.options.seed,
            context.parameters.light_samples,
            context.parameters.occlusion_distance,
            view.rect.clear if view.target.name == "window" else view.target.clear,
            effects.simulated,
        ),
        state.texels,
    )
    return FrameScene(state, scene, effects)


def _resolve_material(
    pass_: RaytracePass,
    state: TracingState,
    name: str,
    render: RenderMaterial | None,
    context: DrawContext,
) -> TracedMaterial:
    """Return a material with its textures and the values of ``rtMaterialParams``."""
    if render is None:
        return TracedMaterial(name, {}, {})
    textures = {
        unit: loaded
        for unit, binding in render.textures.items()
        if (loaded := state.textures.load(binding)) is not None
    }
    variables = _resolve_variables(pass_.rtMaterialParams, context)
    return TracedMaterial(name, render.colours, textures, variables)


def _resolve_variables(nodes: list[RayVariable], context: DrawContext) -> dict[str, NDArray[Any]]:
    """Return the values of parameters, by name."""
    values: dict[str, NDArray[Any]] = {}
    for node in nodes:
        if node.name and node.type and node.component:
            value = resolve_source(
                context, node.type, node.context or "CURRENT", node.component, node.id or 0
            )
            if value is not None:
                values[node.name] = value
    return values

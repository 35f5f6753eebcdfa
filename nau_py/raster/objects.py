"""Uniform values of textures, buffers, targets, states, scenes (docs/format.md, 8.2, 9)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.model.buffer import Buffer
from nau_py.model.node import Configured
from nau_py.model.scene import Primitive
from nau_py.model.texture import ArrayOfTextures
from nau_py.model.values import Scalar
from nau_py.raster.buffers import compute_record_size
from nau_py.raster.draw_context import DrawContext
from nau_py.raster.state import find_constant
from nau_py.scene.material import RenderMaterial

Value = NDArray[Any]
"""A uniform's value, flat: float64 or integers, matrices column-major float32."""


def _to_value(type_: str, component: str, parts: tuple[Scalar, ...]) -> Value | None:
    """Convert numbers to an array, and the name of a STATE value to OpenGL's constant."""
    if any(isinstance(p, str) for p in parts):
        return np.array([find_constant(component, str(parts[0]))]) if type_ == "STATE" else None
    return np.array([float(p) for p in parts]) if parts else None


def _find_attribute(context: DrawContext, type_: str, component: str, node: object) -> Value | None:
    if not isinstance(node, Configured):
        return None
    return _to_value(type_, component, context.world.project.value(node, type_, component))


def find_material(context: DrawContext, name: str) -> RenderMaterial | None:
    """Find the current material, or ``lib::material``."""
    if name == "CURRENT":
        return context.material
    library, _, material = name.partition("::")
    return context.world.materials.get(library, material)


def _find_texture(
    context: DrawContext, type_: str, name: str, component: str, index: int
) -> Value | None:
    resources, material = context.resources, context.material
    if name == "CURRENT" or type_ == "TEXTURE_MATERIAL":
        found = find_material(context, name)
        bound = found.textures.get(index) if found else None
        texture = resources.texture(bound.texture, bound.path) if bound else None
    else:
        local = f"{material.library}::{name}" if material and "::" not in name else name
        texture = resources.texture(local)
    if texture is None:
        return None
    channels = texture.format.channels
    sizes = {
        "WIDTH": texture.width,
        "HEIGHT": texture.height,
        "LEVELS": texture.levels,
        "LAYERS": texture.layers,
        "ID": texture.glo,
        "COMPONENT_COUNT": channels,
        "ELEMENT_SIZE": 8 * channels * np.dtype(texture.format.dtype).itemsize,
    }
    return np.array([sizes[component]]) if component in sizes else None


def _find_array(
    context: DrawContext, type_: str, name: str, component: str, index: int
) -> Value | None:
    node = context.world.project.names("texture array").get(name)
    if not isinstance(node, ArrayOfTextures):
        return None
    if component == "TEXTURE_ID_ARRAY":
        count = int(context.world.project.value(node, type_, "TEXTURE_COUNT")[0])
        library = name.partition("::")[0]
        made = [context.resources.texture(f"{library}::{node.name}_{k}") for k in range(count)]
        return np.array([texture.glo if texture else 0 for texture in made])
    return _find_attribute(context, type_, component, node)


def _find_buffer(
    context: DrawContext, type_: str, name: str, component: str, index: int
) -> Value | None:
    if type_ != "BUFFER":
        material = find_material(context, name)
        bound = [b for b in material.buffers if b.point == index] if material else []
        if not bound:
            return None
        if type_ == "BUFFER_BINDING":
            return np.array([index]) if component == "BINDING_POINT" else None
        name = bound[0].buffer
    node = context.world.project.names("buffer").get(name)
    if not isinstance(node, Buffer):
        return None
    if component == "STRUCT_SIZE":
        return np.array([compute_record_size(node)])
    if component in ("ID", "SIZE"):
        storage = context.resources.buffer(name)
        made = (storage.glo, storage.size) if storage is not None else (0, 0)
        return np.array([made[component == "SIZE"]])
    return _find_attribute(context, "BUFFER", component, node)


def _find_target(
    context: DrawContext, type_: str, name: str, component: str, index: int
) -> Value | None:
    wanted = (context.target or "") if name == "CURRENT" else name
    made = context.resources.made_target(wanted)
    if made is not None and component == "SIZE":  # a viewport may have resized it
        return np.array([made.width, made.height])
    library, _, short = wanted.partition("::")
    node = context.world.project.render_target(library, short)
    return _find_attribute(context, type_, component, node)


def _find_state(
    context: DrawContext, type_: str, name: str, component: str, index: int
) -> Value | None:
    project = context.world.project
    if name != "CURRENT":
        return _find_attribute(context, type_, component, project.names("state").get(name))
    written = context.material.state.get(component) if context.material else None
    return _to_value(type_, component, written or project.default(type_, component))


def _find_scene(
    context: DrawContext, type_: str, name: str, component: str, index: int
) -> Value | None:
    return context.world.scene_value(name, component)


def _find_object(
    context: DrawContext, type_: str, name: str, component: str, index: int
) -> Value | None:
    """Find an attribute of ``scene::object``. Nau has none in scenes of the default type (3.3)."""
    scene, _, wanted = name.partition("::")
    for node in context.world.project.assets.scenes:
        for item in node.geometry if node.name == scene else []:
            if isinstance(item, Primitive) and item.name == wanted:
                return _find_attribute(context, type_, component, item)
    return None


def _find_process(
    context: DrawContext, type_: str, name: str, component: str, index: int
) -> Value | None:
    project = context.world.project
    pipeline = project.pipeline(context.pipeline)
    for pass_ in pipeline.passes if pipeline else []:
        if pass_.name == name:
            items = pass_.preProcess if "_PRE_" in type_ else pass_.postProcess
            return (
                _find_attribute(context, type_, component, items[index])
                if index < len(items)
                else None
            )
    return None


SOURCES = {
    "TEXTURE": _find_texture,
    "TEXTURE_MATERIAL": _find_texture,
    "ARRAY_OF_TEXTURES": _find_array,
    "BUFFER": _find_buffer,
    "BUFFER_MATERIAL": _find_buffer,
    "BUFFER_BINDING": _find_buffer,
    "RENDER_TARGET": _find_target,
    "STATE": _find_state,
    "SCENE": _find_scene,
    "SCENE_OBJECT": _find_object,
    "PASS_PRE_PROCESS_TEXTURE": _find_process,
    "PASS_POST_PROCESS_TEXTURE": _find_process,
    "PASS_PRE_PROCESS_BUFFER": _find_process,
    "PASS_POST_PROCESS_BUFFER": _find_process,
}
"""Functions that find values, by object type; :mod:`nau_py.raster.semantics` has the others."""

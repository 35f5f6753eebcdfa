"""Values of uniforms by type, context and component (docs/format.md, 8 and 9)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from nau_py.model.passes import Pass
from nau_py.raster.draw_context import DrawContext
from nau_py.raster.objects import SOURCES, Value, find_material
from nau_py.scene.camera import CameraState
from nau_py.scene.mesh import F64
from nau_py.scene.transforms import inverse, to_unit_cube


def to_column_major(matrix: F64) -> Value:
    """Flatten a (k, k) matrix as OpenGL stores it, column after column: float32."""
    return np.ascontiguousarray(matrix.T, np.float32).reshape(-1)


def _to_value(values: tuple[Any, ...]) -> Value:
    return np.array([float(v) for v in values], np.float64)


def compute_camera_value(camera: CameraState, component: str, aspect: float) -> Value | None:
    """Compute a CAMERA attribute; matrices are column-major."""
    vectors: dict[str, tuple[F64, float]] = {
        "POSITION": (camera.position, 1.0),
        "VIEW": (camera.view, 0.0),
        "UP": (camera.up, 0.0),
        "LOOK_AT_POINT": (camera.position + camera.view, 1.0),
        "NORMALIZED_VIEW": (camera.forward, 0.0),
        "NORMALIZED_UP": (camera.true_up, 0.0),
        "NORMALIZED_RIGHT": (camera.right, 0.0),
    }
    if component in vectors:
        vector, w = vectors[component]
        return np.append(vector, w)
    if component in camera.values:
        return np.array([camera.values[component]])
    matrices: dict[str, Callable[[], F64]] = {
        "VIEW_MATRIX": camera.view_matrix,
        "PROJECTION_MATRIX": lambda: camera.projection_matrix(aspect),
        "VIEW_INVERSE_MATRIX": lambda: inverse(camera.view_matrix()),
        "PROJECTION_INVERSE_MATRIX": lambda: inverse(camera.projection_matrix(aspect)),
        "PROJECTION_VIEW_MATRIX": lambda: camera.projection_matrix(aspect) @ camera.view_matrix(),
        "TS05_PVM_MATRIX": lambda: (
            to_unit_cube() @ camera.projection_matrix(aspect) @ camera.view_matrix()
        ),
    }
    make = matrices.get(component)
    return to_column_major(make()) if make else None


def compute_normal_matrix(view_model: F64) -> F64:
    """Compute the inverse transpose of the upper 3x3; return a singular one as it is (9.12)."""
    linear = view_model[:3, :3]
    if abs(np.linalg.det(linear)) <= np.finfo(np.float32).eps:
        return linear
    return np.asarray(np.linalg.inv(linear).T)


def _find_renderer_value(context: DrawContext, component: str) -> Value | None:
    written = context.world.renderer_values.get(component)
    if written is not None:
        return _to_value(written)
    v, p, m = context.view, context.projection, context.model
    matrices: dict[str, Callable[[], F64]] = {
        "PROJECTION": lambda: p,
        "VIEW": lambda: v,
        "MODEL": lambda: m,
        "TEXTURE": lambda: np.eye(4),
        "VIEW_MODEL": lambda: v @ m,
        "PROJECTION_VIEW": lambda: p @ v,
        "PROJECTION_VIEW_MODEL": lambda: p @ v @ m,
        "TS05_PVM": lambda: to_unit_cube() @ p @ v,
        "NORMAL": lambda: compute_normal_matrix(v @ m),
    }
    if component in matrices:
        return to_column_major(matrices[component]())
    numbers: dict[str, float] = {
        "LIGHT_COUNT": len(context.lights),
        "FRAME_COUNT": context.frame,
        "TIMER": context.timer_ms,
        "INSTANCE_COUNT": context.instances,
    }
    if component in numbers:
        return np.array([numbers[component]])
    if component == "TEXTURE_COUNT":
        units = context.material.textures if context.material else {}
        return np.array([sum(1 << unit for unit in units)])
    return _find_default("RENDERER", component, context)


def _find_default(type_: str, component: str, context: DrawContext) -> Value | None:
    set_ = context.world.project.registry.get(type_)
    attribute = set_.get(component) if set_ else None
    if attribute is None or not attribute.default or not attribute.type.is_number:
        return None
    return _to_value(context.world.project.default(type_, component))


def _find_camera_value(context: DrawContext, name: str, component: str) -> Value | None:
    if name == "CURRENT":
        return compute_camera_value(context.camera, component, context.rect.aspect)
    camera = context.world.camera(name)
    aspect = context.world.viewport(camera.viewport).aspect
    return compute_camera_value(camera, component, aspect)


def _find_light_value(context: DrawContext, name: str, component: str, index: int) -> Value | None:
    if name != "CURRENT":
        light = context.world.light(name)
    elif index < len(context.lights):
        light = context.lights[index]
    else:
        light = context.world.light("__nauDefault")
    if component == "ID":
        return np.array([index])
    values = light.values.get(component)
    return None if values is None else _to_value(values)


def _find_viewport_value(context: DrawContext, name: str, component: str) -> Value | None:
    rect = context.rect if name == "CURRENT" else context.world.viewport(name)
    values: dict[str, tuple[float, ...]] = {
        "ORIGIN": (rect.x, rect.y),
        "SIZE": (rect.width, rect.height),
        "ABSOLUTE_ORIGIN": (rect.x, rect.y),
        "ABSOLUTE_SIZE": (rect.width, rect.height),
        "ABSOLUTE_RATIO": (rect.aspect,),
        "CLEAR_COLOR": rect.clear,
    }
    found = values.get(component)
    return _to_value(found) if found else _find_default("VIEWPORT", component, context)


def _find_pass_value(context: DrawContext, name: str, component: str) -> Value | None:
    """Find a PASS attribute of the running pass, or of ``pipeline#pass``."""
    project = context.world.project
    pass_: Pass | None = context.pass_
    if name != "CURRENT":
        pipeline, _, short = name.partition("#")
        found = project.pipeline(pipeline)
        pass_ = next((p for p in found.passes if p.name == short), None) if found else None
    if pass_ is None or component not in project.registry["PASS"]:
        return None
    values = project.value(pass_, "PASS", component)
    return None if not values or isinstance(values[0], str) else _to_value(values)


def resolve_source(
    context: DrawContext, type_: str, name: str, component: str, index: int
) -> Value | None:
    """Find the value of a source, flat: float64, or column-major float32 for matrices.

    Return None if it has none; the uniform then keeps its value.
    """
    if type_ == "RENDERER":
        return _find_renderer_value(context, component)
    if type_ == "CAMERA":
        return _find_camera_value(context, name, component)
    if type_ == "LIGHT":
        return _find_light_value(context, name, component, index)
    if type_ == "VIEWPORT":
        return _find_viewport_value(context, name, component)
    if type_ == "PASS":
        return _find_pass_value(context, name, component)
    if type_ == "COLOR":
        material = find_material(context, name)
        colour = material.colours.get(component) if material else None
        return _to_value(colour) if colour else _find_default(type_, component, context)
    if type_ == "TEXTURE_BINDING":
        material = find_material(context, name)
        bound = material is not None and index in material.textures
        return np.array([index]) if bound and component == "UNIT" else None
    if type_ == "IMAGE_TEXTURE":
        return np.array([index]) if component == "UNIT" else None
    if type_ in ("ARRAY_OF_TEXTURES_BINDING", "ARRAY_OF_IMAGE_TEXTURES"):
        material = find_material(context, name)
        images = type_ == "ARRAY_OF_IMAGE_TEXTURES"
        arrays = (material.image_arrays if images else material.texture_arrays) if material else []
        if index >= len(arrays) or component not in ("SAMPLER_ARRAY", "FIRST_UNIT"):
            return None
        return np.array(arrays[index] if component == "SAMPLER_ARRAY" else arrays[index][:1])
    source = SOURCES.get(type_)
    return source(context, type_, name, component, index) if source else None

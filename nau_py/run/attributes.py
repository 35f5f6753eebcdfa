"""Attributes of a running project by name: Lua's getAttr and setAttr (docs/format.md, 12)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from nau_py.diagnostics.suggest import format_names, suggest_name
from nau_py.model.linked import Project
from nau_py.model.node import Configured, Setting
from nau_py.model.passes import Pass
from nau_py.model.values import DataType, Scalar
from nau_py.passes.drawing import camera_context, window_view
from nau_py.passes.frame import FrameContext
from nau_py.raster.buffers import list_scalar_types
from nau_py.scene.material import ImageBinding, RenderMaterial

SETTABLE = ("RENDERER", "PASS", "CAMERA", "LIGHT", "VIEWPORT", "COLOR", "IMAGE_TEXTURE")


class Attributes:
    """Reads and writes attributes of a running project. :meth:`restore` undoes the changes in the
    nodes of the project."""

    def __init__(self, project: Project) -> None:
        self.project = project
        self._changed: list[tuple[Configured, str, Setting | None]] = []

    def get(
        self, frame: FrameContext, pass_: Pass, type_: str, name: str, component: str, index: int
    ) -> list[float]:
        """Return the numbers of an attribute, matrices column by column. Raises ValueError for an
        unknown name."""
        from nau_py.raster.semantics import resolve_source

        if type_ == "IMAGE_TEXTURE" and component != "UNIT":
            settings = dict(self._image(frame, name, index).settings)
            return [float(v) for v in settings.get(component, (0,))]
        if type_ == "VIEWPORT" and name != "CURRENT":
            values = self.project.value(self._viewport(name), "VIEWPORT", component)
            return [float(v) for v in values]
        context = camera_context(pass_, frame, window_view(frame))
        found = resolve_source(context, type_, name, component, index)
        if found is None:
            raise ValueError(f"{type_} '{name}' has no attribute '{component}' that can be read")
        return [float(v) for v in np.asarray(found).reshape(-1)]

    def set(
        self,
        frame: FrameContext,
        pass_: Pass,
        type_: str,
        name: str,
        component: str,
        index: int,
        values: Sequence[Scalar],
    ) -> None:
        """Write an attribute. Raises ValueError for an unknown name.

        Neither read-only flags nor ranges are checked, as in Nau.
        """
        if type_ not in SETTABLE:
            raise ValueError(
                f"attributes of {type_} cannot be set, those of {format_names(SETTABLE)} can"
            )
        if type_ != "IMAGE_TEXTURE":
            self._known(type_, component)
        parts = tuple(values)
        if type_ == "RENDERER":
            self._renderer(frame, component, values)
        elif type_ == "PASS":
            self._write(self._pass(pass_, name), component, parts)
        elif type_ == "VIEWPORT":
            self._write(self._viewport(name), component, parts)
        elif type_ == "CAMERA":
            camera = frame.session.view.camera if name == "CURRENT" else frame.world.camera(name)
            camera.apply(component, parts)
        elif type_ == "LIGHT":
            lights = frame.lights(pass_)
            light = lights[index] if name == "CURRENT" else frame.world.light(name)
            light.set(component, parts)
        elif type_ == "COLOR":
            self._material(frame, name).colours[component] = tuple(float(v) for v in parts)
        else:
            image = self._image(frame, name, index)
            settings = dict(image.settings) | {component: tuple(int(v) for v in values)}
            material = self._material(frame, name)
            material.images[index] = ImageBinding(image.texture, tuple(settings.items()))

    def restore(self) -> None:
        """Undo the changes in the nodes of the project."""
        for node, name, before in reversed(self._changed):
            if before is None:
                node.settings.pop(name, None)
            else:
                node.settings[name] = before
        self._changed.clear()

    def _known(self, type_: str, component: str) -> None:
        names = [a.name for a in self.project.registry[type_]]
        if component not in names:
            raise ValueError(
                f"{type_} has no attribute '{component}'{suggest_name(component, names)}"
            )

    def _write(self, node: Configured, name: str, parts: tuple[Scalar, ...]) -> None:
        self._changed.append((node, name, node.settings.get(name)))
        node.settings[name] = Setting(parts)

    def _renderer(self, frame: FrameContext, component: str, values: Sequence[Scalar]) -> None:
        if component == "FRAME_COUNT":
            frame.session.first_frame += frame.index - int(values[0])
        else:
            whole = self.project.registry["RENDERER"].attributes[component].type.is_integer
            parts = tuple(float(int(v)) if whole else float(v) for v in values)
            frame.world.renderer_values[component] = parts

    def _pass(self, running: Pass, name: str) -> Pass:
        if name == "CURRENT":
            return running
        pipeline, _, short = name.partition("#")
        passes = {f"{p.name}#{q.name}": q for p in self.project.pipelines for q in p.passes}
        found = passes.get(f"{pipeline}#{short}")
        if found is None:
            raise ValueError(f"there is no pass '{name}'{suggest_name(name, list(passes))}")
        return found

    def _viewport(self, name: str) -> Configured:
        nodes = {v.name or "": v for v in self.project.assets.viewports}
        if name not in nodes:
            raise ValueError(f"there is no viewport '{name}'{suggest_name(name, list(nodes))}")
        return nodes[name]

    def _material(self, frame: FrameContext, name: str) -> RenderMaterial:
        library, _, material = name.partition("::")
        found = frame.world.materials.get(library, material)
        if found is None:
            raise ValueError(f"there is no material '{name}'")
        return found

    def _image(self, frame: FrameContext, name: str, unit: int) -> ImageBinding:
        images = self._material(frame, name).images
        if unit not in images:
            raise ValueError(
                f"material '{name}' has no image texture on unit {unit}; it has {sorted(images)}"
            )
        return images[unit]


def _layout(type_: str) -> tuple[np.dtype[Any], int]:
    types = list_scalar_types(type_) if type_ in DataType.__members__ else []
    if not types:
        near = suggest_name(type_, list(DataType.__members__))
        raise ValueError(f"'{type_}' is no type of a buffer's entry{near}")
    return np.dtype(types[0]), len(types)


def _storage(frame: FrameContext, name: str, offset: int, size: int) -> Any:
    found = frame.session.resources.buffer(name)
    if found is None:
        raise ValueError(f"there is no buffer '{name}'")
    if offset < 0 or offset + size > found.size:
        raise ValueError(f"buffer '{name}' has {found.size} bytes: none at {offset}")
    return found


def get_buffer(frame: FrameContext, name: str, offset: int, type_: str) -> list[float]:
    """Return one value at a byte offset. Raises ValueError outside the buffer."""
    dtype, count = _layout(type_)
    size = dtype.itemsize * count
    raw = _storage(frame, name, offset, size).read(size, offset=offset)
    return [float(v) for v in np.frombuffer(raw, dtype)]


def set_buffer(
    frame: FrameContext, name: str, offset: int, type_: str, values: list[float]
) -> None:
    """Write one value at a byte offset. Raises ValueError outside the buffer."""
    dtype, count = _layout(type_)
    whole = np.zeros(count, dtype)
    whole[: len(values)] = np.array(values[:count]).astype(dtype)
    _storage(frame, name, offset, whole.nbytes).write(whole.tobytes(), offset=offset)

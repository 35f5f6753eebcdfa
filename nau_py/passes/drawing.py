"""What the drawing pass classes share: target, viewport, clears, uniforms' context."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from nau_py.model.linked import Project
from nau_py.model.passes import Pass, ProcessBuffer, ProcessTexture
from nau_py.passes.access import buffer, texture
from nau_py.passes.frame import FrameContext, PassRecord
from nau_py.scene.mesh import F64, SceneObject
from nau_py.scene.viewport import Rect

if TYPE_CHECKING:
    from nau_py.raster.semantics import DrawContext
    from nau_py.raster.targets import Target


def pass_value(project: Project, pass_: Pass, name: str) -> bool | int | float | str:
    """The first component of a PASS attribute."""
    return project.value(pass_, "PASS", name)[0]


def viewport_names(pass_: Pass) -> list[str]:
    """The viewports that a pass names; the first one counts for clearing and aspect."""
    single = [pass_.viewport.name] if pass_.viewport and pass_.viewport.name else []
    return single + [v.name for v in pass_.viewports if v.name]


def target_and_rect(pass_: Pass, frame: FrameContext, uses_camera: bool) -> tuple[Target, Rect]:
    """Where a pass draws (docs/format.md, 11.5)."""
    session = frame.session
    owner = frame.project.target_of(pass_)
    names = viewport_names(pass_)
    rect = frame.world.viewport(names[0]) if names else None
    if owner is None:
        if rect is None:
            rect = frame.rect
            if uses_camera:
                camera = frame.camera
                kept = session.camera_rects.get(camera.name)
                rect = kept or frame.world.viewport(camera.viewport)
        return session.resources.window, rect
    target = session.resources.target(owner[0], owner[1].name or "")
    if rect is None:
        rect = Rect(0.0, 0.0, float(target.width), float(target.height), target.clear)
        if uses_camera:
            session.camera_rects[frame.camera.name] = rect
    else:
        target.resize(max(int(rect.width), 1), max(int(rect.height), 1))
        rect = Rect(rect.x, rect.y, rect.width, rect.height, target.clear)
    return target, rect


def begin(
    pass_: Pass,
    frame: FrameContext,
    uses_camera: bool,
    clears: bool = True,
    window_clear: tuple[float, float, float, float] | None = None,
) -> Target:
    """Bind the target of a pass and clear it. Leaves the pass's rectangle in ``frame.rect``.
    ``window_clear``: the window's colour in the place of the viewport's."""
    from nau_py.raster.state import apply_stencil, reset_state

    project = frame.project
    target, rect = target_and_rect(pass_, frame, uses_camera)
    if window_clear is not None and target is frame.session.resources.window:
        rect = replace(rect, clear=window_clear)
    frame.rect = rect
    reset_state()
    target.bind(rect)
    for index, name in enumerate(viewport_names(pass_)[1:], 1):
        target.add_viewport(index, frame.world.viewport(name))
    if clears:
        depth_writes = bool(pass_value(project, pass_, "DEPTH_MASK"))
        if pass_value(project, pass_, "COLOR_CLEAR"):
            target.clear_color(rect.clear)
        if pass_value(project, pass_, "DEPTH_CLEAR") and depth_writes:
            target.clear_depth(float(pass_value(project, pass_, "DEPTH_CLEAR_VALUE")))
        if pass_value(project, pass_, "STENCIL_CLEAR"):
            target.clear_stencil(int(pass_value(project, pass_, "STENCIL_CLEAR_VALUE")))
    names = [a.name for a in project.registry["PASS"] if a.name.startswith("STENCIL")]
    apply_stencil({name: project.value(pass_, "PASS", name) for name in names})
    return target


def draw_context(
    pass_: Pass, frame: FrameContext, target: Target, projection: F64, view: F64, lights: bool
) -> DrawContext:
    """The context that uniform sources of this pass refer to."""
    from nau_py.raster.semantics import DrawContext

    instances = int(pass_value(frame.project, pass_, "INSTANCE_COUNT"))
    if not instances and pass_.scenes is not None:
        instances = int(frame.project.number(pass_.scenes.instances))
    return DrawContext(
        frame.world,
        frame.session.resources,
        pass_,
        frame.index,
        frame.timer_ms,
        frame.camera,
        frame.rect,
        frame.lights(pass_) if lights else [],
        projection,
        view,
        target.name,
        instances=instances,
        pipeline=frame.session.pipeline,
        indirect=pass_.scenes.drawIndirectBuffer if pass_.scenes is not None else None,
    )


def camera_context(pass_: Pass, frame: FrameContext, target: Target) -> DrawContext:
    """:func:`draw_context` with the matrices of the frame's current camera, and the lights."""
    projection = frame.camera.projection_matrix(frame.rect.aspect)
    view = frame.camera.view_matrix()
    return draw_context(pass_, frame, target, projection, view, lights=True)


def draw_scenes(
    pass_: Pass,
    frame: FrameContext,
    target: Target,
    record: PassRecord,
    more: Sequence[SceneObject] = (),
) -> None:
    """Draw the scenes of a pass, and ``more``, with the current camera, between its process
    items."""
    from nau_py.raster.draw import draw, draw_list

    process(pass_.preProcess, frame)
    materials = frame.session.pass_materials(pass_)
    objects = [*frame.world.objects(pass_.scene_names), *more]
    draw(draw_list(objects, materials.__getitem__), camera_context(pass_, frame, target))
    frame.session.resources.barrier()
    process(pass_.postProcess, frame)
    note_pixels(record, frame)


def identity() -> F64:
    return np.eye(4)


def process(items: Sequence[ProcessTexture | ProcessBuffer], frame: FrameContext) -> None:
    """Run pre- or post-process items (docs/format.md, 4.5)."""
    resources = frame.session.resources
    for item in items:
        settings = {name: setting.parts[0] for name, setting in item.settings.items()}
        if isinstance(item, ProcessBuffer):
            storage = resources.buffer(buffer(item.name, item.fromLibrary).name)
            if storage is not None and settings.get("CLEAR"):
                storage.clear()
            continue
        found = resources.texture(texture(item.name, item.fromLibrary).name)
        if found is None:
            continue
        if settings.get("CLEAR"):
            found.clear()
        level = int(frame.project.number(settings.get("CLEAR_LEVEL"), -1))
        if 0 <= level < found.levels:
            found.clear(level)
        if settings.get("MIPMAP"):
            found.generate_mipmaps()


def note_pixels(record: PassRecord, frame: FrameContext) -> None:
    """Record the pixels of the rectangle that the pass drew into."""
    record.pixels = max(int(frame.rect.width), 0) * max(int(frame.rect.height), 0)

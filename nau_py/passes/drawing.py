"""Steps that the drawing pass classes share: view, clears, context of uniforms, process items.

OpenGL is imported inside the functions that use it, and here only: pass classes import this module
at the top, and linting loads them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from nau_py.model.attributes import BUILT_IN
from nau_py.model.linked import Project
from nau_py.model.passes import Pass, ProcessBuffer, ProcessTexture
from nau_py.passes.access import buffer, texture
from nau_py.passes.frame import FrameContext, View
from nau_py.scene.viewport import Rect

if TYPE_CHECKING:
    from nau_py.raster.draw_context import DrawContext
    from nau_py.raster.programs import ShaderProgram
    from nau_py.scene.camera import CameraState
    from nau_py.scene.material import RenderMaterial
    from nau_py.scene.mesh import F64, Mesh, SceneObject


def pass_value(project: Project, pass_: Pass, name: str) -> bool | int | float | str:
    """Return the first component of a PASS attribute."""
    return project.value(pass_, "PASS", name)[0]


_STENCIL = tuple(a.name for a in BUILT_IN["PASS"] if a.name.startswith("STENCIL"))


def viewport_names(pass_: Pass) -> list[str]:
    """Return the viewports that a pass names; clearing and aspect follow the first one."""
    single = [pass_.viewport.name] if pass_.viewport and pass_.viewport.name else []
    return single + [v.name for v in pass_.viewports if v.name]


def resolve_view(pass_: Pass, frame: FrameContext, camera: CameraState | None = None) -> View:
    """Return the view of a pass: its target or the window, and its viewport (docs/format.md, 11.5).

    ``camera``: the camera of the pass, whose viewport counts where the pass has none. Without it
    the pass inherits the current camera and, in the window, the current rectangle. Resizes a target
    to the pass's viewport.
    """
    session = frame.session
    owner = frame.project.target_of(pass_)
    names = viewport_names(pass_)
    rect = frame.world.viewport(names[0]) if names else None
    chosen = camera or session.view.camera
    if owner is None:
        if rect is None and camera is None:
            rect = session.view.rect
        if rect is None:
            rect = session.camera_rects.get(chosen.name) or frame.world.viewport(chosen.viewport)
        return View(chosen, session.resources.window, rect)
    target = session.resources.target(owner[0], owner[1].name or "")
    if rect is None:
        rect = Rect(0.0, 0.0, float(target.width), float(target.height), target.clear)
        if camera is not None:
            session.camera_rects[camera.name] = rect
    else:
        target.resize(max(int(rect.width), 1), max(int(rect.height), 1))
        rect = Rect(rect.x, rect.y, rect.width, rect.height, target.clear)
    return View(chosen, target, rect)


def begin_view(pass_: Pass, frame: FrameContext, camera: CameraState | None = None) -> View:
    """Return :func:`resolve_view`, made current for the passes that follow."""
    frame.session.view = view = resolve_view(pass_, frame, camera)
    return view


def begin_drawing(
    pass_: Pass,
    frame: FrameContext,
    camera: CameraState | None = None,
    window_clear: tuple[float, float, float, float] | None = None,
) -> View:
    """Make the view of a pass current, bind its target and clear it.

    ``window_clear``: clear colour of the window, instead of the viewport's.
    """
    from nau_py.raster.state import apply_stencil, reset_state

    project = frame.project
    view = resolve_view(pass_, frame, camera)
    if window_clear is not None and view.target is frame.session.resources.window:
        view = replace(view, rect=replace(view.rect, clear=window_clear))
    frame.session.view = view
    target, rect = view.target, view.rect
    reset_state()
    target.bind(rect)
    for index, name in enumerate(viewport_names(pass_)[1:], 1):
        target.add_viewport(index, frame.world.viewport(name))
    depth_writes = bool(pass_value(project, pass_, "DEPTH_MASK"))
    if pass_value(project, pass_, "COLOR_CLEAR"):
        target.clear_color(rect.clear)
    if pass_value(project, pass_, "DEPTH_CLEAR") and depth_writes:
        target.clear_depth(float(pass_value(project, pass_, "DEPTH_CLEAR_VALUE")))
    if pass_value(project, pass_, "STENCIL_CLEAR"):
        target.clear_stencil(int(pass_value(project, pass_, "STENCIL_CLEAR_VALUE")))
    apply_stencil({name: project.value(pass_, "PASS", name) for name in _STENCIL})
    return view


def draw_context(
    pass_: Pass,
    frame: FrameContext,
    view: View,
    matrices: tuple[F64, F64] | None = None,
    lights: bool = False,
) -> DrawContext:
    """Return the context that uniform sources of this pass refer to.

    ``matrices``: world to eye and eye to clip space, (4, 4) for column vectors; None: identities.
    """
    from nau_py.raster.draw_context import DrawContext

    instances = int(pass_value(frame.project, pass_, "INSTANCE_COUNT"))
    if not instances and pass_.scenes is not None:
        instances = int(frame.project.number(pass_.scenes.instances))
    to_eye, to_clip = matrices or (np.eye(4), np.eye(4))
    return DrawContext(
        frame.world,
        frame.session.resources,
        pass_,
        frame.index,
        frame.timer_ms,
        view.camera,
        view.rect,
        frame.lights(pass_) if lights else [],
        to_clip,
        to_eye,
        view.target.name,
        instances=instances,
        pipeline=frame.session.pipeline,
        indirect=pass_.scenes.drawIndirectBuffer if pass_.scenes is not None else None,
    )


def camera_context(pass_: Pass, frame: FrameContext, view: View) -> DrawContext:
    """Return :func:`draw_context` with the matrices of the view's camera, and the lights."""
    camera = view.camera
    matrices = camera.view_matrix(), camera.projection_matrix(view.rect.aspect)
    return draw_context(pass_, frame, view, matrices, lights=True)


def window_view(frame: FrameContext) -> View:
    """Return the current view with the window for a target."""
    return replace(frame.session.view, target=frame.session.resources.window)


def draw_objects(
    objects: list[SceneObject],
    material_of: Callable[[str], RenderMaterial | None],
    context: DrawContext,
    depth_clamp: bool = False,
) -> None:
    """Draw objects with their mapped materials into the bound target.

    ``depth_clamp``: fragments nearer or farther than the depth range are clamped, not clipped.
    """
    from nau_py.raster.draw import draw_items, list_draws
    from nau_py.raster.gl import GL

    if depth_clamp:
        GL.glEnable(GL.GL_DEPTH_CLAMP)
    draw_items(list_draws(objects, material_of), context)
    if depth_clamp:
        GL.glDisable(GL.GL_DEPTH_CLAMP)


def draw_scenes(
    pass_: Pass,
    frame: FrameContext,
    view: View,
    more: Sequence[SceneObject] = (),
    depth_clamp: bool = False,
) -> None:
    """Draw the scenes of a pass, and ``more``, between its process items."""
    run_process(pass_.preProcess, frame)
    materials = frame.session.pass_materials(pass_)
    objects = [*frame.world.objects(pass_.scene_names), *more]
    context = camera_context(pass_, frame, view)
    draw_objects(objects, materials.__getitem__, context, depth_clamp)
    frame.session.resources.barrier()
    run_process(pass_.postProcess, frame)


def draw_mesh(mesh: Mesh, material: RenderMaterial, context: DrawContext) -> None:
    """Draw the first group of a mesh, untransformed, into the bound target."""
    from nau_py.raster.draw import DrawItem, draw_items

    draw_items([DrawItem(mesh, 0, material, np.eye(4))], context)


def dispatch_compute(
    program: ShaderProgram,
    material: RenderMaterial,
    groups: tuple[int, int, int],
    context: DrawContext,
) -> None:
    """Run a compute program with the resources of its material; nothing where a count is 0."""
    from nau_py.raster.draw import bind_material, set_uniforms, unbind_material

    context.material = material
    bind_material(context.resources, material)
    set_uniforms(program, context)
    if all(groups):
        program.mgl.run(*groups)
    unbind_material(material)
    context.resources.barrier()


def run_process(items: Sequence[ProcessTexture | ProcessBuffer], frame: FrameContext) -> None:
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

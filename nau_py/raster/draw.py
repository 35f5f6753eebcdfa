"""Drawing: bind materials and send geometry, in Nau's order (docs/format.md, 11.6)."""

from __future__ import annotations

import struct
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from nau_py.diagnostics.diagnostic import error
from nau_py.raster import gl
from nau_py.raster.draw_context import DrawContext
from nau_py.raster.formats import pixel_format
from nau_py.raster.gl import GL
from nau_py.raster.programs import ShaderProgram
from nau_py.raster.resources import Resources
from nau_py.raster.semantics import resolve_source
from nau_py.raster.state import apply_state
from nau_py.scene.material import RenderMaterial
from nau_py.scene.mesh import F64, Mesh, SceneObject

_MODES = {
    "TRIANGLES": GL.GL_TRIANGLES,
    "TRIANGLE_STRIP": GL.GL_TRIANGLE_STRIP,
    "TRIANGLE_FAN": GL.GL_TRIANGLE_FAN,
    "LINES": GL.GL_LINES,
    "LINE_LOOP": GL.GL_LINE_LOOP,
    "POINTS": GL.GL_POINTS,
    "TRIANGLES_ADJACENCY": GL.GL_TRIANGLES_ADJACENCY,
    "PATCHES": GL.GL_PATCHES,
}
_ACCESS = {
    "READ_ONLY": GL.GL_READ_ONLY,
    "WRITE_ONLY": GL.GL_WRITE_ONLY,
    "READ_WRITE": GL.GL_READ_WRITE,
}
_BUFFER_TARGETS = {
    "SHADER_STORAGE": GL.GL_SHADER_STORAGE_BUFFER,
    "UNIFORM": GL.GL_UNIFORM_BUFFER,
    "ATOMIC_COUNTER": GL.GL_ATOMIC_COUNTER_BUFFER,
}


@dataclass(slots=True)
class DrawItem:
    """One material group of one object."""

    mesh: Mesh
    group: int
    material: RenderMaterial
    matrix: F64


def list_draws(
    objects: list[SceneObject], material_of: Callable[[str], RenderMaterial | None]
) -> list[DrawItem]:
    """List the groups to draw, sorted by ORDER, then material, then object."""
    items: list[DrawItem] = []
    seen: dict[int, int] = {}
    for item in objects:
        for index, group in enumerate(item.mesh.groups):
            material = material_of(group.material)
            drawn = len(group.indices) or item.mesh.buffers
            if material is not None and material.enabled and drawn:
                seen.setdefault(id(material), len(seen))
                items.append(DrawItem(item.mesh, index, material, item.matrix))
    return sorted(items, key=lambda d: (d.material.order, seen[id(d.material)]))


def bind_material(resources: Resources, material: RenderMaterial) -> None:
    """Bind a material's textures, images, buffers and state."""
    for unit, binding in material.textures.items():
        texture = resources.texture(binding.texture, binding.path)
        if texture is not None:
            GL.glBindTextureUnit(unit, texture.glo)
            GL.glBindSampler(unit, resources.samplers.get(binding.sampler, texture.levels > 1))
    for unit, image in material.images.items():
        texture = resources.texture(image.texture)
        if texture is not None:
            _bind_image(unit, texture, dict(image.settings))
    for bound in material.buffers:
        storage = resources.buffer(bound.buffer)
        if storage is not None:
            GL.glBindBufferBase(_BUFFER_TARGETS[bound.type], bound.point, storage.glo)
    apply_state(material.state)


def _bind_image(unit: int, texture: Any, settings: dict[str, Any]) -> None:
    level = int(settings.get("LEVEL", (0,))[0])
    access = _ACCESS[str(settings.get("ACCESS", ("WRITE_ONLY",))[0])]
    name = settings.get("INTERNAL_FORMAT", (texture.format.name,))[0]
    if settings.get("CLEAR", (False,))[0]:
        texture.clear()
    fmt = pixel_format(str(name)).internal
    GL.glBindImageTexture(unit, texture.glo, level, GL.GL_TRUE, 0, access, fmt)


def unbind_material(material: RenderMaterial) -> None:
    """Unbind the textures of ``material``, which the next one must not see."""
    for unit in material.textures:
        GL.glBindTextureUnit(unit, 0)
        GL.glBindSampler(unit, 0)


def set_uniforms(program: ShaderProgram, context: DrawContext) -> None:
    """Upload the uniforms of the current material."""
    material = context.material
    if material is None:
        return
    for source in material.uniforms:
        value = resolve_source(context, source.type, source.context, source.component, source.id)
        if value is None:
            continue
        if source.block:
            context.resources.blocks.set(program.mgl.glo, source.block, source.uniform, value)
        else:
            program.set(source.uniform, value)
    context.resources.blocks.bind()


@dataclass(slots=True)
class _DrawCommand:
    """A draw command of OpenGL. ``count`` never exceeds the existing vertices or indices."""

    count: int
    instances: int
    first: int = 0
    base_vertex: int = 0
    base_instance: int = 0


def _make_command(context: DrawContext, count: int, indexed: bool) -> _DrawCommand:
    """Make the command to draw ``count`` vertices, or read it from the buffer of draw commands.

    As in Nau the count is written into the buffer before each draw (docs/format.md, 11.6). The
    other values are read back and not left to the GPU: all groups of a mesh share one buffer of
    indices here, so ``first`` has to be moved.
    """
    if context.indirect is None:
        return _DrawCommand(count, max(context.instances, 1))
    buffer = context.resources.buffer(context.indirect)
    size = 20 if indexed else 16
    if buffer is None or buffer.size < size:
        held = buffer.size if buffer is not None else 0
        node = context.pass_.scenes or context.pass_
        context.resources.diagnostics.append(
            error(
                "B002",
                node.where("drawIndirectBuffer"),
                f"pass '{context.pass_.name}': buffer '{context.indirect}' holds {held} bytes; a "
                f"draw command takes {size}",
            )
        )
        return _DrawCommand(0, 0)
    buffer.write(count.to_bytes(4, "little"))
    words = struct.unpack("<4xIIiI" if indexed else "<4xIII", buffer.read(size))
    left = max(count - words[1], 0)
    return (
        _DrawCommand(left, *words)
        if indexed
        else _DrawCommand(left, words[0], words[1], 0, words[2])
    )


def _draw_mesh(item: DrawItem, program: ShaderProgram, context: DrawContext) -> None:
    resources = context.resources
    array = resources.geometry.vertex_array(item.mesh, program)
    gpu = resources.geometry.upload(item.mesh)
    mode = _MODES["TRIANGLES_ADJACENCY" if item.mesh.adjacency else item.mesh.primitive]
    if program.is_tessellated:
        points = item.mesh.groups[item.group].indices.shape[1]
        mode = GL.GL_PATCHES
        GL.glPatchParameteri(GL.GL_PATCH_VERTICES, points)
    first = gpu.first[item.group]
    c = _make_command(context, gpu.count[item.group], indexed=True)
    gl.draw_elements(
        program.mgl.glo,
        array,
        mode,
        c.count,
        first + c.first,
        c.instances,
        c.base_vertex,
        c.base_instance,
    )


def _draw_buffers(mesh: Mesh, program: ShaderProgram, context: DrawContext) -> None:
    """Draw geometry of GPU buffers: all vertices of ``position``, or all indices."""
    resources = context.resources
    found = {name: resources.buffer(place) for name, place in mesh.buffers.items()}
    buffers = {name: buffer for name, buffer in found.items() if buffer is not None}
    array = resources.geometry.buffer_array(mesh, program, {n: b.glo for n, b in buffers.items()})
    mode = _MODES[mesh.primitive]
    if "index" in buffers:
        c = _make_command(context, buffers["index"].size // 4, indexed=True)
        base = (c.base_vertex, c.base_instance)
        gl.draw_elements(program.mgl.glo, array, mode, c.count, c.first, c.instances, *base)
    elif "position" in buffers:
        c = _make_command(context, buffers["position"].size // 16, indexed=False)
        gl.draw_arrays(program.mgl.glo, array, mode, c.count, c.instances, c.first, c.base_instance)


def draw_items(items: list[DrawItem], context: DrawContext) -> None:
    """Draw ``items`` into the bound target."""
    resources = context.resources
    previous: RenderMaterial | None = None
    for item in items:
        program = resources.program(*item.material.program)
        if program is None or program.is_compute:
            continue
        if item.material is not previous:
            if previous is not None:
                unbind_material(previous)
            bind_material(resources, item.material)
            previous = item.material
        context.material, context.model = item.material, item.matrix
        set_uniforms(program, context)
        discard = not program.has_fragment
        if discard:
            GL.glEnable(GL.GL_RASTERIZER_DISCARD)
        if item.mesh.buffers:
            _draw_buffers(item.mesh, program, context)
        else:
            _draw_mesh(item, program, context)
        if discard:
            GL.glDisable(GL.GL_RASTERIZER_DISCARD)
    if previous is not None:
        unbind_material(previous)

"""Raw OpenGL calls that moderngl lacks: the only file that imports PyOpenGL.

The calls use the context that :mod:`nau_py.raster.device` made current.
"""

from __future__ import annotations

import ctypes
import os

os.environ.setdefault("PYOPENGL_PLATFORM", "egl")

import OpenGL

OpenGL.ERROR_CHECKING = False
OpenGL.ERROR_LOGGING = False
OpenGL.ERROR_ON_COPY = False

from typing import Any  # noqa: E402

import numpy as np  # noqa: E402
from numpy.typing import NDArray  # noqa: E402
from OpenGL import GL  # noqa: E402

Array = NDArray[Any]

_UNIFORM_F = {
    1: "glProgramUniform1fv",
    2: "glProgramUniform2fv",
    3: "glProgramUniform3fv",
    4: "glProgramUniform4fv",
}
_UNIFORM_I = {
    1: "glProgramUniform1iv",
    2: "glProgramUniform2iv",
    3: "glProgramUniform3iv",
    4: "glProgramUniform4iv",
}
_UNIFORM_U = {
    1: "glProgramUniform1uiv",
    2: "glProgramUniform2uiv",
    3: "glProgramUniform3uiv",
    4: "glProgramUniform4uiv",
}
_FLOAT_TYPES = {GL.GL_FLOAT: 1, GL.GL_FLOAT_VEC2: 2, GL.GL_FLOAT_VEC3: 3, GL.GL_FLOAT_VEC4: 4}
_INT_TYPES = {
    GL.GL_INT: 1,
    GL.GL_INT_VEC2: 2,
    GL.GL_INT_VEC3: 3,
    GL.GL_INT_VEC4: 4,
    GL.GL_BOOL: 1,
    GL.GL_BOOL_VEC2: 2,
    GL.GL_BOOL_VEC3: 3,
    GL.GL_BOOL_VEC4: 4,
}
_UINT_TYPES = {
    GL.GL_UNSIGNED_INT: 1,
    GL.GL_UNSIGNED_INT_VEC2: 2,
    GL.GL_UNSIGNED_INT_VEC3: 3,
    GL.GL_UNSIGNED_INT_VEC4: 4,
}
_MATRIX_TYPES = {
    GL.GL_FLOAT_MAT3: (9, "glProgramUniformMatrix3fv"),
    GL.GL_FLOAT_MAT4: (16, "glProgramUniformMatrix4fv"),
}


def count_components(gl_type: int) -> int:
    """Count the scalars of one element of a uniform of ``gl_type``; 1 for samplers and images."""
    if gl_type in _MATRIX_TYPES:
        return _MATRIX_TYPES[gl_type][0]
    for table in (_FLOAT_TYPES, _INT_TYPES, _UINT_TYPES):
        if gl_type in table:
            return table[gl_type]
    return 1


def uniform_dtype(gl_type: int) -> type[np.generic]:
    """Return the dtype to upload for a uniform of ``gl_type``; int32 for samplers and images."""
    if gl_type in _FLOAT_TYPES or gl_type in _MATRIX_TYPES:
        return np.float32
    return np.uint32 if gl_type in _UINT_TYPES else np.int32


def set_uniform(program: int, location: int, gl_type: int, count: int, value: Array) -> None:
    """Upload ``count`` elements. ``value``: flat, of :func:`uniform_dtype`, column-major."""
    if gl_type in _MATRIX_TYPES:
        getattr(GL, _MATRIX_TYPES[gl_type][1])(program, location, count, GL.GL_FALSE, value)
        return
    width = count_components(gl_type)
    table = {np.float32: _UNIFORM_F, np.int32: _UNIFORM_I, np.uint32: _UNIFORM_U}
    getattr(GL, table[uniform_dtype(gl_type)][width])(program, location, count, value)  # type: ignore[index]


def create_texture(target: int) -> int:
    name = np.zeros(1, np.uint32)
    GL.glCreateTextures(target, 1, name)
    return int(name[0])


def create_framebuffer() -> int:
    name = np.zeros(1, np.uint32)
    GL.glCreateFramebuffers(1, name)
    return int(name[0])


def create_sampler() -> int:
    name = np.zeros(1, np.uint32)
    GL.glCreateSamplers(1, name)
    return int(name[0])


def swizzle_grey(texture: int) -> None:
    """Make shaders read a depth texture as grey, as in the compatibility contexts of Nau."""
    grey = np.array([GL.GL_RED, GL.GL_RED, GL.GL_RED, GL.GL_ONE], np.int32)
    GL.glTextureParameteriv(texture, GL.GL_TEXTURE_SWIZZLE_RGBA, grey)


def delete_textures(names: list[int]) -> None:
    GL.glDeleteTextures(len(names), np.array(names, np.uint32))


def delete_samplers(names: list[int]) -> None:
    GL.glDeleteSamplers(len(names), np.array(names, np.uint32))


def delete_vertex_arrays(names: list[int]) -> None:
    GL.glDeleteVertexArrays(len(names), np.array(names, np.uint32))


def delete_framebuffer(name: int) -> None:
    GL.glDeleteFramebuffers(1, np.array([name], np.uint32))


def read_texture(name: int, level: int, layout: int, kind: int, out: Array) -> None:
    """Read a texture level into ``out``, rows from the bottom up."""
    GL.glPixelStorei(GL.GL_PACK_ALIGNMENT, 1)
    GL.glMemoryBarrier(GL.GL_ALL_BARRIER_BITS)
    GL.glGetTextureImage(name, level, layout, kind, out.nbytes, out)


def resolve_samples(
    name: int, into: int, width: int, height: int, depth: bool, stencil: bool
) -> None:
    """Copy a multisample texture into a plain one of its size and format."""
    framebuffers = [create_framebuffer(), create_framebuffer()]
    stencil_point = GL.GL_DEPTH_STENCIL_ATTACHMENT if stencil else GL.GL_DEPTH_ATTACHMENT
    point = stencil_point if depth else GL.GL_COLOR_ATTACHMENT0
    for framebuffer, texture in zip(framebuffers, (name, into), strict=True):
        GL.glNamedFramebufferTexture(framebuffer, point, texture, 0)
    GL.glMemoryBarrier(GL.GL_ALL_BARRIER_BITS)
    scissor = GL.glIsEnabled(GL.GL_SCISSOR_TEST)
    GL.glDisable(GL.GL_SCISSOR_TEST)
    box = (0, 0, width, height)
    mask = GL.GL_DEPTH_BUFFER_BIT if depth else GL.GL_COLOR_BUFFER_BIT
    GL.glBlitNamedFramebuffer(*framebuffers, *box, *box, mask, GL.GL_NEAREST)
    if scissor:
        GL.glEnable(GL.GL_SCISSOR_TEST)
    for framebuffer in framebuffers:
        delete_framebuffer(framebuffer)


def upload_2d(
    name: int, width: int, height: int, layout: int, kind: int, data: Array, level: int = 0
) -> None:
    """Fill a texture level; ``data`` rows run from the bottom up."""
    GL.glPixelStorei(GL.GL_UNPACK_ALIGNMENT, 1)
    GL.glTextureSubImage2D(
        name, level, 0, 0, width, height, layout, kind, np.ascontiguousarray(data)
    )


def upload_3d(
    name: int, width: int, height: int, depth: int, layout: int, kind: int, data: Array
) -> None:
    """Fill a 3D texture, slice after slice."""
    GL.glPixelStorei(GL.GL_UNPACK_ALIGNMENT, 1)
    sizes = (width, height, depth)
    GL.glTextureSubImage3D(name, 0, 0, 0, 0, *sizes, layout, kind, np.ascontiguousarray(data))


def upload_face(
    name: int, face: int, width: int, height: int, layout: int, kind: int, data: Array
) -> None:
    """Fill one face of a cube map."""
    GL.glPixelStorei(GL.GL_UNPACK_ALIGNMENT, 1)
    GL.glTextureSubImage3D(
        name, 0, 0, 0, face, width, height, 1, layout, kind, np.ascontiguousarray(data)
    )


def clear_texture(name: int, levels: list[int], layout: int, kind: int) -> None:
    """Fill the levels with zero."""
    for level in levels:
        GL.glClearTexImage(name, level, layout, kind, None)


def _query_active(
    program: int, interface: int, properties: list[int]
) -> list[tuple[str, list[int]]]:
    """Query names and properties of the active resources of a program interface."""
    count = np.zeros(1, np.int32)
    GL.glGetProgramInterfaceiv(program, interface, GL.GL_ACTIVE_RESOURCES, count)
    wanted = np.array(properties, np.uint32)
    found = []
    for index in range(int(count[0])):
        values = np.zeros(len(properties), np.int32)
        length = np.zeros(1, np.int32)
        GL.glGetProgramResourceiv(
            program, interface, index, len(wanted), wanted, len(values), length, values
        )
        name = np.zeros(256, np.int8)
        GL.glGetProgramResourceName(
            program,
            interface,
            index,
            256,
            length,
            name.ctypes.data_as(ctypes.POINTER(ctypes.c_char)),
        )
        text = name.tobytes().split(b"\0")[0].decode("ascii", "replace")
        found.append((text, [int(v) for v in values]))
    return found


def active_uniforms(program: int) -> list[tuple[str, int, int, int]]:
    """List (name, location, type, array length) of the uniforms outside blocks.

    moderngl hides a uniform that shares its name with a vertex attribute; this function does not.
    """
    properties = [GL.GL_LOCATION, GL.GL_TYPE, GL.GL_ARRAY_SIZE]
    listed = _query_active(program, GL.GL_UNIFORM, properties)
    return [(n.removesuffix("[0]"), v[0], v[1], max(v[2], 1)) for n, v in listed if v[0] >= 0]


def active_blocks(program: int) -> list[tuple[str, int]]:
    """List (name, bytes) of the uniform blocks, by block index."""
    listed = _query_active(program, GL.GL_UNIFORM_BLOCK, [GL.GL_BUFFER_DATA_SIZE])
    return [(name, values[0]) for name, values in listed]


def active_block_members(program: int) -> list[tuple[str, int, int, int, int]]:
    """List (name, type, byte offset, block index, matrix stride) of the uniforms in blocks."""
    properties = [GL.GL_TYPE, GL.GL_OFFSET, GL.GL_BLOCK_INDEX, GL.GL_MATRIX_STRIDE]
    listed = _query_active(program, GL.GL_UNIFORM, properties)
    return [(n, v[0], v[1], v[2], max(v[3], 0)) for n, v in listed if v[2] >= 0]


def active_inputs(program: int) -> list[tuple[str, int]]:
    """List (name, location) of the vertex attributes, without the built-in ones."""
    listed = _query_active(program, GL.GL_PROGRAM_INPUT, [GL.GL_LOCATION])
    return [(name, v[0]) for name, v in listed if v[0] >= 0]


def create_vertex_array(inputs: list[tuple[int, int]], indices: int) -> int:
    """Create a vertex array of (location, buffer) pairs of float32 vec4, and an index buffer."""
    made = np.zeros(1, np.uint32)
    GL.glCreateVertexArrays(1, made)
    array = int(made[0])
    for slot, (location, buffer) in enumerate(inputs):
        GL.glVertexArrayVertexBuffer(array, slot, buffer, 0, 16)
        GL.glEnableVertexArrayAttrib(array, location)
        GL.glVertexArrayAttribFormat(array, location, 4, GL.GL_FLOAT, GL.GL_FALSE, 0)
        GL.glVertexArrayAttribBinding(array, location, slot)
    if indices:
        GL.glVertexArrayElementBuffer(array, indices)
    return array


def draw_elements(
    program: int,
    array: int,
    mode: int,
    count: int,
    first: int,
    instances: int,
    base_vertex: int = 0,
    base_instance: int = 0,
) -> None:
    """Draw ``count`` indices from ``first``, ``instances`` times."""
    GL.glUseProgram(program)
    GL.glBindVertexArray(array)
    offset = ctypes.c_void_p(first * 4)
    if base_vertex or base_instance:
        GL.glDrawElementsInstancedBaseVertexBaseInstance(
            mode, count, GL.GL_UNSIGNED_INT, offset, instances, base_vertex, base_instance
        )
    else:
        GL.glDrawElementsInstanced(mode, count, GL.GL_UNSIGNED_INT, offset, instances)


def draw_arrays(
    program: int,
    array: int,
    mode: int,
    count: int,
    instances: int,
    first: int = 0,
    base_instance: int = 0,
) -> None:
    """Draw ``count`` vertices from ``first`` in their order, ``instances`` times."""
    GL.glUseProgram(program)
    GL.glBindVertexArray(array)
    GL.glDrawArraysInstancedBaseInstance(mode, first, count, instances, base_instance)


def barrier() -> None:
    """Make the writes of shaders visible to all later commands."""
    GL.glMemoryBarrier(GL.GL_ALL_BARRIER_BITS)


__all__ = ["GL"]

"""Textures: storage, upload, read-back, mip levels."""

from __future__ import annotations

from dataclasses import dataclass
from math import floor, log2
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nau_py.raster import gl
from nau_py.raster.formats import PixelFormat, pixel_format
from nau_py.raster.gl import GL


@dataclass(slots=True)
class Texture:
    """An OpenGL texture. ``glo`` is its name, ``target`` its kind."""

    glo: int
    target: int
    format: PixelFormat
    width: int
    height: int
    levels: int = 1
    layers: int = 1

    def read(self, level: int = 0) -> NDArray[Any]:
        """The texels of a 2D texture: (height, width, channels), row 0 at the bottom."""
        width, height = max(self.width >> level, 1), max(self.height >> level, 1)
        out = np.empty((height, width, self.format.channels), self.format.dtype)
        gl.read_texture(self.glo, level, self.format.layout, self.format.kind, out)
        return out

    def read_values(self) -> NDArray[Any]:
        """As :meth:`read`, bytes as float32 in 0..1."""
        texels = self.read()
        return texels.astype(np.float32) / np.float32(255) if texels.dtype == np.uint8 else texels

    def write(self, data: NDArray[Any]) -> None:
        """Fill level 0 of a 2D texture from (height, width, channels), row 0 at the bottom."""
        wanted = np.ascontiguousarray(data, self.format.dtype)
        gl.upload_2d(
            self.glo, self.width, self.height, self.format.layout, self.format.kind, wanted
        )

    def clear(self, level: int | None = None) -> None:
        """Fill a level, or every one, with zero."""
        chosen = range(self.levels) if level is None else [level]
        gl.clear_texture(self.glo, list(chosen), self.format.layout, self.format.kind)

    def generate_mipmaps(self) -> None:
        if self.levels > 1:
            GL.glGenerateTextureMipmap(self.glo)

    def delete(self) -> None:
        gl.delete_textures([self.glo])


def complete_chain(width: int, height: int, depth: int = 1) -> int:
    """Levels of a complete mip chain."""
    return floor(log2(max(width, height, depth, 1))) + 1


def make_2d(
    name: str, width: int, height: int, levels: int = 1, layers: int = 1, depth: int = 1
) -> Texture:
    """Zero-filled storage of internal format ``name``: 2D, 2D array or 3D."""
    fmt = pixel_format(name)
    if depth > 1:
        texture = Texture(
            gl.create_texture(GL.GL_TEXTURE_3D), GL.GL_TEXTURE_3D, fmt, width, height, levels, depth
        )
        GL.glTextureStorage3D(texture.glo, levels, fmt.internal, width, height, depth)
    elif layers > 1:
        texture = Texture(
            gl.create_texture(GL.GL_TEXTURE_2D_ARRAY),
            GL.GL_TEXTURE_2D_ARRAY,
            fmt,
            width,
            height,
            levels,
            layers,
        )
        GL.glTextureStorage3D(texture.glo, levels, fmt.internal, width, height, layers)
    else:
        texture = Texture(
            gl.create_texture(GL.GL_TEXTURE_2D), GL.GL_TEXTURE_2D, fmt, width, height, levels
        )
        GL.glTextureStorage2D(texture.glo, levels, fmt.internal, width, height)
    if fmt.depth:
        gl.swizzle_grey(texture.glo)
    else:
        texture.clear()
    return texture


_BYTE_FORMATS = {1: "R8", 2: "RG8", 4: "RGBA"}


def from_image(texels: NDArray[np.uint8], mipmap: bool) -> Texture:
    """A texture of decoded texels (height, width, channels), row 0 at the bottom."""
    height, width, channels = texels.shape
    levels = complete_chain(width, height) if mipmap else 1
    texture = make_2d(_BYTE_FORMATS[channels], width, height, levels)
    texture.write(texels)
    texture.generate_mipmaps()
    return texture


def cube_from_images(faces: list[NDArray[np.uint8]], mipmap: bool) -> Texture:
    """A cube map from six equal RGBA faces: +x -x +y -y +z -z, rows from the bottom up."""
    height, width = faces[0].shape[:2]
    fmt = pixel_format("RGBA")
    levels = complete_chain(width, height) if mipmap else 1
    target = GL.GL_TEXTURE_CUBE_MAP
    texture = Texture(gl.create_texture(target), target, fmt, width, height, levels)
    GL.glTextureStorage2D(texture.glo, levels, fmt.internal, width, height)
    for index, face in enumerate(faces):
        gl.upload_face(texture.glo, index, width, height, fmt.layout, fmt.kind, face)
    texture.generate_mipmaps()
    return texture

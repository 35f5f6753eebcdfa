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
class GpuTexture:
    """An OpenGL texture. ``glo`` is its name, ``target`` its kind."""

    glo: int
    target: int
    format: PixelFormat
    width: int
    height: int
    levels: int = 1
    layers: int = 1
    samples: int = 0

    def read(self, level: int = 0) -> NDArray[Any]:
        """Read the texels of a 2D texture: (height, width, channels), row 0 at the bottom.

        A texel of a multisample texture is the mean of its samples; for integers and depth it is
        one of them.
        """
        if self.samples:
            return self._read_resolved()
        width, height = max(self.width >> level, 1), max(self.height >> level, 1)
        out = np.empty((height, width, self.format.channels), self.format.dtype)
        gl.read_texture(self.glo, level, self.format.layout, self.format.kind, out)
        return out

    def _read_resolved(self) -> NDArray[Any]:
        single = make_texture(self.format.name, self.width, self.height)
        gl.resolve_samples(
            self.glo, single.glo, self.width, self.height, self.format.depth, self.format.stencil
        )
        texels = single.read()
        single.delete()
        return texels

    def read_values(self) -> NDArray[Any]:
        """Read as :meth:`read` does; bytes become float32 in 0..1."""
        texels = self.read()
        return texels.astype(np.float32) / np.float32(255) if texels.dtype == np.uint8 else texels

    def write(self, data: NDArray[Any]) -> None:
        """Fill level 0 of a 2D texture from (height, width, channels), row 0 at the bottom."""
        wanted = np.ascontiguousarray(data, self.format.dtype)
        gl.upload_2d(
            self.glo, self.width, self.height, self.format.layout, self.format.kind, wanted
        )

    def write_values(self, values: NDArray[Any]) -> None:
        """Write as :meth:`write` does, from floats: normalised formats take 0..1.

        Half floats saturate, because infinity would spread through blurs.
        """
        dtype = self.format.dtype
        if np.issubdtype(dtype, np.integer) and not self.format.integer:
            scale = np.float32(np.iinfo(np.dtype(dtype)).max)
            values = np.rint(np.clip(values, 0, 1) * scale)
        elif dtype == np.float16:
            most = np.finfo(np.float16).max
            values = np.clip(values, -most, most)
        self.write(values)

    def clear(self, level: int | None = None) -> None:
        """Fill a level, or all of them, with zero."""
        chosen = range(self.levels) if level is None else [level]
        gl.clear_texture(self.glo, list(chosen), self.format.layout, self.format.kind)

    def generate_mipmaps(self) -> None:
        if self.levels > 1:
            GL.glGenerateTextureMipmap(self.glo)

    def delete(self) -> None:
        gl.delete_textures([self.glo])


def count_mip_levels(width: int, height: int, depth: int = 1) -> int:
    """Count the levels of a complete mip chain."""
    return floor(log2(max(width, height, depth, 1))) + 1


def make_texture(
    name: str,
    width: int,
    height: int,
    levels: int = 1,
    layers: int = 1,
    depth: int = 0,
    samples: int = 0,
    cube: bool = False,
) -> GpuTexture:
    """Make a texture of internal format ``name``, filled with zero.

    It is a cube map, multisample, 3D, array or 2D texture; the first that the sizes ask for, in
    that order (docs/format.md, 6.3). ``depth`` 0 is none. A cube map is
    ``width`` on each side; a multisample texture has one level.
    """
    fmt = pixel_format(name)
    sizes: tuple[int, ...]
    if cube:
        target, sizes = GL.GL_TEXTURE_CUBE_MAP, (width, width)
    elif samples > 1 and layers > 1:
        target, sizes = GL.GL_TEXTURE_2D_MULTISAMPLE_ARRAY, (width, height, layers)
    elif samples > 1:
        target, sizes = GL.GL_TEXTURE_2D_MULTISAMPLE, (width, height)
    elif depth > 0:
        target, sizes = GL.GL_TEXTURE_3D, (width, height, depth)
    elif layers > 1:
        target, sizes = GL.GL_TEXTURE_2D_ARRAY, (width, height, layers)
    else:
        target, sizes = GL.GL_TEXTURE_2D, (width, height)
    texture = GpuTexture(gl.create_texture(target), target, fmt, *sizes[:2])
    texture.layers = 6 if cube else sizes[2] if len(sizes) == 3 else 1
    storage = f"glTextureStorage{len(sizes)}D"
    if samples > 1 and not cube:
        texture.samples = samples
        allocate = getattr(GL, f"{storage}Multisample")
        allocate(texture.glo, samples, fmt.internal, *sizes, GL.GL_TRUE)
    else:
        texture.levels = levels
        getattr(GL, storage)(texture.glo, levels, fmt.internal, *sizes)
    if fmt.depth and texture.samples == 0:
        gl.swizzle_grey(texture.glo)
    elif not fmt.depth:
        texture.clear()
    return texture


_BYTE_FORMATS = {1: "R8", 2: "RG8", 4: "RGBA"}


def make_image_texture(texels: NDArray[np.uint8], mipmap: bool) -> GpuTexture:
    """Make a texture of decoded texels (height, width, channels), row 0 at the bottom."""
    height, width, channels = texels.shape
    levels = count_mip_levels(width, height) if mipmap else 1
    texture = make_texture(_BYTE_FORMATS[channels], width, height, levels)
    texture.write(texels)
    texture.generate_mipmaps()
    return texture


_VOLUME_FORMATS = {"uint8": "R8", "uint16": "R16", "float32": "R32F"}


def make_volume_texture(texels: NDArray[Any]) -> GpuTexture:
    """Make a 3D texture of one channel from (depth, height, width): uint8, uint16 or float32."""
    depth, height, width = texels.shape
    name = _VOLUME_FORMATS[texels.dtype.name]
    texture = make_texture(name, width, height, depth=depth)
    fmt = texture.format
    gl.upload_3d(texture.glo, width, height, depth, fmt.layout, fmt.kind, texels)
    return texture


def make_cube_map(faces: list[NDArray[np.uint8]], mipmap: bool) -> GpuTexture:
    """Make a cube map from six equal RGBA faces: +x -x +y -y +z -z, rows from the bottom up."""
    height, width = faces[0].shape[:2]
    levels = count_mip_levels(width, height) if mipmap else 1
    texture = make_texture("RGBA", width, height, levels, cube=True)
    fmt = texture.format
    for index, face in enumerate(faces):
        gl.upload_face(texture.glo, index, width, height, fmt.layout, fmt.kind, face)
    texture.generate_mipmaps()
    return texture

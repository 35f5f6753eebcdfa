"""Textures of a material library (docs/format.md, 6.3 and 6.7)."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nau_py.model.node import Attr, Configured, Node, NodeSettings, Settings
from nau_py.model.values import DataType


class Texture(Configured):
    """An image file, or storage that the child tags describe."""

    name: Annotated[str | None, Attr(doc="Texture name.", required=True)] = None
    filename: Annotated[str | None, Attr(doc="Image file.", file="texture")] = None
    mipmap: Annotated[bool | None, Attr(DataType.BOOL, "Generate mip levels.")] = None
    settings: Annotated[NodeSettings, Settings("TEXTURE", "Without a filename.")] = Field(
        default_factory=dict
    )


_FACE = Attr(doc="Image of one face.", required=True, file="texture")


class CubeMap(Node):
    """Six images."""

    name: Annotated[str | None, Attr(doc="Texture name.", required=True)] = None
    filePosX: Annotated[str | None, _FACE] = None
    fileNegX: Annotated[str | None, _FACE] = None
    filePosY: Annotated[str | None, _FACE] = None
    fileNegY: Annotated[str | None, _FACE] = None
    filePosZ: Annotated[str | None, _FACE] = None
    fileNegZ: Annotated[str | None, _FACE] = None
    mipmap: Annotated[str | None, Attr(doc="Only the exact text `true` counts.")] = None


class ArrayOfTextures(Configured):
    """An array of TEXTURE_COUNT textures, named NAME_0, NAME_1 and so on."""

    name: Annotated[str | None, Attr(doc="Name of the array.", required=True)] = None
    settings: Annotated[NodeSettings, Settings("ARRAY_OF_TEXTURES")] = Field(default_factory=dict)

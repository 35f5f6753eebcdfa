"""Materials: colours, textures, buffers, state, shader, uniforms (docs/format.md, 6.8)."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nau_py.model.node import Attr, Child, Configured, Items, Node, NodeSettings, Settings
from nau_py.model.values import DataType


class ColorBlock(Configured):
    """Colours of a material."""

    settings: Annotated[NodeSettings, Settings("COLOR")] = Field(default_factory=dict)


class TextureUnit(Configured):
    """A texture bound to a unit, with sampler settings."""

    name: Annotated[
        str | None, Attr(doc="Texture, own library or `lib::name`.", required=True, ref="texture")
    ] = None
    UNIT: Annotated[int | None, Attr(DataType.INT, "Texture unit.", required=True)] = None
    settings: Annotated[NodeSettings, Settings("TEXTURE_SAMPLER")] = Field(default_factory=dict)


class ImageUnit(Configured):
    """A texture bound to an image unit, for loads and stores."""

    texture: Annotated[
        str | None, Attr(doc="Texture, own library or `lib::name`.", required=True, ref="texture")
    ] = None
    UNIT: Annotated[int | None, Attr(DataType.INT, "Image unit.", required=True)] = None
    settings: Annotated[NodeSettings, Settings("IMAGE_TEXTURE")] = Field(default_factory=dict)


class ImageUnits(Configured):
    """An array of textures bound to consecutive image units."""

    FIRST_UNIT: Annotated[int | None, Attr(DataType.INT, "First unit.", required=True)] = None
    textureArray: Annotated[
        str | None, Attr(doc="Array of textures.", required=True, ref="texture array")
    ] = None
    settings: Annotated[NodeSettings, Settings("ARRAY_OF_IMAGE_TEXTURES")] = Field(
        default_factory=dict
    )


class TextureUnits(Configured):
    """An array of textures bound to consecutive units."""

    name: Annotated[
        str | None, Attr(doc="Array of textures.", required=True, ref="texture array")
    ] = None
    firstUnit: Annotated[int | None, Attr(DataType.INT, "First unit.", required=True)] = None
    settings: Annotated[NodeSettings, Settings("TEXTURE_SAMPLER")] = Field(default_factory=dict)


class BufferUnit(Configured):
    """A buffer bound to a binding point."""

    name: Annotated[
        str | None, Attr(doc="Buffer, own library or `lib::name`.", required=True, ref="buffer")
    ] = None
    fromLibrary: Annotated[
        str | None, Attr(doc="Looked in only where the own library has no such buffer.")
    ] = None
    settings: Annotated[NodeSettings, Settings("BUFFER_BINDING")] = Field(default_factory=dict)


class StateReference(Node):
    """The state of a material, from the same library."""

    name: Annotated[str | None, Attr(doc="State name.", required=True, ref="state")] = None


class ValueOf(Node):
    """The source of the value of a uniform."""

    uniform: Annotated[str | None, Attr(doc="GLSL name.", required=True)] = None
    type: Annotated[str | None, Attr(doc="Object type.", required=True, ref="object type")] = None
    context: Annotated[str | None, Attr(doc="Object name; default CURRENT.")] = None
    component: Annotated[str | None, Attr(doc="Attribute of the type.", required=True)] = None
    id: Annotated[int | None, Attr(DataType.INT, "Unit, binding point or light index.")] = None
    block: Annotated[str | None, Attr(doc="Uniform block of the uniform.")] = None


class ShaderReference(Node):
    """The program of a material, with the sources of its uniforms."""

    name: Annotated[str | None, Attr(doc="Shader name.", required=True, ref="shader")] = None
    values: Annotated[list[ValueOf], Items(ValueOf, "valueof", "values")] = Field(
        default_factory=list
    )


class Material(Node):
    """A copy of ``__nauDefault`` with the parts that the file changes."""

    name: Annotated[str | None, Attr(doc="Material name.", required=True)] = None
    color: Annotated[ColorBlock | None, Child(ColorBlock)] = None
    textures: Annotated[list[TextureUnit], Items(TextureUnit, "texture", "textures")] = Field(
        default_factory=list
    )
    imageTextures: Annotated[list[ImageUnit], Items(ImageUnit, "imageTexture", "imageTextures")] = (
        Field(default_factory=list)
    )
    arraysOfImageTexture: Annotated[
        list[ImageUnits], Items(ImageUnits, "arrayOfImageTexture", "arraysOfImageTexture")
    ] = Field(default_factory=list)
    arraysOfTextures: Annotated[
        list[TextureUnits], Items(TextureUnits, "arrayOfTextures", "arraysOfTextures")
    ] = Field(default_factory=list)
    buffers: Annotated[list[BufferUnit], Items(BufferUnit, "buffer", "buffers")] = Field(
        default_factory=list
    )
    state: Annotated[StateReference | None, Child(StateReference)] = None
    shader: Annotated[ShaderReference | None, Child(ShaderReference)] = None

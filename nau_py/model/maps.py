"""Material maps and injection maps of a pass (docs/format.md, 4.6 and 4.7)."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nau_py.model.node import Attr, Child, Configured, Items, Node, NodeSettings, Settings
from nau_py.model.values import DataType


class MaterialMap(Node):
    """Replacement of material ``fromMaterial`` by another one."""

    fromMaterial: Annotated[
        str | None, Attr(doc="Name, or prefix and a final `*`.", required=True)
    ] = None
    toLibrary: Annotated[
        str | None, Attr(doc="Library; default the default library.", ref="library")
    ] = None
    toMaterial: Annotated[
        str | None,
        Attr(doc="Material to draw with.", required=True, ref="material", library="toLibrary"),
    ] = None


_FROM_LIBRARY = Attr(doc="Library.", required=True, ref="library")


class InjectedState(Node):
    """A state to inject."""

    name: Annotated[
        str | None, Attr(doc="State.", required=True, ref="state", library="fromLibrary")
    ] = None
    fromLibrary: Annotated[str | None, _FROM_LIBRARY] = None


class InjectedShader(Node):
    """A shader with its uniform sources, taken from a material."""

    fromMaterial: Annotated[
        str | None, Attr(doc="Material.", required=True, ref="material", library="fromLibrary")
    ] = None
    fromLibrary: Annotated[str | None, _FROM_LIBRARY] = None


class InjectedColor(Node):
    """Colours of a material: the flagged ones, or all without a flag."""

    fromMaterial: Annotated[
        str | None, Attr(doc="Material.", required=True, ref="material", library="fromLibrary")
    ] = None
    fromLibrary: Annotated[str | None, _FROM_LIBRARY] = None
    ambient: Annotated[str | None, Attr(doc="`true` copies it.")] = None
    diffuse: Annotated[str | None, Attr(doc="`true` copies it.")] = None
    specular: Annotated[str | None, Attr(doc="`true` copies it.")] = None
    emission: Annotated[str | None, Attr(doc="`true` copies it.")] = None
    shininess: Annotated[str | None, Attr(doc="`true` copies it.")] = None


class InjectedTexture(Configured):
    """A texture to inject on a unit."""

    name: Annotated[
        str | None, Attr(doc="Texture.", required=True, ref="texture", library="fromLibrary")
    ] = None
    fromLibrary: Annotated[str | None, _FROM_LIBRARY] = None
    toUnit: Annotated[int | None, Attr(DataType.INT, "Unit.", required=True)] = None
    settings: Annotated[NodeSettings, Settings("TEXTURE_SAMPLER")] = Field(default_factory=dict)


class InjectedImage(Configured):
    """An image texture to inject on a unit."""

    texture: Annotated[
        str | None, Attr(doc="Texture.", required=True, ref="texture", library="fromLibrary")
    ] = None
    fromLibrary: Annotated[str | None, _FROM_LIBRARY] = None
    toUnit: Annotated[int | None, Attr(DataType.INT, "Unit.", required=True)] = None
    settings: Annotated[NodeSettings, Settings("IMAGE_TEXTURE")] = Field(default_factory=dict)


class InjectedBuffer(Configured):
    """A buffer to inject on a binding point."""

    name: Annotated[
        str | None, Attr(doc="Buffer.", required=True, ref="buffer", library="fromLibrary")
    ] = None
    fromLibrary: Annotated[str | None, _FROM_LIBRARY] = None
    settings: Annotated[NodeSettings, Settings("BUFFER_BINDING")] = Field(default_factory=dict)


class InjectedImageArray(Configured):
    """An array of image textures to inject."""

    textureArray: Annotated[
        str | None, Attr(doc="`lib::array`.", required=True, ref="texture array")
    ] = None
    FIRST_UNIT: Annotated[int | None, Attr(DataType.INT, "First unit.", required=True)] = None
    settings: Annotated[NodeSettings, Settings("ARRAY_OF_IMAGE_TEXTURES")] = Field(
        default_factory=dict
    )


class InjectionMap(Node):
    """Changes to every material that matches ``toMaterial``, for this pass."""

    toMaterial: Annotated[
        str | None, Attr(doc="Name, or prefix and a final `*`.", required=True)
    ] = None
    state: Annotated[InjectedState | None, Child(InjectedState)] = None
    shader: Annotated[InjectedShader | None, Child(InjectedShader)] = None
    color: Annotated[InjectedColor | None, Child(InjectedColor)] = None
    textures: Annotated[list[InjectedTexture], Items(InjectedTexture, "texture", "textures")] = (
        Field(default_factory=list)
    )
    imageTextures: Annotated[
        list[InjectedImage], Items(InjectedImage, "imageTexture", "imageTextures")
    ] = Field(default_factory=list)
    buffers: Annotated[list[InjectedBuffer], Items(InjectedBuffer, "buffer", "buffers")] = Field(
        default_factory=list
    )
    arraysOfImageTexture: Annotated[
        list[InjectedImageArray],
        Items(InjectedImageArray, "arrayOfImageTexture", "arraysOfImageTexture"),
    ] = Field(default_factory=list)


def match_pattern(pattern: str, name: str) -> bool:
    """Match Nau's pattern: an exact name, or a prefix followed by a final ``*``."""
    if pattern.endswith("*"):
        return name.startswith(pattern[:-1])
    return name == pattern

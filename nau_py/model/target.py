"""Render targets (docs/format.md, 6.1)."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nau_py.model.attributes.texture import COLOR_FORMATS, DEPTH_FORMATS
from nau_py.model.node import Attr, Child, Configured, Node, NodeSettings, Settings, Variants


class ColorAttachment(Node):
    """A colour target; the n-th one is draw buffer n."""

    name: Annotated[str | None, Attr(doc="Texture name.", required=True)] = None
    internalFormat: Annotated[
        str | None, Attr(doc="Texel format.", required=True, values=COLOR_FORMATS)
    ] = None


class CubeMapAttachment(ColorAttachment):
    """A cube map of colour targets."""


class DepthAttachment(Node):
    """The depth target."""

    name: Annotated[str | None, Attr(doc="Texture name.", required=True)] = None
    internalFormat: Annotated[
        str | None, Attr(doc="Depth format.", required=True, values=DEPTH_FORMATS)
    ] = None


class DepthStencilAttachment(Node):
    """Depth and stencil in one target, DEPTH24_STENCIL8."""

    name: Annotated[str | None, Attr(doc="Texture name.", required=True)] = None


class RenderTarget(Configured):
    """Textures that passes draw into. Each can be used like a texture of the library."""

    name: Annotated[str | None, Attr(doc="Render target name.", required=True)] = None
    colors: Annotated[
        list[ColorAttachment | CubeMapAttachment],
        Variants({"color": ColorAttachment, "cubemap": CubeMapAttachment}, "colors"),
    ] = Field(default_factory=list)
    depth: Annotated[DepthAttachment | None, Child(DepthAttachment)] = None
    depthStencil: Annotated[DepthStencilAttachment | None, Child(DepthStencilAttachment)] = None
    settings: Annotated[NodeSettings, Settings("RENDER_TARGET")] = Field(default_factory=dict)

    @property
    def depth_name(self) -> str:
        """Return the name of its depth texture, the hidden one included (docs/format.md, 6.1)."""
        attachment = self.depth or self.depthStencil
        return (attachment.name if attachment else None) or f"{self.name}_depth"

    @property
    def texture_names(self) -> list[str]:
        """Names of all textures, the hidden depth texture included."""
        return [color.name or "" for color in self.colors] + [self.depth_name]

"""The model of class ``mask``: selectors of the pixels that a raytrace pass traces.

A selector gives every pixel a weight from 0 to 1; ``and`` is the least of its parts, ``or`` the
greatest, ``not`` 1 minus the greatest.
"""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nau_py.model.node import Attr, Node, Variants
from nau_py.model.passes import Pass
from nau_py.model.values import DataType

FLOAT = DataType.FLOAT


class MaterialSelector(Node):
    """1 where the visible surface has this material."""

    name: Annotated[str | None, Attr(doc="Material, or prefix and a final `*`.", required=True)] = (
        None
    )


class PropertySelector(Node):
    """1 where a COLOR attribute of the visible material is between two bounds; for a colour, its
    greatest component."""

    name: Annotated[str | None, Attr(doc="COLOR attribute.", required=True)] = None
    above: Annotated[float | None, Attr(FLOAT, "Chosen where the value is greater.")] = None
    below: Annotated[float | None, Attr(FLOAT, "Chosen where the value is less.")] = None


class RegionSelector(Node):
    """1 inside a rectangle of the picture, in parts of its width and height from the lower left."""

    x: Annotated[float | None, Attr(FLOAT, "Left, 0 to 1; default 0.")] = None
    y: Annotated[float | None, Attr(FLOAT, "Bottom, 0 to 1; default 0.")] = None
    width: Annotated[float | None, Attr(FLOAT, "Part of the width; default 1.")] = None
    height: Annotated[float | None, Attr(FLOAT, "Part of the height; default 1.")] = None
    edge: Annotated[float | None, Attr(FLOAT, "Width of the linear edge, pixels; default 0.")] = (
        None
    )


class DistanceSelector(Node):
    """1 up to a distance from the camera, then linear down to a floor."""

    near: Annotated[float | None, Attr(FLOAT, "Full up to here, world units.", required=True)] = (
        None
    )
    far: Annotated[float | None, Attr(FLOAT, "The floor from here on; default `near`.")] = None
    floor: Annotated[float | None, Attr(FLOAT, "Weight beyond `far`; default 0.")] = None


class GazeSelector(Node):
    """1 around the point of gaze, then linear down to a constant floor."""

    x: Annotated[float | None, Attr(FLOAT, "Point, part of the width; default 0.5.")] = None
    y: Annotated[float | None, Attr(FLOAT, "Point, part of the height; default 0.5.")] = None
    inner: Annotated[
        float | None, Attr(FLOAT, "Radius of the fovea, parts of the height.", required=True)
    ] = None
    outer: Annotated[
        float | None, Attr(FLOAT, "Radius at which the floor begins; default `inner`.")
    ] = None
    floor: Annotated[float | None, Attr(FLOAT, "Weight outside; default 0.")] = None


class ShadowBorderSelector(Node):
    """1 at the border of a shadow: of the nine texels of the shadow map around a point, some are
    nearer to the light than the surface and some are not."""

    texture: Annotated[
        str | None, Attr(doc="Depth texture, `lib::name`.", required=True, ref="texture")
    ] = None
    camera: Annotated[str | None, Attr(doc="Camera that drew it.", required=True, ref="camera")] = (
        None
    )
    radius: Annotated[
        int | None, Attr(DataType.INT, "Distance of the eight neighbours, texels; default 1.")
    ] = None
    spread: Annotated[
        float | None,
        Attr(
            FLOAT,
            "Tangent of the light's half angle; leaves out blockers so near the surface that their "
            "penumbra is narrower than `radius`; default 0: none.",
        ),
    ] = None
    bias: Annotated[float | None, Attr(FLOAT, "Depth bias, 0 to 1; default 0.002.")] = None


class TextureSelector(Node):
    """A component of a texture of the picture's size, clamped to 0 to 1."""

    name: Annotated[str | None, Attr(doc="Texture, `lib::name`.", required=True, ref="texture")] = (
        None
    )
    component: Annotated[str | None, Attr(doc="Default the last.", values=("x", "y", "z", "w"))] = (
        None
    )


SELECTORS: dict[str, type[Node]] = {
    "material": MaterialSelector,
    "property": PropertySelector,
    "region": RegionSelector,
    "distance": DistanceSelector,
    "gaze": GazeSelector,
    "shadowBorder": ShadowBorderSelector,
    "texture": TextureSelector,
}


class AndSelector(Node):
    """The least of its parts."""

    parts: Annotated[list[Node], Variants(SELECTORS)] = Field(default_factory=list)


class OrSelector(Node):
    """The greatest of its parts."""

    parts: Annotated[list[Node], Variants(SELECTORS)] = Field(default_factory=list)


class NotSelector(Node):
    """1 minus the greatest of its parts."""

    parts: Annotated[list[Node], Variants(SELECTORS)] = Field(default_factory=list)


SELECTORS |= {"and": AndSelector, "or": OrSelector, "not": NotSelector}


class MaskPass(Pass):
    """Writes world position into the first three components of its target, weight into the last.
    Several selectors are joined by `or`; without a selector every pixel is selected."""

    select: Annotated[list[Node], Variants(SELECTORS, "select")] = Field(default_factory=list)

    def all_selectors(self) -> list[Node]:
        """Return every selector, also those inside others, in file order."""
        return [node for top in self.select for node in top.walk()]

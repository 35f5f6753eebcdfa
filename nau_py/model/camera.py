"""Cameras (docs/format.md, 3.7)."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nau_py.model.node import Attr, Child, Configured, Inline, NodeSettings, Settings


class Projection(Configured):
    """Projection parameters as XML attributes: TYPE FOV NEAR FAR LEFT RIGHT TOP BOTTOM."""

    settings: Annotated[NodeSettings, Inline("CAMERA")] = Field(default_factory=dict)


class Camera(Configured):
    """A camera. Its tags are applied in file order."""

    name: Annotated[str | None, Attr(doc="Camera name.", required=True)] = None
    projection: Annotated[
        Projection | None, Child(Projection, doc="Applied after the other tags.")
    ] = None
    settings: Annotated[NodeSettings, Settings("CAMERA")] = Field(default_factory=dict)

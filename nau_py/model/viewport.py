"""Viewports (docs/format.md, 3.5)."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nau_py.model.node import Attr, Configured, NodeSettings, Settings


class Viewport(Configured):
    """A rectangle of the window, with a clear colour."""

    name: Annotated[str | None, Attr(doc="Viewport name.", required=True)] = None
    settings: Annotated[NodeSettings, Settings("VIEWPORT")] = Field(default_factory=dict)

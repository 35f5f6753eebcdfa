"""Fixed-function states of materials (docs/format.md, 6.4)."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nau_py.model.node import Attr, Configured, NodeSettings, Settings


class State(Configured):
    """Depth test, culling, blending and drawing order."""

    name: Annotated[str | None, Attr(doc="State name.", required=True)] = None
    settings: Annotated[NodeSettings, Settings("STATE")] = Field(default_factory=dict)

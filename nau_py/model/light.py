"""Lights (docs/format.md, 3.6)."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nau_py.model.node import Attr, Configured, NodeSettings, Settings


class Light(Configured):
    """A light. A second one of the same name changes the first."""

    name: Annotated[str | None, Attr(doc="Light name.", required=True)] = None
    settings: Annotated[NodeSettings, Settings("LIGHT")] = Field(default_factory=dict)

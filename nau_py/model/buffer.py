"""Buffers of a material library (docs/format.md, 6.6)."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nau_py.model.node import Attr, Child, Configured, Items, Node, NodeSettings, Settings
from nau_py.model.values import STRUCTURE_TYPES


class StructureField(Node):
    """One field of a buffer's record."""

    value: Annotated[
        str | None, Attr(doc="Data type.", required=True, values=tuple(STRUCTURE_TYPES))
    ] = None


class BufferFile(Node):
    """Initial content: ``.nbb`` is raw, every other file is text."""

    name: Annotated[str | None, Attr(doc="Path.", required=True, file="buffer")] = None


class Buffer(Configured):
    """GPU storage."""

    name: Annotated[str | None, Attr(doc="Buffer name.", required=True)] = None
    structure: Annotated[
        list[StructureField], Items(StructureField, "field", "structure", "Record layout.")
    ] = Field(default_factory=list)
    file: Annotated[BufferFile | None, Child(BufferFile)] = None
    settings: Annotated[NodeSettings, Settings("BUFFER")] = Field(default_factory=dict)

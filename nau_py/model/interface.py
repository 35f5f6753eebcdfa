"""The user interface that a project declares (docs/format.md, 4.8)."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nau_py.model.node import Attr, Items, Node
from nau_py.model.values import DataType


class Atomic(Node):
    """A label of an atomic counter."""

    semantics: Annotated[str | None, Attr(doc="Label.", required=True)] = None
    offset: Annotated[int | None, Attr(DataType.INT, "Byte offset.", required=True)] = None
    buffer: Annotated[str | None, Attr(doc="Buffer.", required=True)] = None
    fromLibrary: Annotated[str | None, Attr(doc="Library.")] = None


class PipelineList(Node):
    """A chooser of pipelines."""

    label: Annotated[str | None, Attr(doc="Label.", required=True)] = None
    script: Annotated[str | None, Attr(doc="Lua function.")] = None
    scriptFile: Annotated[str | None, Attr(doc="Lua file.", file="script")] = None


class InterfaceVariable(Node):
    """A value that the user can change."""

    label: Annotated[str | None, Attr(doc="Label.", required=True)] = None
    type: Annotated[str | None, Attr(doc="Object type.", required=True, ref="object type")] = None
    context: Annotated[str | None, Attr(doc="Object name.", required=True)] = None
    component: Annotated[str | None, Attr(doc="Attribute of the type.", required=True)] = None
    id: Annotated[int | None, Attr(DataType.INT, "Index.")] = None
    mode: Annotated[str | None, Attr(doc="Widget.", values=("COLOR", "DIRECTION"))] = None
    def_: Annotated[str | None, Attr(name="def", doc="`min= max= step=` text.")] = None
    strings: Annotated[str | None, Attr(doc="Comma list for an INT.")] = None
    script: Annotated[str | None, Attr(doc="Lua function.")] = None
    scriptFile: Annotated[str | None, Attr(doc="Lua file.", file="script")] = None


class Window(Node):
    """A group of variables."""

    label: Annotated[str | None, Attr(doc="Title.", required=True)] = None
    lists: Annotated[list[PipelineList], Items(PipelineList, "pipelineList")] = Field(
        default_factory=list
    )
    variables: Annotated[list[InterfaceVariable], Items(InterfaceVariable, "var")] = Field(
        default_factory=list
    )


class Interface(Node):
    """Windows and counter labels."""

    atomics: Annotated[list[Atomic], Items(Atomic, "atomic", "atomics")] = Field(
        default_factory=list
    )
    windows: Annotated[list[Window], Items(Window, "window")] = Field(default_factory=list)

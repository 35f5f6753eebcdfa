"""Pipelines (docs/format.md, 4.1 and 4.2)."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nau_py.model.node import Attr, Child, Choice, Items, Node
from nau_py.model.pass_classes import PASS_CLASSES, OtherPass
from nau_py.model.passes import Pass, Script
from nau_py.model.values import DataType


class Pipeline(Node):
    """A sequence of passes."""

    name: Annotated[str | None, Attr(doc="Pipeline name.", required=True)] = None
    defaultCamera: Annotated[str | None, Attr(doc="Camera that the user steers.", ref="camera")] = (
        None
    )
    frameCount: Annotated[int | None, Attr(DataType.UINT, "Frames, in mode RUN_ALL.")] = None
    preScript: Annotated[Script | None, Child(Script)] = None
    postScript: Annotated[Script | None, Child(Script)] = None
    testScript: Annotated[Script | None, Child(Script)] = None
    passes: Annotated[
        list[Pass],
        Items(
            Pass,
            "pass",
            doc="Executed in document order.",
            choice=Choice("class", "default", PASS_CLASSES, OtherPass),
        ),
    ] = Field(default_factory=list)


class Pipelines(Node):
    """All pipelines of a project."""

    default: Annotated[
        str | None, Attr(doc="Pipeline to start with; else the first.", ref="pipeline")
    ] = None
    mode: Annotated[
        str | None,
        Attr(
            doc="The default one, or all in order.",
            values=("RUN_DEFAULT", "RUN_ALL"),
        ),
    ] = None
    pipelines: Annotated[list[Pipeline], Items(Pipeline, "pipeline")] = Field(default_factory=list)

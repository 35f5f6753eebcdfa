"""Shader programs of a material library (docs/format.md, 6.5)."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nau_py.model.node import Attr, Child, Items, Node

STAGES = ("vs", "gs", "tc", "te", "ps", "cs", "ts", "ms")


class StageFile(Node):
    """One source file of a stage; files are concatenated in order."""

    name: Annotated[str | None, Attr(doc="Path.", required=True, file="shader")] = None


class StageFiles(Node):
    """The source files of one stage."""

    files: Annotated[list[StageFile], Items(StageFile, "file")] = Field(default_factory=list)


def _stage(name: str) -> Attr:
    return Attr(name=name, file="shader", doc=f"Source file of stage {name}.")


class Shader(Node):
    """A GLSL program: one file or a list of files a stage."""

    name: Annotated[str | None, Attr(doc="Shader name.", required=True)] = None
    vs: Annotated[str | None, _stage("vs")] = None
    gs: Annotated[str | None, _stage("gs")] = None
    tc: Annotated[str | None, _stage("tc")] = None
    te: Annotated[str | None, _stage("te")] = None
    ps: Annotated[str | None, _stage("ps")] = None
    cs: Annotated[str | None, _stage("cs")] = None
    ts: Annotated[str | None, _stage("ts")] = None
    ms: Annotated[str | None, _stage("ms")] = None
    vs_files: Annotated[StageFiles | None, Child(StageFiles, "vs")] = None
    gs_files: Annotated[StageFiles | None, Child(StageFiles, "gs")] = None
    tc_files: Annotated[StageFiles | None, Child(StageFiles, "tc")] = None
    te_files: Annotated[StageFiles | None, Child(StageFiles, "te")] = None
    ps_files: Annotated[StageFiles | None, Child(StageFiles, "ps")] = None
    cs_files: Annotated[StageFiles | None, Child(StageFiles, "cs")] = None
    ts_files: Annotated[StageFiles | None, Child(StageFiles, "ts")] = None
    ms_files: Annotated[StageFiles | None, Child(StageFiles, "ms")] = None

    def files(self, stage: str) -> list[str]:
        """Return the paths of a stage's source files, as written, in order."""
        single = getattr(self, stage)
        listed = getattr(self, f"{stage}_files")
        found = [single] if single else []
        return found + [f.name for f in (listed.files if listed else []) if f.name]

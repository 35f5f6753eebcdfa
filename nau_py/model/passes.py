"""The model that all pass classes share (docs/format.md, 4.3 and 4.5)."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nau_py.model.attributes.passes import RUN_MODES
from nau_py.model.maps import InjectionMap, MaterialMap
from nau_py.model.node import (
    Attr,
    Child,
    Configured,
    Inline,
    Items,
    Node,
    NodeSettings,
    Settings,
    Variants,
)
from nau_py.model.values import DataType


class Script(Node):
    """A Lua function of a file."""

    file: Annotated[str | None, Attr(doc="Path.", required=True, file="script")] = None
    script: Annotated[str | None, Attr(doc="Function name.", required=True)] = None


class TestScript(Script):
    """A Lua function that decides if the pass runs."""

    TEST_MODE: Annotated[
        str | None, Attr(doc="Once, or again while true.", values=("RUN_IF", "RUN_WHILE"))
    ] = None


class Mode(Node):
    """The frames in which the pass runs."""

    value: Annotated[str | None, Attr(doc="Run mode.", required=True, values=RUN_MODES)] = None


class ProcessTexture(Configured):
    """A texture to clear or to give mip levels."""

    name: Annotated[
        str | None, Attr(doc="Texture.", required=True, ref="texture", library="fromLibrary")
    ] = None
    fromLibrary: Annotated[str | None, Attr(doc="Library.", ref="library")] = None
    settings: Annotated[NodeSettings, Inline("PASS_PRE_PROCESS_TEXTURE")] = Field(
        default_factory=dict
    )


class ProcessBuffer(Configured):
    """A buffer to clear."""

    name: Annotated[
        str | None, Attr(doc="Buffer.", required=True, ref="buffer", library="fromLibrary")
    ] = None
    fromLibrary: Annotated[str | None, Attr(doc="Library.", ref="library")] = None
    settings: Annotated[NodeSettings, Inline("PASS_PRE_PROCESS_BUFFER")] = Field(
        default_factory=dict
    )


_PROCESS = {"texture": ProcessTexture, "buffer": ProcessBuffer}
ProcessItems = list[ProcessTexture | ProcessBuffer]


class SceneReference(Node):
    """A scene that the pass draws."""

    name: Annotated[str | None, Attr(doc="Scene.", required=True, ref="scene")] = None


class SceneReferences(Node):
    """The scenes of a pass."""

    instances: Annotated[
        int | str | None, Attr(DataType.UINT, "Above 0: instanced drawing.", constant=True)
    ] = None
    drawIndirectBuffer: Annotated[
        str | None, Attr(doc="Buffer of indirect draw commands, `lib::buffer`.", ref="buffer")
    ] = None
    scenes: Annotated[list[SceneReference], Items(SceneReference, "scene")] = Field(
        default_factory=list
    )


class LightReference(Node):
    """A light of the pass; the order is the light index."""

    name: Annotated[str | None, Attr(doc="Light.", required=True, ref="light")] = None


class ViewportReference(Node):
    """A viewport of the pass."""

    name: Annotated[str | None, Attr(doc="Viewport.", required=True, ref="viewport")] = None


class TargetReference(Node):
    """The render target of the pass, or that of an earlier pass."""

    name: Annotated[
        str | None, Attr(doc="Render target.", ref="render target", library="fromLibrary")
    ] = None
    fromLibrary: Annotated[str | None, Attr(doc="Library.", ref="library")] = None
    sameas: Annotated[str | None, Attr(doc="Name of an earlier pass.", ref="pass")] = None


class Pass(Configured):
    """One step of a pipeline."""

    name: Annotated[str | None, Attr(doc="Pass name.", required=True)] = None
    class_: Annotated[str | None, Attr(name="class", doc="Pass class; default `default`.")] = None
    mode: Annotated[Mode | None, Child(Mode)] = None
    testScript: Annotated[TestScript | None, Child(TestScript)] = None
    preScript: Annotated[Script | None, Child(Script)] = None
    postScript: Annotated[Script | None, Child(Script)] = None
    preProcess: Annotated[ProcessItems, Variants(_PROCESS, "preProcess")] = Field(
        default_factory=list
    )
    postProcess: Annotated[ProcessItems, Variants(_PROCESS, "postProcess")] = Field(
        default_factory=list
    )
    scenes: Annotated[SceneReferences | None, Child(SceneReferences)] = None
    viewport: Annotated[ViewportReference | None, Child(ViewportReference)] = None
    viewports: Annotated[
        list[ViewportReference], Items(ViewportReference, "viewport", "viewports")
    ] = Field(default_factory=list)
    renderTarget: Annotated[TargetReference | None, Child(TargetReference)] = None
    lights: Annotated[list[LightReference], Items(LightReference, "light", "lights")] = Field(
        default_factory=list
    )
    injectionMaps: Annotated[
        list[InjectionMap], Items(InjectionMap, "map", "injectionMaps", "Applied first.")
    ] = Field(default_factory=list)
    materialMaps: Annotated[
        list[MaterialMap], Items(MaterialMap, "map", "materialMaps", "Applied last; they win.")
    ] = Field(default_factory=list)
    settings: Annotated[NodeSettings, Settings("PASS")] = Field(default_factory=dict)

    @property
    def pass_class(self) -> str:
        """The value of ``class``, or ``default``."""
        return self.class_ or "default"

    @property
    def scene_names(self) -> list[str]:
        """Names of its scenes, without repetition."""
        listed = self.scenes.scenes if self.scenes else []
        return list(dict.fromkeys(s.name for s in listed if s.name))

    @property
    def run_mode(self) -> str:
        """The run mode, RUN_ALWAYS where the file gives none."""
        return (self.mode.value if self.mode else None) or "RUN_ALWAYS"

    @property
    def camera_name(self) -> str | None:
        """The camera that the file names, or None."""
        parts = self.get("camera")
        return str(parts[0]) if parts else None

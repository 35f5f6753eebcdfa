"""Scenes: what is drawn (docs/format.md, 3.4)."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nau_py.model.node import (
    Attr,
    Configured,
    Inline,
    Items,
    Node,
    NodeSettings,
    Settings,
    Variants,
)

SCENE_TYPES = (
    "OctreeUnified",
    "Scene",
    "Octree",
    "OctreeByMat",
    "ScenePoses",
    "SceneSkeleton",
    "SceneAux",
)
PRIMITIVES = ("BOX", "SQUARE", "SPHERE", "GRID", "AXIS")
TOPOLOGIES = (
    "TRIANGLES",
    "TRIANGLE_STRIP",
    "TRIANGLE_FAN",
    "LINES",
    "LINE_LOOP",
    "POINTS",
    "TRIANGLES_ADJACENCY",
    "PATCHES",
)


_INLINE_SIZES = "SLICES, STACKS of a SPHERE; DIVISIONS, LENGTH of a GRID."


class Primitive(Configured):
    """A built-in primitive (docs/format.md, 10.7)."""

    name: Annotated[str | None, Attr(doc="Object and mesh name.", required=True)] = None
    type: Annotated[str | None, Attr(doc="Primitive.", required=True, values=PRIMITIVES)] = None
    material: Annotated[str | None, Attr(doc="Material of the default library.")] = None
    sphere: Annotated[NodeSettings, Inline("SPHERE", _INLINE_SIZES)] = Field(default_factory=dict)
    grid: Annotated[NodeSettings, Inline("GRID")] = Field(default_factory=dict)
    settings: Annotated[NodeSettings, Settings("SCENE_OBJECT", "Transform of the object.")] = Field(
        default_factory=dict
    )


class Terrain(Configured):
    """A grid built from a height map."""

    name: Annotated[str | None, Attr(doc="Object name.", required=True)] = None
    heightMap: Annotated[
        str | None, Attr(doc="Image; its luminance is the height.", required=True, file="texture")
    ] = None
    material: Annotated[str | None, Attr(doc="Material of the default library.")] = None
    settings: Annotated[NodeSettings, Settings("SCENE_OBJECT", "Transform of the object.")] = Field(
        default_factory=dict
    )


VERTEX_ATTRIBUTES = (
    "position",
    "normal",
    "color",
    *(f"texCoord{k}" for k in range(4)),
    "tangent",
    "bitangent",
    "triangleID",
    *(f"custom{k}" for k in range(6)),
)
"""Names of vertex attributes (docs/format.md, 8.4)."""


class BufferAttribute(Node):
    """The buffer of a vertex attribute (four floats each) or of the indices (one unsigned each)."""

    name: Annotated[
        str | None, Attr(doc="Buffer.", required=True, ref="buffer", library="fromLibrary")
    ] = None
    fromLibrary: Annotated[str | None, Attr(doc="Library of the buffer.")] = None


class BufferGeometry(Node):
    """Geometry in GPU buffers; children are named like vertex attributes."""

    name: Annotated[str | None, Attr(doc="Object name.", required=True)] = None
    primitive: Annotated[str | None, Attr(doc="Topology.", required=True, values=TOPOLOGIES)] = None
    material: Annotated[str | None, Attr(doc="Material of the default library.")] = None
    attributes: Annotated[
        list[BufferAttribute],
        Variants(dict.fromkeys((*VERTEX_ATTRIBUTES, "index"), BufferAttribute)),
    ] = Field(default_factory=list)


class ModelFile(Node):
    """A model file; the extension chooses the reader."""

    name: Annotated[str | None, Attr(doc="Path.", required=True, file="model")] = None


class ModelFolder(Node):
    """A folder of model files."""

    name: Annotated[str | None, Attr(doc="Path.", required=True, file="folder")] = None


class Scene(Configured):
    """A named set of geometry."""

    name: Annotated[str | None, Attr(doc="Scene name.", required=True)] = None
    type: Annotated[
        str | None,
        Attr(doc="Storage of the objects; default OctreeUnified.", values=SCENE_TYPES),
    ] = None
    filename: Annotated[
        str | None, Attr(doc="One model file; all children are then ignored.", file="model")
    ] = None
    param: Annotated[str | None, Attr(doc="Flags: UNITIZE, SWAP_YZ, USE_ADJACENCY.")] = None
    physicsMaterial: Annotated[str | None, Attr(doc="Physics only: ignored.")] = None
    geometry: Annotated[list[Primitive], Items(Primitive, "geometry")] = Field(default_factory=list)
    terrain: Annotated[list[Terrain], Items(Terrain, "terrain")] = Field(default_factory=list)
    buffers: Annotated[list[BufferGeometry], Items(BufferGeometry, "buffers")] = Field(
        default_factory=list
    )
    files: Annotated[list[ModelFile], Items(ModelFile, "file")] = Field(default_factory=list)
    folders: Annotated[list[ModelFolder], Items(ModelFolder, "folder")] = Field(
        default_factory=list
    )
    settings: Annotated[NodeSettings, Settings("SCENE", "Transform of the scene.")] = Field(
        default_factory=dict
    )

    def has_flag(self, flag: str) -> bool:
        """Return True if ``param`` contains ``flag``."""
        return flag in (self.param or "")

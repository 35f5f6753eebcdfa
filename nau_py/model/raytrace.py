"""The raytrace pass: ray types, programs and parameters (docs/format.md, section 7).

Element names are those of Nau's class ``rt``; the ``optix*`` spelling is upgraded to them.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated

from pydantic import Field

from nau_py.model.maps import match_pattern
from nau_py.model.node import Attr, Child, Items, Node
from nau_py.model.passes import Pass
from nau_py.model.values import DataType

PROGRAM_KINDS = ("CLOSEST_HIT", "ANY_HIT", "MISS")
GEOMETRY_KINDS = ("Geometry_Intersection", "Bounding_Box")
BUILTIN = "builtin"
VERTEX_ATTRIBUTES = [
    "position",
    "normal",
    "color",
    "texCoord0",
    "texCoord1",
    "texCoord2",
    "texCoord3",
    "tangent",
    "bitangent",
    "triangleID",
    "custom0",
    "custom1",
    "custom2",
    "custom3",
    "custom4",
    "custom5",
]


def component(name: str | None, channels: int) -> int:
    """Return the index of the channel that ``x`` to ``w`` names; the last one for none.

    ``channels``: number of channels.
    """
    return min("xyzw".index(name) if name in tuple("xyzw") else 3, channels - 1)


class Program(Node):
    """A program: a procedure of a file. The file ``builtin`` is nau_py's own."""

    file: Annotated[
        str | None, Attr(doc="`builtin`, or a path.", required=True, file="program")
    ] = None
    proc: Annotated[str | None, Attr(doc="Procedure.", required=True)] = None


class RayProgram(Program):
    """A program of a ray type."""

    type: Annotated[str | None, Attr(doc="Kind.", required=True, values=PROGRAM_KINDS)] = None


class GeometryProgram(Program):
    """An intersection or bounding box program, of compiled programs: Python ones meet triangles."""

    type: Annotated[str | None, Attr(doc="Kind.", values=GEOMETRY_KINDS)] = None


class RayTypePrograms(Node):
    """The programs of one ray type."""

    name: Annotated[str | None, Attr(doc="Ray type.", required=True)] = None
    programs: Annotated[list[RayProgram], Items(RayProgram, "rtProgram")] = Field(
        default_factory=list
    )


class RayMaterial(Node):
    """Programs of a material, by ray type."""

    to: Annotated[str | None, Attr(doc="Material, or prefix and a final `*`.")] = None
    rayTypes: Annotated[list[RayTypePrograms], Items(RayTypePrograms, "rayType")] = Field(
        default_factory=list
    )

    def program(self, ray_type: str, kind: str) -> RayProgram | None:
        """Return the program of a kind for a ray type, or None."""
        for group in self.rayTypes:
            if group.name == ray_type:
                return next((p for p in group.programs if p.type == kind), None)
        return None


class EntryPoint(Node):
    """The ray generation program of a launch, and the program that runs for failed samples."""

    rayGen: Annotated[Program | None, Child(Program, doc="Ray generation.")] = None
    exception: Annotated[Program | None, Child(Program, doc="Exception program.")] = None


class RayType(Node):
    """A ray type; its index is the order of first occurrence."""

    name: Annotated[str | None, Attr(doc="Ray type.", required=True)] = None


class VertexAttribute(Node):
    """A vertex attribute that programs read."""

    name: Annotated[
        str | None, Attr(doc="Vertex attribute.", required=True, values=tuple(VERTEX_ATTRIBUTES))
    ] = None


class RayVariable(Node):
    """A value handed to programs under a name."""

    name: Annotated[str | None, Attr(doc="Name in the programs.", required=True)] = None
    type: Annotated[str | None, Attr(doc="Object type.", required=True, ref="object type")] = None
    context: Annotated[str | None, Attr(doc="Object name, or CURRENT.", required=True)] = None
    component: Annotated[str | None, Attr(doc="Attribute of the type.", required=True)] = None
    id: Annotated[int | None, Attr(DataType.INT, "Unit, binding point or light index.")] = None


class InputBuffer(Node):
    """A texture that programs read, by pixel."""

    var: Annotated[str | None, Attr(doc="Name in the programs.", required=True)] = None
    texture: Annotated[
        str | None, Attr(doc="Texture, `lib::name`.", required=True, ref="texture")
    ] = None
    mask: Annotated[
        str | None,
        Attr(doc="This input selects pixels, by this component.", values=("x", "y", "z", "w")),
    ] = None
    weight: Annotated[
        str | None,
        Attr(
            doc="Meaning of weights below 1: parts of the blended colour, or of the samples.",
            values=("blend", "spp"),
        ),
    ] = None


class OutputBuffer(Node):
    """A texture that programs write, by pixel."""

    var: Annotated[str | None, Attr(doc="Name in the programs.", required=True)] = None
    texture: Annotated[
        str | None, Attr(doc="Texture, `lib::name`.", required=True, ref="texture")
    ] = None


class RaytracePass(Pass):
    """Traces rays and writes their radiance to its render target."""

    rtRayTypes: Annotated[list[RayType], Items(RayType, "rayType", "rtRayTypes")] = Field(
        default_factory=list
    )
    rtVertexAttributes: Annotated[
        list[VertexAttribute], Items(VertexAttribute, "attribute", "rtVertexAttributes")
    ] = Field(default_factory=list)
    rtEntryPoint: Annotated[EntryPoint | None, Child(EntryPoint)] = None
    rtDefaultMaterial: Annotated[RayMaterial | None, Child(RayMaterial)] = None
    rtMaterialMap: Annotated[list[RayMaterial], Items(RayMaterial, "rtMap", "rtMaterialMap")] = (
        Field(default_factory=list)
    )
    rtGlobalParams: Annotated[list[RayVariable], Items(RayVariable, "param", "rtGlobalParams")] = (
        Field(default_factory=list)
    )
    rtMaterialParams: Annotated[
        list[RayVariable], Items(RayVariable, "param", "rtMaterialParams")
    ] = Field(default_factory=list)
    rtInput: Annotated[list[InputBuffer], Items(InputBuffer, "buffer", "rtInput")] = Field(
        default_factory=list
    )
    rtOutput: Annotated[list[OutputBuffer], Items(OutputBuffer, "buffer", "rtOutput")] = Field(
        default_factory=list
    )
    rtGeometryProgram: Annotated[
        list[GeometryProgram], Items(GeometryProgram, "rtProgram", "rtGeometryProgram")
    ] = Field(default_factory=list)

    @property
    def mask(self) -> InputBuffer | None:
        """Input that selects pixels: the one with ``mask``, or the variable ``mask``."""
        flagged = [i for i in self.rtInput if i.mask]
        named = [i for i in self.rtInput if i.var == "mask"]
        return next(iter(flagged + named), None)

    def entry(self, names: Iterable[str]) -> RayMaterial | None:
        """Return the programs of a material that has one of ``names``: its exact entry, the first
        prefix in byte order, else the default (7.1)."""
        known = set(names)
        for node in self.rtMaterialMap:
            if node.to in known:
                return node
        prefixed = [n for n in self.rtMaterialMap if n.to and n.to.endswith("*")]
        for node in sorted(prefixed, key=lambda n: (n.to or "").encode()):
            if any(match_pattern(node.to or "", name) for name in known):
                return node
        return self.rtDefaultMaterial

    @property
    def materials(self) -> list[RayMaterial]:
        """Entries of materials: the default one, then the mapped ones."""
        default = [self.rtDefaultMaterial] if self.rtDefaultMaterial else []
        return default + self.rtMaterialMap

    @property
    def ray_types(self) -> list[str]:
        """Ray type names by index: the declared ones, then those of the programs."""
        used = [t.name for m in self.materials for t in m.rayTypes]
        return list(dict.fromkeys(n for n in [*(t.name for t in self.rtRayTypes), *used] if n))

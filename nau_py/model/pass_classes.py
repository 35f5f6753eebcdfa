"""The pass classes with children of their own, and the choice of a model by ``class``."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nau_py.model.mask import MaskPass
from nau_py.model.node import Attr, Child, Items, Node
from nau_py.model.passes import Pass, SceneReference
from nau_py.model.raytrace import RaytracePass
from nau_py.model.values import DataType
from nau_py.syntax.element import Element


class DefaultPass(Pass):
    """Draws its scenes with the mapped materials."""


class DepthmapPass(Pass):
    """Draws depth as the first light sees it."""


class ProfilerPass(Pass):
    """Draws timings over the picture."""


class OtherPass(Pass):
    """A pass of a class that nau_py does not have."""


class QuadTexture(Node):
    """A texture to fill the viewport with."""

    name: Annotated[
        str | None, Attr(doc="Texture.", required=True, ref="texture", library="fromLibrary")
    ] = None
    fromLibrary: Annotated[str | None, Attr(doc="Library.", ref="library")] = None


class MaterialReference(Node):
    """A material of a library."""

    name: Annotated[
        str | None, Attr(doc="Material.", required=True, ref="material", library="fromLibrary")
    ] = None
    fromLibrary: Annotated[str | None, Attr(doc="Library.", required=True, ref="library")] = None


class QuadPass(Pass):
    """Fills its viewport with a texture or a material; the material wins."""

    texture: Annotated[QuadTexture | None, Child(QuadTexture)] = None
    material: Annotated[MaterialReference | None, Child(MaterialReference)] = None


def _dimension(axis: str) -> Attr:
    return Attr(DataType.UINT, f"Work groups along {axis}.", constant=True)


def _source(axis: str) -> Attr:
    return Attr(doc=f"Buffer with the work groups along {axis}, `lib::buffer`.", ref="buffer")


def _offset(axis: str) -> Attr:
    return Attr(DataType.UINT, f"Byte offset of the number along {axis}.")


class ComputeMaterial(MaterialReference):
    """A compute material and the number of work groups, given or read from a buffer."""

    dimX: Annotated[int | str | None, _dimension("x")] = None
    dimY: Annotated[int | str | None, _dimension("y")] = None
    dimZ: Annotated[int | str | None, _dimension("z")] = None
    bufferX: Annotated[str | None, _source("x")] = None
    bufferY: Annotated[str | None, _source("y")] = None
    bufferZ: Annotated[str | None, _source("z")] = None
    offsetX: Annotated[int | None, _offset("x")] = None
    offsetY: Annotated[int | None, _offset("y")] = None
    offsetZ: Annotated[int | None, _offset("z")] = None


class ComputePass(Pass):
    """Runs a compute shader."""

    material: Annotated[ComputeMaterial | None, Child(ComputeMaterial)] = None


class MeshMaterial(MaterialReference):
    """A mesh-shader material and the number of mesh tasks."""

    count: Annotated[int | None, Attr(DataType.UINT, "Mesh tasks.")] = None
    buffer: Annotated[str | None, Attr(doc="Buffer with the number.", ref="buffer")] = None
    first: Annotated[int | None, Attr(DataType.UINT, "Byte offset of the number.")] = None


class MeshPass(Pass):
    """Draws with NV mesh shaders."""

    material: Annotated[MeshMaterial | None, Child(MeshMaterial)] = None
    materials: Annotated[list[MeshMaterial], Items(MeshMaterial, "material", "materials")] = Field(
        default_factory=list
    )


class RayBuffer(Node):
    """A buffer of rays or hits."""

    buffer: Annotated[
        str | None, Attr(doc="Buffer.", required=True, ref="buffer", library="fromLibrary")
    ] = None
    fromLibrary: Annotated[str | None, Attr(doc="Library.", ref="library")] = None
    queryType: Annotated[
        str | None, Attr(doc="Kind of query (rays only).", values=("ANY", "CLOSEST"))
    ] = None


class RayCount(Node):
    """How many rays: a number, or a place in a buffer."""

    value: Annotated[int | str | None, Attr(DataType.INT, "Rays.", constant=True)] = None
    buffer: Annotated[str | None, Attr(doc="Buffer.", ref="buffer")] = None
    offset: Annotated[int | None, Attr(DataType.UINT, "Byte offset.")] = None


class RayQueryPass(Pass):
    """Traces a buffer of rays into a buffer of hits (classes optixPrime and embree)."""

    scene: Annotated[SceneReference | None, Child(SceneReference)] = None
    rays: Annotated[RayBuffer | None, Child(RayBuffer)] = None
    hits: Annotated[RayBuffer | None, Child(RayBuffer)] = None
    rayCount: Annotated[RayCount | None, Child(RayCount)] = None


PASS_CLASSES: dict[str, type[Pass]] = {
    "default": DefaultPass,
    "quad": QuadPass,
    "depthmap": DepthmapPass,
    "compute": ComputePass,
    "mesh": MeshPass,
    "profiler": ProfilerPass,
    "raytrace": RaytracePass,
    "rt": RaytracePass,
    "optix": RaytracePass,
    "mask": MaskPass,
    "optixPrime": RayQueryPass,
    "embree": RayQueryPass,
}
PLUGIN_CLASSES = ("depthmap2", "geometryPI")
"""Pass classes of Nau's plug-ins."""
RAYTRACE_CLASSES = ("raytrace", "rt", "optix")


def pass_model(element: Element) -> type[Pass]:
    """The model for a ``<pass>`` element."""
    return PASS_CLASSES.get(element.attributes.get("class", "default"), OtherPass)

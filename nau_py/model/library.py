"""Material libraries (docs/format.md, section 6)."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nau_py.model.buffer import Buffer
from nau_py.model.material import Material
from nau_py.model.node import Attr, Items, Node, Variants
from nau_py.model.shader import Shader
from nau_py.model.state import State
from nau_py.model.target import RenderTarget
from nau_py.model.texture import ArrayOfTextures, CubeMap, Texture

DEFAULT_LIBRARY = "__nau_material_lib"
"""The library of the built-in resources and of the materials of model files."""


class MaterialLibrary(Node):
    """One library file. Files with one name are one library."""

    name: Annotated[str | None, Attr(doc="Library name.", required=True)] = None
    renderTargets: Annotated[
        list[RenderTarget], Items(RenderTarget, "renderTarget", "renderTargets")
    ] = Field(default_factory=list)
    textures: Annotated[
        list[Texture | CubeMap], Variants({"texture": Texture, "cubeMap": CubeMap}, "textures")
    ] = Field(default_factory=list)
    states: Annotated[list[State], Items(State, "state", "states")] = Field(default_factory=list)
    shaders: Annotated[list[Shader], Items(Shader, "shader", "shaders")] = Field(
        default_factory=list
    )
    buffers: Annotated[list[Buffer], Items(Buffer, "buffer", "buffers")] = Field(
        default_factory=list
    )
    arraysOfTextures: Annotated[
        list[ArrayOfTextures], Items(ArrayOfTextures, "arrayOfTextures", "arraysOfTextures")
    ] = Field(default_factory=list)
    materials: Annotated[list[Material], Items(Material, "material", "materials")] = Field(
        default_factory=list
    )

    @property
    def file(self) -> str:
        """Path of the library file."""
        return self.location.file


def qualify_name(name: str, library: str) -> str:
    """Return ``lib::name``. A name that contains ``::`` stays as it is."""
    return name if "::" in name else f"{library}::{name}"

"""Class ``mesh``: known, but not supported: it needs the OpenGL extension GL_NV_mesh_shader."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nau_py.model.node import Attr, Child, Items
from nau_py.model.pass_classes import MaterialReference, declare_pass_class
from nau_py.model.passes import Pass
from nau_py.model.values import DataType


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


declare_pass_class("mesh", MeshPass)

"""Physics libraries (docs/format.md, section 5): read and checked, not simulated."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nau_py.model.node import Attr, Child, Configured, Items, Node, NodeSettings, Settings


class PhysicsMaterial(Configured):
    """Movement and collision of a scene."""

    name: Annotated[str | None, Attr(doc="Physics material name.", required=True)] = None
    type: Annotated[
        str | None,
        Attr(
            doc="Kind of body.",
            required=True,
            values=("STATIC", "RIGID", "CLOTH", "PARTICLES", "CHARACTER", "DEBUG"),
        ),
    ] = None
    shape: Annotated[
        str | None,
        Attr(doc="Shape that collides.", values=("CUSTOM", "BOX", "SPHERE", "CAPSULE")),
    ] = None
    settings: Annotated[NodeSettings, Settings("PHYSICS_MATERIAL")] = Field(default_factory=dict)


class PhysicsProperties(Configured):
    """Properties of the whole world."""

    settings: Annotated[NodeSettings, Settings("PHYSICS_MANAGER")] = Field(default_factory=dict)


class PhysicsLibrary(Node):
    """One library file."""

    name: Annotated[str | None, Attr(doc="Library name.", required=True)] = None
    globalProperties: Annotated[PhysicsProperties | None, Child(PhysicsProperties)] = None
    materials: Annotated[list[PhysicsMaterial], Items(PhysicsMaterial, "material", "materials")] = (
        Field(default_factory=list)
    )

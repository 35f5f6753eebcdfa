"""The project file (docs/format.md, section 3)."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nau_py.model.accuracy import Accuracy
from nau_py.model.camera import Camera
from nau_py.model.effects import Effects
from nau_py.model.events import Interpolator, Route, Sensor
from nau_py.model.interface import Atomic, Interface
from nau_py.model.light import Light
from nau_py.model.node import Attr, Child, Items, Node
from nau_py.model.pipeline import Pipelines
from nau_py.model.scene import Scene
from nau_py.model.values import DataType
from nau_py.model.viewport import Viewport


class Constant(Node):
    """A number with a name."""

    name: Annotated[str | None, Attr(doc="Name.", required=True)] = None
    value: Annotated[float | None, Attr(DataType.FLOAT, "Number.", required=True)] = None


class UserAttribute(Node):
    """An attribute that the project adds to an object type (docs/format.md, 3.3)."""

    type: Annotated[str | None, Attr(doc="Object type.", required=True, ref="object type")] = None
    name: Annotated[str | None, Attr(doc="Attribute name.", required=True)] = None
    data: Annotated[
        str | None,
        Attr(
            doc="Data type.",
            required=True,
            values=tuple(t.value for t in DataType if t.in_file and t not in ("ENUM", "STRING")),
        ),
    ] = None
    value: Annotated[str | None, Attr(doc="Default of a scalar.")] = None
    x: Annotated[str | None, Attr(doc="Default of a vector.")] = None
    y: Annotated[str | None, Attr(doc="Default of a vector.")] = None
    z: Annotated[str | None, Attr(doc="Default of a vector.")] = None
    w: Annotated[str | None, Attr(doc="Default of a vector.")] = None


class LibraryReference(Node):
    """A material library file."""

    filename: Annotated[str | None, Attr(doc="Path.", required=True, file="library")] = None


class PhysicsReference(Node):
    """A physics library file: read and checked, not simulated."""

    filename: Annotated[str | None, Attr(doc="Path.", required=True, file="physics library")] = None


class Assets(Node):
    """Scenes, cameras, lights, libraries and everything else that passes use."""

    constants: Annotated[list[Constant], Items(Constant, "constant", "constants")] = Field(
        default_factory=list
    )
    aliases: Annotated[
        list[Constant], Items(Constant, "alias", "aliases", "Another spelling of constants.")
    ] = Field(default_factory=list)
    attributes: Annotated[list[UserAttribute], Items(UserAttribute, "attribute", "attributes")] = (
        Field(default_factory=list)
    )
    physicsLibs: Annotated[
        list[PhysicsReference], Items(PhysicsReference, "physicsLib", "physicsLibs")
    ] = Field(default_factory=list)
    scenes: Annotated[list[Scene], Items(Scene, "scene", "scenes")] = Field(default_factory=list)
    viewports: Annotated[list[Viewport], Items(Viewport, "viewport", "viewports")] = Field(
        default_factory=list
    )
    lights: Annotated[list[Light], Items(Light, "light", "lights")] = Field(default_factory=list)
    cameras: Annotated[list[Camera], Items(Camera, "camera", "cameras")] = Field(
        default_factory=list
    )
    sensors: Annotated[list[Sensor], Items(Sensor, "sensor", "sensors")] = Field(
        default_factory=list
    )
    interpolators: Annotated[
        list[Interpolator], Items(Interpolator, "interpolator", "interpolators")
    ] = Field(default_factory=list)
    routes: Annotated[list[Route], Items(Route, "route", "routes")] = Field(default_factory=list)
    atomics: Annotated[list[Atomic], Items(Atomic, "atomic", "atomics")] = Field(
        default_factory=list
    )
    materialLibs: Annotated[
        list[LibraryReference], Items(LibraryReference, "materialLib", "materialLibs")
    ] = Field(default_factory=list)


class ProjectFile(Node):
    """The root of a project file."""

    name: Annotated[str | None, Attr(doc="Project name.", required=True)] = None
    width: Annotated[int | None, Attr(DataType.INT, "Window width, pixels.")] = None
    height: Annotated[int | None, Attr(DataType.INT, "Window height, pixels.")] = None
    raytracePasses: Annotated[
        str | None,
        Attr(
            doc="`many` allows more than one raytrace pass (nau_py only).", values=("one", "many")
        ),
    ] = None
    assets: Annotated[Assets | None, Child(Assets)] = None
    pipelines: Annotated[Pipelines | None, Child(Pipelines)] = None
    effects: Annotated[Effects | None, Child(Effects)] = None
    accuracy: Annotated[Accuracy | None, Child(Accuracy)] = None
    interface: Annotated[Interface | None, Child(Interface)] = None
